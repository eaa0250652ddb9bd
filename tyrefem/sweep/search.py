"""The search for the best variant: differential evolution under limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.sweep.answers import NEVER
from tyrefem.sweep.asked import Asked
from tyrefem.sweep.card import LimitCard, OptimiseCard
from tyrefem.sweep.sweep import Sweep
from tyrefem.sweep.varied import Varied

Array = NDArray[np.float64]
Outcome = Mapping[str, Any]
#: The search ends when the population's answers differ by this share of their mean.
ALIKE = 1e-4
#: Violation, in shares of the limit, of a variant that has no answers.
FAILED = 1e3
#: Known variants that a search may begin with.
MOST_KNOWN = 10
#: Width of the rim around a range, as a share of it, that counts as its end.
RIM = 0.15


def best_known(known: Sweep | None, card: OptimiseCard) -> list[Array]:
    """Places of known variants that keep the limits, the best first; at most a third of a generation is wanted."""
    if known is None:
        return []
    plan = known.plan
    fine = [n for n, one in known.outcomes.items() if "answers" in one and violation(one, plan.limits) == 0]
    order = sorted(fine, key=lambda n: (objective(known.outcomes[n], card), n))
    return [np.array([_place(one, plan.variants[n][one.key]) for one in plan.varied]) for n in order[:MOST_KNOWN]]


def _place(one: Varied, value: Any) -> float:
    """The coordinate of a value in the search: its number in a list, or its place between both ends."""
    if one.values:
        return float(one.values.index(value))
    number = float(one.of(value))
    return math.log(number / one.low, one.high / one.low) if one.log else (number - one.low) / (one.high - one.low)


def evolve(asked: Asked, card: OptimiseCard, tick: Callable[[str, int, int], None], known: list[Array]) -> str:
    """Ask for generations until they are alike or `card.runs` are used up; why it ended, in words."""
    from scipy.optimize import NonlinearConstraint, differential_evolution
    from scipy.stats import qmc

    varied, limits = asked.plan.varied, asked.plan.limits
    most = np.array([len(one.values) - 1.0 if one.values else 1.0 for one in varied])
    whole = np.array([bool(one.values) for one in varied])
    count = int(np.clip(card.runs // 10, 8, 10 * len(varied)))

    def outcomes(x: Array) -> list[Any]:
        return asked([_variant(varied, column) for column in np.atleast_2d(x.T)])

    def aim(x: Array) -> Array:
        tick("optimum", min(len(asked.outcomes), card.runs), card.runs)
        return np.array([objective(one, card) for one in outcomes(x)])

    def broken(x: Array) -> Array:
        return np.array([[violation(one, limits, asked.margins) for one in outcomes(x)]])

    first = qmc.LatinHypercube(len(varied), seed=np.random.default_rng(card.seed)).random(count) * most
    for number, place in enumerate(known[: count // 3]):
        first[number] = place
    # A search takes steps that leave the box for misses: with a rim of clipped places its edges are reached.
    rim = np.where(whole, 0.0, RIM)
    found = differential_evolution(
        aim,
        list(zip(-rim, most + rim, strict=True)),
        integrality=whole,
        init=np.where(whole, np.round(first), first),
        maxiter=max(card.runs // count - 1, 1),
        constraints=NonlinearConstraint(broken, -np.inf, 0.0) if limits else (),
        seed=card.seed,
        tol=ALIKE,
        polish=False,
        updating="deferred",
        vectorized=True,
    )
    return "the search had converged" if found.success else f"the search ended at its {card.runs} trials"


def _variant(varied: Sequence[Varied], x: Array) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for one, u in zip(varied, x, strict=True):
        found |= one.changes(one.values[round(float(u))] if one.values else one.at(float(np.clip(u, 0.0, 1.0))))
    return found


def objective(outcome: Outcome, card: OptimiseCard) -> float:
    """What is minimised; a time never reached is the longest, a failure the worst."""
    if "answers" not in outcome:
        return math.inf
    value = float(outcome["answers"][card.answer])
    value = NEVER if math.isnan(value) else value
    return value if card.minimise else -value


def violation(outcome: Outcome, limits: Mapping[str, LimitCard], margins: Mapping[str, float] | None = None) -> float:
    """By how much limits are broken together, in shares of each; 0: kept.

    ``margins``: answer -> what a reduced model's may be wrong by; its answers have to keep the limits by that much.

    >>> violation({"answers": {"hottest_degC": 99.0}}, {"hottest_degC": LimitCard(below=90.0)})
    0.1
    """
    if "answers" not in outcome:
        return FAILED if limits else 0.0
    total = 0.0
    for name, limit in limits.items():
        value = float(outcome["answers"][name])
        value = NEVER if math.isnan(value) else value
        margin = (margins or {}).get(name, 0.0) if outcome.get("by") == "reduced" else 0.0
        total += 0.0 if limit.below is None else _beyond(value + margin, limit.below)
        total += 0.0 if limit.above is None else _beyond(margin - value, -limit.above)
    return total


def _beyond(value: float, bound: float) -> float:
    """How far beyond a bound, which itself is not allowed."""
    return 0.0 if value < bound else max((value - bound) / max(abs(bound), 1e-12), 1e-9)
