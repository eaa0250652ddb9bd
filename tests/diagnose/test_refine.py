"""The fit within a region of trust, on made-up readings whose dependence on the unknowns is known."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import minimize

from tyrefem.diagnose.fit import polished, refined
from tyrefem.diagnose.fitted import Explained
from tyrefem.diagnose.linearised import Gap
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns import Candidate, Unknown
from tyrefem.effects.effect import Parameter, Prior

Array = NDArray[np.float64]
STATED = Unknown("materials.tread.loss_tangent.value", 0.3)


def effect(name: str, low: float = -np.inf) -> Candidate:
    """A candidate with one amplitude."""
    parameter = Parameter(name="size", prior=Prior("1", "size", 2.0, low, 100.0))
    return Candidate(name, (), (Unknown(f"effects.{name}.size", 2.0, low, 100.0, name, (), parameter),))


BENDING = effect("bending")


@dataclass
class Trial:
    """One run of ten blocks of unit noise."""

    measured: Array
    hold_out: bool = False

    def whitened(self, blocks: Array) -> Array:
        return blocks


@dataclass
class Lab:
    """Answers from a formula; counts what is asked."""

    law: Callable[[float, float], Array]
    measured: Array
    settings: DiagnosisSettings = DEFAULT
    asked: list[tuple[str, tuple[float, ...]]] = field(default_factory=list)

    @property
    def bench(self) -> Any:
        return self

    @property
    def trials(self) -> list[Trial]:
        return [Trial(self.measured)]

    def at(self, values: dict[Unknown, float]) -> tuple[float, float]:
        return values.get(STATED, 0.0), values.get(BENDING.unknowns[0], 0.0)

    def ask(self, method: str, questions: Sequence[tuple[Any, ...]], tick: object = None) -> list[Array]:
        found = []
        for question in questions:
            x = self.at(question[-1])
            self.asked.append((method, x))
            if method == "predict":
                found.append(self.law(*x))
                continue
            slopes = {STATED: (1e-6, 0.0), BENDING.unknowns[0]: (0.0, 1e-6)}
            steps = [slopes[one] for one in question[1]]
            found.append(np.column_stack([(self.law(x[0] + a, x[1] + b) - self.law(*x)) / 1e-6 for a, b in steps]))
        return found


class Made(Gap):
    """Readings need no correction for a mesh."""

    def corrected(self, number: int, computed: Array) -> Array:
        return computed


def gap(lab: Lab, settings: DiagnosisSettings = DEFAULT) -> Gap:
    origin = lab.law(0.0, 0.0)
    both = {STATED: 0.0, BENDING.unknowns[0]: 0.0}
    J = lab.ask("jacobian", [(0, (STATED, *BENDING.unknowns), both)])[0]
    lab.asked.clear()
    return Made(cast(Any, lab), (STATED, *BENDING.unknowns), 1, (np.zeros(10),), (origin,), (J,), settings=settings)


T = np.linspace(0.1, 1.0, 10)


def saturating(a: float, b: float) -> Array:
    """Linear in the first unknown, ever less sensitive to the second, as a film is."""
    return np.asarray(40 * a * T + 60 * np.tanh(b / 3) * T**2)


def least(lab: Lab) -> float:
    """The smallest misfit there is, by a general minimiser."""

    def misfit(x: Array) -> float:
        r = lab.measured - lab.law(*x)
        return float(r @ r + (x[0] / 0.3) ** 2 + (x[1] / 2.0) ** 2)

    starts = [(a, b) for a in (-0.3, 0.3) for b in (0.5, 2.0, 4.0)]
    return float(min(minimize(misfit, start, method="Nelder-Mead", options={"xatol": 1e-7}).fun for start in starts))


def fitted(lab: Lab, settings: DiagnosisSettings = DEFAULT) -> Explained:
    found = gap(lab, settings)
    return polished(found, refined(found, [(BENDING,)]))[0]


@pytest.mark.parametrize("true", [0.5, 3.0, 5.0])
def test_the_fit_ends_where_a_general_minimiser_does(true: float) -> None:
    noise = np.random.default_rng(3).normal(size=10)
    lab = Lab(saturating, saturating(0.2, true) + noise)
    one = fitted(lab)
    assert one.converged
    assert one.misfit == pytest.approx(least(lab), abs=1.0), "half a unit, or so, is left to the linear model"
    assert one.values[BENDING.unknowns[0]] == pytest.approx(true, abs=4 * one.sd[BENDING.unknowns[0]])


def test_no_step_leaves_the_region_of_trust() -> None:
    lab = Lab(saturating, saturating(0.2, 5.0))
    fitted(lab)
    # The tangent at x = 0 promises less than is needed there, far out more: b = 60 tanh(5/3)/20 would be 2.8.
    points = [x for method, x in lab.asked if method == "predict"]
    assert abs(points[0][0]) <= 3 * 0.3 + 1e-9
    assert abs(points[0][1]) <= 3 * 2.0 + 1e-9


def test_where_no_tyre_is_possible_the_fit_turns_back() -> None:
    def limited(a: float, b: float) -> Array:
        # The first unknown is a load that the tyre carries up to a tenth more than stated.
        return np.full(10, np.nan) if a > 0.1 else saturating(a, b)

    lab = Lab(limited, saturating(0.09, 1.0) + 4.0 * T)
    one = fitted(lab)
    refused = [x for method, x in lab.asked if method == "predict" and x[0] > 0.1]
    assert refused, "a case in which nothing impossible is tried proves nothing"
    assert np.isfinite(one.misfit)
    assert one.values[STATED] <= 0.1
    start = lab.measured - limited(0.0, 0.0)
    assert one.misfit < float(start @ start) / 2


def test_a_larger_set_starts_where_its_part_has_converged() -> None:
    noise = np.random.default_rng(5).normal(size=10)
    lab = Lab(saturating, saturating(0.25, 0.0) + noise)
    found = gap(lab)
    none = polished(found, refined(found, [()]))[0]
    assert none.close
    lab.asked.clear()
    warm = refined(found, [(BENDING,)], starts={(BENDING,): none})[0]
    first = next(x for method, x in lab.asked if method == "predict")
    assert first[0] == pytest.approx(none.values[STATED], abs=0.1)
    cold = refined(found, [(BENDING,)])[0]
    assert warm.log_evidence == pytest.approx(cold.log_evidence, abs=0.3)


@pytest.mark.parametrize(("odd", "again"), [(2.0, True), (0.3, False)])
def test_a_misfit_that_noise_seldom_makes_is_believed_with_tangents_at_its_own_point(odd: float, again: bool) -> None:
    # What no unknown explains: the misfit stays poor, so that tangents corrected step by step are not enough.
    left = odd * np.where(np.arange(10) % 2, 1.0, -1.0)
    tangents = []
    for seldom in (0.0, 0.1):
        lab = Lab(saturating, saturating(0.2, 3.0) + left)
        one = fitted(lab, DiagnosisSettings(seldom=seldom))
        assert one.converged
        assert one.misfit == pytest.approx(least(lab), abs=1.0)
        tangents.append([x for method, x in lab.asked if method == "jacobian"])
    assert (len(tangents[1]) > len(tangents[0])) is again
    if again:
        final = one.values[STATED], one.values[BENDING.unknowns[0]]
        assert tangents[1][-1] == pytest.approx(final, abs=0.05)
