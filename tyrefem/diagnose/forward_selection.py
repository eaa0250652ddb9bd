"""Forward selection with the full model, each fit being the point from which larger sets are judged."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from tyrefem.diagnose.candidates import Members
from tyrefem.diagnose.fits import FittedSet
from tyrefem.diagnose.linear_model import LinearModel
from tyrefem.diagnose.selection import ScoredSet, SelectionProblem, sets_of
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.inputs.study import StudyData


@dataclass(frozen=True)
class ForwardSelection:
    """Sets grow effect by effect from those that explain the data.

    No effect is fitted first. Where it nearly explains the data, all effects and pairs are judged in the linear model
    about that fit, else in that of the study as it is, and the most promising effects are fitted with the full model.
    From every good fit, each effect that could be added is judged in the linear model about it, and the promising sets
    are fitted in turn. At the end every part of the best set has been fitted too (the backward check). Where a cause
    outside the catalogue is far ahead, the search ends.

    Two effects that explain the data together are missed where each alone explains them much worse than others do;
    `tyrefem.diagnose.exhaustive.Exhaustive` finds them.
    """

    def check(self, study: StudyData, candidates: Members, settings: DiagnosisSettings) -> None:
        """Any number of candidates is welcome."""

    def search(self, problem: SelectionProblem) -> list[ScoredSet]:
        """See `tyrefem.diagnose.selection.Strategy`."""
        settings = problem.settings
        progress = _Progress(problem)
        progress.fit([()])
        singles, pairs = (progress.estimated(size) for size in (1, 2))
        # Two effects that hide each other may both look weak alone: the parts of the best pair are tried as well.
        ahead = [(member,) for member in (pairs[0] if pairs else ())]
        if progress.fits[()].close:
            progress.extend_none()
        else:
            progress.fit([*singles[: settings.singles], *ahead])
        batches = 0
        outside = problem.outside(progress.fits[()]) if problem.outside else -np.inf
        while len(progress.fits) < settings.most_sets:
            if batches >= settings.largest and outside > progress.top + settings.hopeless:
                break
            batches += 1
            sets = progress.promising()[: settings.batch] or progress.missing_parts()
            if not sets:
                break
            progress.fit(sets)
        return progress.scored()


def screened(problem: SelectionProblem, linear: LinearModel) -> list[tuple[float, Members]]:
    """Single effects and pairs with their scores in a linear model, best first; the empty set included."""
    sizes = range(min(problem.settings.largest, 2) + 1)
    sets = [members for size in sizes for members in sets_of(problem.candidates, size)]
    return sorted(((problem.linear_score(linear, members), members) for members in sets), key=lambda pair: -pair[0])


class _Progress:
    """The sets fitted so far, and estimates for all others."""

    def __init__(self, problem: SelectionProblem) -> None:
        self.problem, self.settings = problem, problem.settings
        self.fits: dict[Members, FittedSet] = {}
        #: Set -> how often its fit was carried on.
        self._carried: Counter[Members] = Counter()
        linear = problem.linear
        #: Set -> (estimate of its score, whether it was judged from the fit of a part).
        self._estimate: dict[Members, tuple[float, bool]] = {
            problem.ordered(members): (score + linear.constant, False) for score, members in screened(problem, linear)
        }

    def score(self, members: Members) -> float:
        return self.problem.score(self.fits[members])

    @property
    def top(self) -> float:
        return max(self.score(members) for members in self.fits)

    def estimated(self, size: int) -> list[Members]:
        """Sets of so many effects, best estimate first."""
        sets = (members for members in self._estimate if len(members) == size)
        return sorted(sets, key=lambda members: -self._estimate[members][0])

    def fit(self, sets: Iterable[Members]) -> None:
        """Fit sets; carry the leading fits on; judge what could be added to the good ones."""
        wanted = [members for members in dict.fromkeys(sets) if members not in self.fits]
        self._take(self.problem.fitted(wanted, self._starts(wanted)))
        # From a fit that has converged, the sets that add to it are judged once more.
        for members in dict.fromkeys((*wanted, *self._carry_on())):
            good = self.score(members) > self.top - self.settings.far
            if members and len(members) < self.settings.largest and good:
                self._extend(members)

    def _take(self, fits: Sequence[FittedSet]) -> None:
        self.fits |= {self.problem.ordered(fit.members): fit for fit in fits}

    def _starts(self, sets: Sequence[Members]) -> dict[Members, FittedSet]:
        """For every set the best of its parts that nearly explains the data, if any."""
        ahead = [members for members in sorted(self.fits, key=self.score, reverse=True) if self.fits[members].close]
        parts = {members: next((part for part in ahead if set(part) < set(members)), None) for members in sets}
        return {members: self.fits[part] for members, part in parts.items() if part is not None}

    def _carry_on(self) -> list[Members]:
        """Carry the leading fits on to convergence: their numbers decide. Returns which."""
        settings, carried = self.settings, []
        for _ in range(settings.carried_sets * settings.carried_times):
            ahead = sorted(self.fits, key=self.score, reverse=True)[: settings.carried_sets]
            far = self.top - settings.far
            left = [members for members in ahead if self.score(members) > far and self._worth_carrying(members)]
            if not left:
                break
            self._take(self.problem.carried_on([self.fits[members] for members in left]))
            self._carried.update(left)
            carried += left
        return carried

    def _worth_carrying(self, members: Members) -> bool:
        fit, times, settings = self.fits[members], self._carried[members], self.settings
        if fit.finished or times >= settings.carried_times:
            return False
        if times or not any(self.fits):
            return fit.misfit < (settings.doubted if times else settings.none_carried) * fit.readings
        # The first steps of a strong effect may still be far off; what the linear model promises counts.
        return -2 * fit.log_evidence < settings.lost * fit.readings

    def extend_none(self) -> None:
        """Judge all single effects and pairs in the linear model about the fit of no effect."""
        problem = self.problem
        about = problem.linear_about(self.fits[()], problem.candidates)
        of_none = problem.linear_score(about, ())
        for score, members in screened(problem, about):
            if members:
                self._estimate[problem.ordered(members)] = (self.score(()) + score - of_none, True)

    def _extend(self, members: Members) -> None:
        """Judge every set that adds one effect, in the linear model about the fit."""
        problem, criterion = self.problem, self.problem.criterion
        taken = {member.name for member in members}
        others = [candidate for candidate in problem.candidates if candidate.name not in taken]
        about = problem.linear_about(self.fits[members], others)
        of_part = criterion.of_linear(about, ())
        for candidate in others:
            more = problem.ordered((*members, candidate))
            gain = criterion.of_linear(about, (candidate,)) - of_part + problem.prior(more) - problem.prior(members)
            known, judged = self._estimate.get(more, (0.0, False))
            value = self.score(members) + gain
            # Judged from two parts, the better one counts.
            self._estimate[more] = (max(value, known) if judged else value, True)

    def promising(self) -> list[Members]:
        """Sets without a fit that may be the best, best estimate first."""
        top, settings = self.top, self.settings
        # A pair judged from afar waits until its parts have been fitted and it can be judged from there.
        sets = [
            (value, members)
            for members, (value, judged) in self._estimate.items()
            if members not in self.fits
            and value > top - (settings.near if judged else settings.far)
            and (judged or len(members) < 2)
        ]
        return [members for _, members in sorted(sets, key=lambda pair: -pair[0])]

    def missing_parts(self) -> list[Members]:
        """Parts of the best set that have no fit yet."""
        best = max(self.fits, key=self.score)
        parts = [part for size in range(1, len(best)) for part in itertools.combinations(best, size)]
        return [part for part in parts if part not in self.fits]

    def scored(self) -> list[ScoredSet]:
        """All sets, best first; one that was only judged from afar does not stand above the best that was fitted."""
        highest = self.top - self.settings.near
        sets = [ScoredSet(self.score(members), members, fit) for members, fit in self.fits.items()]
        sets += [
            ScoredSet(min(value, highest), members, None)
            for members, (value, _) in self._estimate.items()
            if members not in self.fits
        ]
        return sorted(sets, key=lambda scored: -scored.score)
