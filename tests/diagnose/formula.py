"""Readings by a formula in place of a forward model: fits and searches in milliseconds, with every answer known."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.data.runs import MeasuredDrive, MeasuredSensor
from tyrefem.diagnose.data.sensitivities import Sensitivities
from tyrefem.diagnose.forward.multifidelity import Predictions
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Candidate, Members
from tyrefem.diagnose.unknowns.unknown import Unknown
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
    #: Law of the second run, which is held out.
    held_out: Law | None = None
    #: (method, values by key) of every answer.
    questions: list[tuple[str, dict[str, float]]] = field(default_factory=list)

    @property
    def model(self) -> Any:
        return self

    def of(self, method: str, questions: Sequence[tuple[Any, ...]], tick: object = None) -> list[Array]:
        return [self._answer(method, question) for question in questions]

    def together(self, questions: Sequence[tuple[str, tuple[Any, ...]]], tick: object = None) -> list[Array]:
        return [self._answer(method, question) for method, question in questions]

    def _answer(self, method: str, question: tuple[Any, ...]) -> Array:
        # A number of a card and an effect beyond it add up.
        values: dict[str, float] = {}
        for unknown, x in question[-1].items():
            values[unknown.key] = values.get(unknown.key, 0.0) + x
        self.questions.append((method, values))
        law = self.held_out if self.held_out is not None and question[0] == 1 else self.law
        if method == "predict":
            return law(values)
        return slopes(law, [unknown.key for unknown in question[1]], values)

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
    law: Law,
    measured: Array,
    candidates: Members,
    settings: DiagnosisSettings = DEFAULT,
    expected: float = 0.5,
    held_out: tuple[Law, Array] | None = None,
    further: tuple[Unknown, ...] = (),
    sensors: int = 1,
) -> Case:
    """Measured readings (n,) against a formula of `STATED` and the candidates' amplitudes.

    ``held_out``: law and readings of a second run that no fit uses. ``further``: unknowns of no candidate.
    ``sensors``: number of sensors that share the readings of a run evenly, if there is more than one.
    """
    laws = [(law, measured)] + ([held_out] if held_out else [])
    unknowns = (STATED, *(unknown for candidate in candidates for unknown in candidate.unknowns), *further)
    keys = [unknown.key for unknown in unknowns]
    trials = tuple(
        MeasuredDrive(f"run-{number}", {}, number == 1, _shared(readings, sensors))
        for number, (_, readings) in enumerate(laws)
    )
    known = Sensitivities(
        tuple(trial.sampling for trial in trials),
        unknowns,
        1,
        tuple(each({}) for each, _ in laws),
        tuple(np.zeros(len(readings)) for _, readings in laws),
        tuple(slopes(each, keys, {}) for each, _ in laws),
    )
    card = SimpleNamespace(drive=SimpleNamespace(initial=0.0), diagnosis=SimpleNamespace(effects_expected=expected))
    study = cast(Any, SimpleNamespace(card=card, file=None, at_run=lambda run, drive: study))
    formula = Formula(law, known.drives, settings, held_out[0] if held_out else None)
    return Case(formula, Residuals(study, trials, known, settings), Predictions(cast(Any, formula)))


def _shared(measured: Array, sensors: int) -> tuple[MeasuredSensor, ...]:
    """The readings of a run by sensor."""
    if sensors == 1:
        return (_series(measured),)
    parts = np.split(measured, sensors)
    return tuple(replace(_series(part), sensor=f"sensor-{number}") for number, part in enumerate(parts))


def _series(measured: Array) -> MeasuredSensor:
    """Readings with unit noise and no discrepancy, each a block."""
    n = len(measured)
    return MeasuredSensor("crown", np.arange(float(n)), 1.0, 0.0, 1.0, n, measured=measured)
