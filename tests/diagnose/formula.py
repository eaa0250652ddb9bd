"""Readings by a formula in place of a forward model: fits and searches in milliseconds, with every answer known."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.candidates import Candidate, Members
from tyrefem.diagnose.multifidelity import Predictions
from tyrefem.diagnose.residuals import Residuals
from tyrefem.diagnose.runs import MeasuredDrive, MeasuredSensor
from tyrefem.diagnose.sensitivities import Sensitivities
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns import Unknown
from tyrefem.effects.effect import Parameter, Prior

Array = NDArray[np.float64]
#: Values of unknowns by key -> (n,) readings.
Law = Callable[[Mapping[str, float]], Array]
#: A base number that is in every model.
STATED = Unknown("materials.tread.loss_tangent.value", 0.3)


def effect(name: str, sd: float = 2.0, low: float = -np.inf) -> Candidate:
    """A candidate with one amplitude, whose key is the name."""
    parameter = Parameter(name="size", prior=Prior("1", "size", sd, low, 100.0))
    return Candidate(name, (), (Unknown(name, sd, low, 100.0, name, (), parameter),))


@dataclass
class Formula:
    """Answers from a formula; keeps what is asked."""

    law: Law
    drives: tuple[Any, ...]
    settings: DiagnosisSettings = DEFAULT
    #: (method, values by key) of every answer.
    questions: list[tuple[str, dict[str, float]]] = field(default_factory=list)

    @property
    def model(self) -> Any:
        return self

    def of(self, method: str, questions: Sequence[tuple[Any, ...]], tick: object = None) -> list[Array]:
        return [self._answer(method, question) for question in questions]

    def _answer(self, method: str, question: tuple[Any, ...]) -> Array:
        values = {unknown.key: x for unknown, x in question[-1].items()}
        self.questions.append((method, values))
        if method == "predict":
            return self.law(values)
        return slopes(self.law, [unknown.key for unknown in question[1]], values)

    def points(self, method: str = "predict") -> list[dict[str, float]]:
        """Where it was asked."""
        return [values for name, values in self.questions if name == method]


def slopes(law: Law, keys: Sequence[str], at: Mapping[str, float]) -> Array:
    """(n, k) difference quotients."""
    here = law(at)
    columns = [(law({**at, key: at.get(key, 0.0) + 1e-6}) - here) / 1e-6 for key in keys]
    return np.column_stack(columns) if columns else np.zeros((len(here), 0))


@dataclass
class Case:
    """One run with unit noise, computed by a formula."""

    formula: Formula
    residuals: Residuals
    predictions: Predictions

    @property
    def measured(self) -> Array:
        return self.residuals.runs[0].measured


def case(
    law: Law, measured: Array, candidates: Members, settings: DiagnosisSettings = DEFAULT, expected: float = 0.5
) -> Case:
    """Measured readings (n,) against a formula of `STATED` and the candidates' amplitudes."""
    n = len(measured)
    readings = MeasuredSensor("crown", np.arange(float(n)), 1.0, 0.0, 1.0, n, measured=measured)
    trial = MeasuredDrive("run", {}, False, (readings,))
    unknowns = (STATED, *(unknown for candidate in candidates for unknown in candidate.unknowns))
    here = law({})
    jacobian = slopes(law, [unknown.key for unknown in unknowns], {})
    known = Sensitivities((trial.sampling,), unknowns, 1, (here,), (np.zeros(n),), (jacobian,))
    card = SimpleNamespace(drive=SimpleNamespace(initial=0.0), diagnosis=SimpleNamespace(effects_expected=expected))
    study = cast(Any, SimpleNamespace(card=card, file=None))
    formula = Formula(law, (trial.sampling,), settings)
    return Case(formula, Residuals(study, (trial,), known, settings), Predictions(cast(Any, formula)))
