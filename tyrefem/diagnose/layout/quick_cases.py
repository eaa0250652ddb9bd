"""Quick cases: causes and readings drawn from the priors of a linear layout, with the posterior and the verdict."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from tyrefem.brief import Brief
from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.inference.evidence import posterior
from tyrefem.diagnose.layout.linear_layout import LinearLayout
from tyrefem.diagnose.unknowns.candidates import Members
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.verdicts.verdict import IDENTIFIED

Array = NDArray[np.float64]
#: Probabilities that an effect acts are kept from this one on.
KEPT = 0.005


@dataclass(frozen=True, eq=False)
class QuickCase(Brief):
    """A cause drawn from the priors, and what the linear diagnosis says.

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

    @property
    def named_right(self) -> bool:
        """Whether the verdict "identified" names effects that all act."""
        return self.verdict == IDENTIFIED and self.right

    def size_at(self, threshold: float) -> int:
        """Number of sets in the conformal set with a threshold."""
        before = np.cumsum((0.0, *self.leading[:-1]))
        return int((before <= threshold).sum())


@dataclass(frozen=True, eq=False)
class DrawnReadings(Brief):
    """Readings drawn from the priors: ``place`` of the true set in `LinearLayout.sets`, -1 for heat of unknown origin.

    ``values``: x of base numbers, sensors and amplitudes. ``fitted`` (n,), ``held_out`` (m,): whitened readings.
    """

    place: int
    values: dict[Unknown, float]
    fitted: Array
    held_out: Array


def drawn(layout: LinearLayout, rng: np.random.Generator) -> DrawnReadings:
    """A set from its prior, amplitudes, base numbers and sensors from theirs (cut to the bounds), and noise."""
    design, count = layout.design, len(layout.sets)
    place = int(rng.choice(count + 1, p=np.exp(layout.log_prior)))
    members: Members = layout.sets[place] if place < count else ()
    nuisance = design.unknowns[: design.nuisance]
    values = {unknown: within(unknown, rng) for unknown in nuisance}
    values |= {unknown: within(unknown, rng) for member in members for unknown in member.amplitudes}
    signal = values | {unknown: 1.0 for member in members for unknown in member.presence}
    columns, x = design.columns(tuple(signal)), np.array(list(signal.values()))
    readings = [J[:, columns] @ x + rng.normal(size=len(J)) for J in (design.jacobian, layout.held_out)]
    if place == count:
        z = layout.heat_sd * rng.normal(size=len(layout.heat_sd))
        readings = [readings[0] + layout.heat @ z, readings[1] + layout.heat_held_out @ z]
    return DrawnReadings(place if place < count else -1, values, readings[0], readings[1])


def within(unknown: Unknown, rng: np.random.Generator) -> float:
    """A value from the prior N(0, sd^2) cut to the bounds."""
    low, high = ndtr(unknown.low / unknown.sd), ndtr(unknown.high / unknown.sd)
    x = unknown.sd * float(ndtri(low + (high - low) * rng.uniform()))
    return float(np.clip(x, unknown.low, unknown.high))


def quick_case(layout: LinearLayout, rng: np.random.Generator) -> QuickCase:
    """Draw a cause and its readings, and judge them."""
    hidden = drawn(layout, rng)
    judgement = layout.judge(hidden.fitted, hidden.held_out)
    outside = hidden.place < 0
    members = () if outside else layout.sets[hidden.place]
    names, best = {member.key for member in members}, judgement.best
    true_set = next(
        entry for entry in judgement.ranking if entry.outside == outside and {m.key for m in entry.members} == names
    )
    named = {member.key for member in best.members}
    right = named <= names if named else best is true_set
    ranks: tuple[float, ...] = ()
    base_rank = p_value = float("nan")
    if not outside:
        fit = layout.fit(hidden.fitted, np.zeros(0), members)
        amplitudes = [unknown for member in members for unknown in member.amplitudes]
        base = layout.design.unknowns[int(rng.integers(layout.design.nuisance))]
        *of_amplitudes, base_rank = posterior_ranks(fit, hidden.values, [*amplitudes, base])
        ranks, p_value = tuple(of_amplitudes), fit.p_value
    return QuickCase(
        tuple(sorted(names)),
        outside,
        judgement.verdict,
        best.key,
        judgement.probability,
        right,
        true_set.probability,
        sum(entry.probability for entry in judgement.ranking if entry.score > true_set.score),
        bool(best.members) or best.outside,
        tuple(entry.probability for entry in judgement.ranking if entry.probability > 1e-6),
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
