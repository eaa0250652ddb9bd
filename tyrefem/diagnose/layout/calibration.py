"""Calibration of a layout: whether stated probabilities and amounts are as frequent as they say, by quick cases."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from tyrefem.brief import Brief
from tyrefem.diagnose.data.sensitivities import Sensitivities
from tyrefem.diagnose.layout.conformal import COVERAGE, LEADS, conformal_threshold
from tyrefem.diagnose.layout.false_alarms import Frequency, false_alarms
from tyrefem.diagnose.layout.linear_layout import LinearLayout, linear_layout
from tyrefem.diagnose.layout.quick_cases import QuickCase, quick_cases
from tyrefem.diagnose.verdicts.verdict import UNEXPLAINED
from tyrefem.inputs.study import StudyData

#: Limits of the bins of stated probabilities.
BINS = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 0.99, 1.0)
#: Bins of ranks; draws of a calibrated diagnosis for the p-value of the calibration error; draws without an effect.
RANKS, RESAMPLED, DRAWS = 10, 4000, 100_000


@dataclass(frozen=True)
class ReliabilityBin(Brief):
    """Statements with probabilities in a bin: their mean ``stated``, and how often they are true."""

    stated: float
    true: Frequency


@dataclass(frozen=True, eq=False)
class Reliability(Brief):
    """Stated probabilities against frequencies.

    ``error``: expected calibration error, the mean of |stated - frequency| over the bins, weighed by their cases.
    ``p_value``: probability of an error at least as large if every probability is right (simulated).
    """

    bins: tuple[ReliabilityBin, ...]
    error: float
    p_value: float

    @classmethod
    def of(cls, stated: Sequence[float], true: Sequence[bool], seed: int = 0) -> Reliability:
        """Reliability of statements with their probabilities; each is true or not."""
        shares, outcomes = np.asarray(stated, dtype=float), np.asarray(true, dtype=float)
        place = np.clip(np.searchsorted(BINS, shares, side="left") - 1, 0, len(BINS) - 2)
        groups = [np.flatnonzero(place == number) for number in range(len(BINS) - 1)]
        groups = [group for group in groups if len(group)]
        bins = tuple(
            ReliabilityBin(float(shares[group].mean()), Frequency(int(outcomes[group].sum()), len(group)))
            for group in groups
        )
        draws = np.random.default_rng(seed).uniform(size=(RESAMPLED, len(shares))) < shares
        rows = np.vstack([outcomes, draws])
        errors = np.zeros(len(rows))
        for group in groups:
            errors += abs((rows[:, group] - shares[group]).sum(axis=1)) / len(shares)
        return cls(bins, float(errors[0]), float((errors[1:] >= errors[0] - 1e-12).mean()))

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        bins = [{**each.true.to_dict(), "stated": each.stated} for each in self.bins]
        return {"bins": bins, "expected_calibration_error": self.error, "p_value": self.p_value}


@dataclass(frozen=True)
class RankTest(Brief):
    """Ranks of true values in their posteriors, by even bins; ``p_value``: chi-squared test that they are uniform."""

    counts: tuple[int, ...]
    p_value: float

    @classmethod
    def of(cls, ranks: Sequence[float]) -> RankTest:
        """Test of ranks between 0 and 1."""
        from scipy.stats import chisquare

        counts, _ = np.histogram(ranks, RANKS, (0.0, 1.0))
        return cls(tuple(map(int, counts)), float(chisquare(counts).pvalue) if len(ranks) else float("nan"))

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {"counts": list(self.counts), "p_value": self.p_value}


@dataclass(frozen=True, eq=False)
class Calibration(Brief):
    """Quick cases of a layout, and what they say of the diagnosis's probabilities.

    Parameters
    ----------
    study, sensors, runs : the layout. seed : of the cases. cases : the first half gives the conformal thresholds, the
        second half checks them. alarms : criterion -> false alarms of "unexplained" with nothing hidden.
    fitted : the cases are simulated and fitted as a diagnosis does; else they are linear, as the alarms always are.
    """

    study: str
    sensors: tuple[str, ...]
    runs: tuple[str, ...]
    seed: int
    cases: tuple[QuickCase, ...]
    alarms: Mapping[str, Frequency]
    fitted: bool = False

    @property
    def kind(self) -> str:
        """What the cases are."""
        return f"{'fitted' if self.fitted else 'quick'} cases"

    @cached_property
    def amplitudes(self) -> RankTest:
        """Ranks of the true amplitudes in the posterior of the true set."""
        return RankTest.of([rank for case in self.cases for rank in case.amplitude_ranks])

    @cached_property
    def base_numbers(self) -> RankTest:
        """Ranks of base numbers and sensors, one of each case."""
        return RankTest.of([case.base_rank for case in self.cases if not case.outside])

    @cached_property
    def misfits(self) -> RankTest:
        """Probabilities of the true set's misfit."""
        return RankTest.of([case.p_value for case in self.cases if not case.outside])

    @cached_property
    def best_sets(self) -> Reliability:
        """Probability that the members of the most probable set act."""
        return Reliability.of([case.stated for case in self.cases], [case.right for case in self.cases])

    @cached_property
    def effects(self) -> Reliability:
        """Probability that an effect acts, of all effects above 0.5 %."""
        pairs = [pair for case in self.cases for pair in case.inclusion]
        return Reliability.of([share for share, _ in pairs], [acts for _, acts in pairs])

    @cached_property
    def identified(self) -> Reliability:
        """Probability stated by "identified"."""
        named = [case for case in self.cases if case.verdict == "identified"]
        return Reliability.of([case.stated for case in named], [case.right for case in named])

    @cached_property
    def unexplained(self) -> Frequency:
        """Verdicts "unexplained" among the cases whose cause is in the catalogue."""
        inside = [case for case in self.cases if not case.outside]
        return Frequency(sum(case.verdict == UNEXPLAINED for case in inside), len(inside))

    @cached_property
    def _halves(self) -> tuple[tuple[QuickCase, ...], tuple[QuickCase, ...]]:
        half = len(self.cases) // 2
        return self.cases[:half], self.cases[half:]

    @cached_property
    def thresholds(self) -> dict[str, float]:
        """Group -> conformal threshold, from the first half of the cases."""
        first, _ = self._halves
        return {
            name: conformal_threshold([case.before_truth for case in first if case.effect_leads == leads])
            for leads, name in LEADS.items()
        }

    @cached_property
    def coverage(self) -> dict[str, Frequency]:
        """Group -> fresh cases (the second half) whose conformal set holds the true set."""
        _, fresh = self._halves
        groups = {name: [case for case in fresh if case.effect_leads == leads] for leads, name in LEADS.items()}
        held = {
            name: Frequency(sum(case.before_truth <= self.thresholds[name] for case in cases), len(cases), COVERAGE)
            for name, cases in groups.items()
        }
        return held | {"all": Frequency(sum(each.count for each in held.values()), len(fresh), COVERAGE)}

    @cached_property
    def sizes(self) -> dict[str, float]:
        """Group -> median number of sets in the conformal set of a fresh case."""
        _, fresh = self._halves
        return {
            name: float(
                np.median([case.size_at(self.thresholds[name]) for case in fresh if case.effect_leads == leads])
            )
            if any(case.effect_leads == leads for case in fresh)
            else 0.0
            for leads, name in LEADS.items()
        }

    def to_dict(self) -> dict[str, Any]:
        """Contents of ``calibration.json``."""
        coverage = {name: {"held": each.count, **each.to_dict()} for name, each in self.coverage.items()}
        return {
            "study": self.study,
            "layout": {"sensors": list(self.sensors), "runs": list(self.runs)},
            "seed": self.seed,
            "cases": len(self.cases),
            "fitted": self.fitted,
            "ranks": {
                "amplitudes": self.amplitudes.to_dict(),
                "base_numbers_and_sensors": self.base_numbers.to_dict(),
                "misfit_of_the_true_set": self.misfits.to_dict(),
            },
            "reliability": {
                "best_set": self.best_sets.to_dict(),
                "effects": self.effects.to_dict(),
                "identified": self.identified.to_dict(),
            },
            "unexplained": {
                "cases_with_a_cause_in_the_catalogue": self.unexplained.to_dict(),
                "nothing_hidden": {name: each.to_dict() for name, each in self.alarms.items()},
            },
            "conformal": {
                "coverage_wanted": COVERAGE,
                "thresholds": self.thresholds,
                "fresh_cases": coverage,
                "median_sets": self.sizes,
            },
        }

    def words(self) -> list[str]:
        """The results as lines of text."""
        lines = [f"{len(self.cases)} {self.kind} of {self.study}, seed {self.seed}; intervals of 95 %."]
        for name, ranks in (
            ("amplitudes", self.amplitudes),
            ("base numbers and sensors", self.base_numbers),
            ("misfits of the true set", self.misfits),
        ):
            lines.append(f"Ranks of {name}: {sum(ranks.counts)}, uniform with p = {ranks.p_value:.2g}.")
        for name, reliability in (
            ("most probable set", self.best_sets),
            ("single effects", self.effects),
            ('"identified"', self.identified),
        ):
            error = f"expected calibration error {100 * reliability.error:.1f} %, p = {reliability.p_value:.2g}"
            lines.append(f"Probabilities of the {name}: {error}.")
            lines += [f"  stated {100 * each.stated:5.1f} %: {frequency_words(each.true)}" for each in reliability.bins]
        lines.append(f'"unexplained" with a cause in the catalogue: {frequency_words(self.unexplained)}.')
        lines += [
            f'"unexplained" with nothing hidden, by {name}: {frequency_words(each)}.'
            for name, each in self.alarms.items()
        ]
        for name, each in self.coverage.items():
            size = f"; {self.sizes[name]:g} sets (median)" if name in self.sizes else ""
            lines.append(f"Conformal sets, {name}: hold the true set in {frequency_words(each)}{size}.")
        return lines


def frequency_words(each: Frequency) -> str:
    """A frequency with its interval, and the stated share.

    >>> frequency_words(Frequency(19, 20, 0.95))
    '19 of 20, 95 % (75.1 to 99.9); stated: 95 %'
    """
    if not each.of:
        return "no case"
    low, high = (100 * edge for edge in each.interval)
    stated = "" if each.stated is None else f"; stated: {100 * each.stated:g} %"
    return f"{each.count} of {each.of}, {100 * each.share:.3g} % ({low:.3g} to {high:.3g}){stated}"


def calibrate(
    layout: LinearLayout,
    cases: int | Sequence[QuickCase],
    seed: int = 1,
    *,
    study: str = "",
    sensors: Sequence[str] = (),
    runs: Sequence[str] = (),
    draws: int = DRAWS,
) -> Calibration:
    """What judged ``cases`` of a layout say (a number: quick cases), and ``draws`` readings with nothing hidden.

    Causes, amplitudes, base numbers, sensors and noise are drawn from the priors that the diagnosis states, so right
    probabilities are calibrated. Quick cases and draws are linear: what saturation does, fitted cases show; what other
    models do, only blind tests.
    """
    judged = tuple(quick_cases(layout, cases, seed)) if isinstance(cases, int) else tuple(cases)
    alarms = false_alarms(layout, draws, seed) if draws else {}
    return Calibration(study, tuple(sensors), tuple(runs), seed, judged, alarms)


def calibrated(
    study: StudyData,
    known: Sensitivities,
    count: int,
    seed: int = 1,
    tick: Callable[[int], None] | None = None,
    fitted: Sequence[QuickCase] | None = None,
) -> Calibration:
    """Calibration of the planned runs of a study with known sensitivities, see `calibrate`.

    ``fitted``: cases that take the place of ``count`` quick ones.
    """
    layout = linear_layout(study, known)
    sensors = dict.fromkeys(name for drive in known.drives for name in drive.parts())
    cases = list(fitted or ())
    for case in quick_cases(layout, count, seed) if fitted is None else ():
        cases.append(case)
        if tick:
            tick(len(cases))
    names = [drive.name for drive in known.drives]
    result = calibrate(layout, cases, seed, study=study.name, sensors=tuple(sensors), runs=names)
    return replace(result, fitted=fitted is not None)
