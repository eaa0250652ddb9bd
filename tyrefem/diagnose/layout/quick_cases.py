"""Quick cases: causes and readings drawn from the priors of a linear layout, with the posterior and the verdict."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from tyrefem.brief import Brief
from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.inference.evidence import posterior
from tyrefem.diagnose.layout.linear_layout import LinearLayout
from tyrefem.diagnose.unknowns.candidates import Members
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.verdicts.verdict import Judgement

Array = NDArray[np.float64]
#: Probabilities that an effect acts are kept from this one on.
KEPT = 0.005


@dataclass(frozen=True, eq=False)
class QuickCase(Brief):
    """A cause drawn from the priors, and what the diagnosis says.

    Parameters
    ----------
    hidden, outside : the acting effects; a cause outside the catalogue acts.
    verdict, best : the verdict and the most probable set. stated, right : probability that the members of this set
        act, and whether they do. of_truth : probability of the true set. before_truth : probability of all sets that
        are more probable than it. effect_leads : the most probable set is not "no effect". leading : probabilities of
        all sets above 1e-6, largest first.
    inclusion : (probability that an effect acts, whether it does) of every effect above 0.5 %.
    amplitude_ranks, base_rank : share of the posterior of the true set below the true amplitudes; below the true value
        of one base number or sensor, drawn at random. NaN for a cause outside the catalogue.
    p_value : probability of a misfit of the true set at least as large.
    """

    hidden: tuple[str, ...]
    outside: bool
    verdict: str
    best: str
    stated: float
    right: bool
    of_truth: float
    before_truth: float
    effect_leads: bool
    leading: tuple[float, ...]
    inclusion: tuple[tuple[float, bool], ...]
    amplitude_ranks: tuple[float, ...]
    base_rank: float
    p_value: float

    @classmethod
    def of_row(cls, row: Mapping[str, Any]) -> QuickCase:
        """The case of a row of a JSON file, in which NaN is null."""
        values: dict[str, Any] = {name: tuple(each) if isinstance(each, list) else each for name, each in row.items()}
        values["inclusion"] = tuple((share, acts) for share, acts in row["inclusion"])
        return cls(**values | {name: np.nan for name in ("base_rank", "p_value") if row[name] is None})

    def size_at(self, threshold: float) -> int:
        """Number of sets in the conformal set with a threshold."""
        before = np.cumsum((0.0, *self.leading[:-1]))
        return int((before <= threshold).sum())


@dataclass(frozen=True, eq=False)
class DrawnCause(Brief):
    """A cause drawn from the priors.

    Parameters
    ----------
    place, members : its set in `LinearLayout.sets`; -1 and empty for heat of unknown origin.
    values : x of base numbers, sensors and amplitudes.
    heat : (p,) heat of unknown origin over its prior sd, in the order of `LinearLayout.heat`; empty: none.
    """

    place: int
    members: Members
    values: dict[Unknown, float]
    heat: Array

    @property
    def signal(self) -> dict[Unknown, float]:
        """The values, and 1 for effects without an amplitude."""
        return self.values | {unknown: 1.0 for member in self.members for unknown in member.presence}


def drawn(layout: LinearLayout, rng: np.random.Generator) -> DrawnCause:
    """A set from its prior; amplitudes, base numbers and sensors from theirs (cut to the bounds)."""
    design, count = layout.design, len(layout.sets)
    place = int(rng.choice(count + 1, p=np.exp(layout.log_prior)))
    members: Members = layout.sets[place] if place < count else ()
    values = {unknown: within(unknown, rng) for unknown in design.unknowns[: design.nuisance]}
    values |= {unknown: within(unknown, rng) for member in members for unknown in member.amplitudes}
    heat = rng.normal(size=len(layout.heat_sd)) if place == count else np.zeros(0)
    return DrawnCause(place if place < count else -1, members, values, heat)


def readings(layout: LinearLayout, cause: DrawnCause, rng: np.random.Generator) -> tuple[Array, Array]:
    """Whitened readings of a cause with noise, by the linear model: fitted (n,) and held out (m,)."""
    signal = cause.signal
    columns, x = layout.design.columns(tuple(signal)), np.array(list(signal.values()))
    fitted, held_out = (J[:, columns] @ x + rng.normal(size=len(J)) for J in (layout.design.jacobian, layout.held_out))
    if len(cause.heat):
        z = layout.heat_sd * cause.heat
        fitted, held_out = fitted + layout.heat @ z, held_out + layout.heat_held_out @ z
    return fitted, held_out


def within(unknown: Unknown, rng: np.random.Generator) -> float:
    """A value from the prior N(0, sd^2) cut to the bounds."""
    low, high = ndtr(unknown.low / unknown.sd), ndtr(unknown.high / unknown.sd)
    x = unknown.sd * float(ndtri(low + (high - low) * rng.uniform()))
    return float(np.clip(x, unknown.low, unknown.high))


def quick_case(layout: LinearLayout, rng: np.random.Generator) -> QuickCase:
    """Draw a cause and its readings, and judge them, all in the linear model."""
    cause = drawn(layout, rng)
    fitted, held_out = readings(layout, cause, rng)
    return judged_case(layout, cause, layout.judge(fitted, held_out), partial(layout.fit, fitted, np.zeros(0)), rng)


def judged_case(
    layout: LinearLayout,
    cause: DrawnCause,
    judgement: Judgement,
    fit_of: Callable[[Members], FittedSet],
    rng: np.random.Generator,
) -> QuickCase:
    """What a judgement says of a drawn cause. ``fit_of``: set -> its fit, for the ranks of true values.

    A true set that was not ranked has probability 0, behind all others.
    """
    outside, names, best = cause.place < 0, {member.key for member in cause.members}, judgement.best
    true_set = next(
        (row for row in judgement.ranking if row.outside == outside and {m.key for m in row.members} == names), None
    )
    named = {member.key for member in best.members}
    right = named <= names if named else best is true_set
    ranks: tuple[float, ...] = ()
    base_rank = p_value = float("nan")
    if not outside:
        fit = fit_of(cause.members)
        amplitudes = [unknown for member in cause.members for unknown in member.amplitudes]
        base = layout.design.unknowns[int(rng.integers(layout.design.nuisance))]
        *of_amplitudes, base_rank = posterior_ranks(fit, cause.values, [*amplitudes, base])
        ranks, p_value = tuple(of_amplitudes), fit.p_value
    ahead = judgement.ranking if true_set is None else [r for r in judgement.ranking if r.score > true_set.score]
    return QuickCase(
        tuple(sorted(names)),
        outside,
        judgement.verdict,
        best.key,
        judgement.probability,
        right,
        0.0 if true_set is None else true_set.probability,
        sum(row.probability for row in ahead),
        bool(best.members) or best.outside,
        tuple(row.probability for row in judgement.ranking if row.probability > 1e-6),
        tuple((share, key in names) for key, share in judgement.named.items() if share >= KEPT),
        ranks,
        base_rank,
        p_value,
    )


def posterior_ranks(fit: FittedSet, values: dict[Unknown, float], unknowns: list[Unknown]) -> list[float]:
    """Share of the posterior below the true value of each unknown: N(mean, sd^2) cut to its bounds.

    Uniform from 0 to 1 over cases drawn from the priors, if the posterior is right (Talts et al., arXiv:1804.06788,
    2018, from memory).
    """
    wide = np.full(len(fit.unknowns), np.inf)
    J, sd = fit.linear.jacobian, np.array([unknown.sd for unknown in fit.unknowns])
    solution = posterior(J.T @ J, J.T @ fit.linear.data, sd, -wide, wide)
    ranks = []
    for unknown in unknowns:
        k = fit.unknowns.index(unknown)
        mean, spread = solution.mean[k], solution.sd[k]
        low, at, high = ((edge - mean) / spread for edge in (unknown.low, values[unknown], unknown.high))
        if low > 0:
            # The mass above is exact where both ends are far in the upper tail.
            below, inside = ndtr(-low) - ndtr(-at), ndtr(-low) - ndtr(-high)
        else:
            below, inside = ndtr(at) - ndtr(low), ndtr(high) - ndtr(low)
        ranks.append(float(below / inside))
    return ranks


def quick_cases(layout: LinearLayout, count: int, seed: int) -> Iterator[QuickCase]:
    """``count`` cases; case n depends on the seed and n only."""
    return (quick_case(layout, np.random.default_rng([seed, number])) for number in range(count))
