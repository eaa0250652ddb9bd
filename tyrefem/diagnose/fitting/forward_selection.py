"""Forward selection with the full model; the linear model about each fit ranks larger sets."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.fitting.selection import ScoredSet, SelectionProblem, rivals_of_names, sets_of
from tyrefem.diagnose.inference.linear_model import LinearModel
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Members, separate
from tyrefem.inputs.study import StudyData


@dataclass(frozen=True)
class ForwardSelection:
    """Sets grow by one effect at a time from sets that explain the data.

    1. The empty set is fitted. If it nearly explains the data, sensitivities to all effects are taken at its fit, and
       the linear model about it ranks all effects and pairs: those at x = 0 do not show an effect that base numbers
       imitate. Else, or if noise does not explain what the search leaves, the linear model about x = 0 ranks them too,
       and the best effects are fitted from there.
    2. From every good fit, the linear model about it ranks the sets with one more effect. The best sets are fitted.
       Where noise does not explain what the best fit leaves, its sensitivities are taken at its fit, too.
    3. At the end every subset of the best set is fitted (backward check). The leading fits are continued until they are
       settled; where one rises, the sets with one more effect are estimated anew (2). The best set without an effect
       that would be named is fitted, too.

    The search ends early if a cause outside the catalogue is far ahead.

    The search can miss two effects that explain the data only together, each alone much worse than other effects,
    unless another one would be named. `tyrefem.diagnose.fitting.exhaustive.Exhaustive` does not miss them.
    """

    def check(self, study: StudyData, candidates: Members, settings: DiagnosisSettings) -> None:
        """Accepts any number of candidates."""

    def search(self, problem: SelectionProblem) -> list[ScoredSet]:
        """See `tyrefem.diagnose.fitting.selection.Strategy`."""
        settings = problem.settings
        progress = _Progress(problem)
        progress.fit([()])
        singles, pairs = (progress.estimated(size) for size in (1, 2))
        # Two effects that cancel each other may both seem weak alone, so the members of the best pair are fitted too.
        ahead = [(member,) for member in (pairs[0] if pairs else ())]
        none = progress.fits[()]
        if none.close:
            progress.extend_none()
        else:
            progress.fit([*singles[: settings.singles], *ahead], {})
        outside = problem.outside(none) if problem.outside else -np.inf
        progress.grow(outside)
        if none.close and progress.missing:
            progress.fit_again([*singles[: settings.singles], *ahead])
            progress.grow(outside)
        for _ in range(settings.most_settlings):
            if not progress.settle():
                break
            progress.grow(outside)
        for _ in range(settings.name_rounds):
            starts = rivals_of_names(progress.scored(), settings)
            if not starts:
                break
            progress.fit(starts, {members: start for members, start in starts.items() if start is not None})
        return progress.scored()


def screened(problem: SelectionProblem, linear: LinearModel) -> list[tuple[float, Members]]:
    """The empty set, single effects and pairs with their scores in a linear model, best first."""
    sizes = range(min(problem.settings.largest, 2) + 1)
    sets = [members for size in sizes for members in sets_of(problem.candidates, size)]
    scores = problem.linear_scores(linear, sets).tolist()
    return sorted(zip(scores, sets, strict=True), key=lambda pair: -pair[0])


class _Progress:
    """The fitted sets, and estimated scores of the other sets."""

    def __init__(self, problem: SelectionProblem) -> None:
        self.problem, self.settings = problem, problem.settings
        self.fits: dict[Members, FittedSet] = {}
        #: Set -> number of times that its fit was continued.
        self._continuations: Counter[Members] = Counter()
        #: Sets with sensitivities to all effects at their fits.
        self._renewed: set[Members] = set()
        linear = problem.linear
        #: Set -> (estimated score, whether the estimate is from the fit of a subset).
        self._estimate: dict[Members, tuple[float, bool]] = {
            problem.ordered(members): (score + linear.constant, False) for score, members in screened(problem, linear)
        }

    def score(self, members: Members) -> float:
        return self.problem.score(self.fits[members])

    @property
    def top(self) -> float:
        return max(self.score(members) for members in self.fits)

    def estimated(self, size: int) -> list[Members]:
        """Sets of ``size`` effects, best estimate first."""
        sets = (members for members in self._estimate if len(members) == size)
        return sorted(sets, key=lambda members: -self._estimate[members][0])

    def fit(self, sets: Iterable[Members], starts: Mapping[Members, FittedSet] | None = None) -> None:
        """Fit sets without a fit, continue the leading fits, and estimate the sets that add one effect to a good fit.

        ``starts``: of the fits, others begin at x = 0; None: fits of their best parts near the data.
        """
        wanted = [members for members in dict.fromkeys(sets) if members not in self.fits]
        self._take(self.problem.fitted(wanted, self._starts(wanted) if starts is None else starts))
        self._judge(wanted)

    def fit_again(self, sets: Sequence[Members]) -> None:
        """Fit sets from x = 0, whose fits may have begun at distorted base numbers; the better fit of each stays."""
        known = {members: self.score(members) for members in sets if members in self.fits}
        fits = self.problem.fitted(list(dict.fromkeys(sets)), {})
        better = [
            fit for fit in fits if self.problem.score(fit) > known.get(self.problem.ordered(fit.members), -np.inf)
        ]
        self._take(better)
        self._judge([self.problem.ordered(fit.members) for fit in better])

    def _judge(self, wanted: Sequence[Members]) -> None:
        """Continue the leading fits, and estimate the sets that add to new good fits."""
        # A continued fit gives better estimates of the sets that add to it.
        for members in dict.fromkeys((*wanted, *self._continue_leading())):
            good = self.score(members) > self.top - self.settings.far_score
            if members and len(members) < self.settings.largest and good:
                self._extend(members)

    def _take(self, fits: Sequence[FittedSet]) -> None:
        self.fits |= {self.problem.ordered(fit.members): fit for fit in fits}

    def _starts(self, sets: Sequence[Members]) -> dict[Members, FittedSet]:
        """Set -> fit of its best subset that nearly explains the data, if there is one."""
        ahead = [members for members in sorted(self.fits, key=self.score, reverse=True) if self.fits[members].close]
        parts = {members: next((part for part in ahead if set(part) < set(members)), None) for members in sets}
        return {members: self.fits[part] for members, part in parts.items() if part is not None}

    def _continue_leading(self) -> list[Members]:
        """Continue the leading fits to convergence, because they decide the verdict. Returns their sets."""
        settings, continued = self.settings, []
        for _ in range(settings.continued_sets * settings.most_continuations):
            ahead = sorted(self.fits, key=self.score, reverse=True)[: settings.continued_sets]
            far = self.top - settings.far_score
            left = [members for members in ahead if self.score(members) > far and self._worth_continuing(members)]
            if not left:
                break
            self._take(self.problem.continued([self.fits[members] for members in left]))
            self._continuations.update(left)
            continued += left
        return continued

    def _worth_continuing(self, members: Members) -> bool:
        fit, times, settings = self.fits[members], self._continuations[members], self.settings
        if fit.finished or times >= settings.most_continuations:
            return False
        if times or not any(self.fits):
            return (
                fit.misfit
                < (settings.continued_twice_misfit if times else settings.none_continued_misfit) * fit.readings
            )
        return fit.worth_continuing

    def extend_none(self) -> None:
        """Estimate all single effects and pairs in the linear model about the fit of no effect."""
        problem = self.problem
        self._renewed.add(())
        self.fits[()] = problem.with_sensitivities(self.fits[()])
        about = problem.linear_about(self.fits[()], problem.candidates)
        of_none = float(problem.linear_scores(about, [()])[0])
        for score, members in screened(problem, about):
            if members:
                self._raise_estimate(problem.ordered(members), self.score(()) + score - of_none)

    def _raise_estimate(self, members: Members, value: float) -> None:
        """An estimate of a set from the fit of a subset. With estimates from two subsets, the larger one counts."""
        known, judged = self._estimate.get(members, (0.0, False))
        self._estimate[members] = (max(value, known) if judged else value, True)

    def grow(self, outside: float) -> None:
        """Fit the most promising sets, batch by batch. ``outside``: score of a cause outside the catalogue."""
        settings, batches = self.settings, 0
        while len(self.fits) < settings.most_sets:
            if batches >= settings.largest and outside > self.top + settings.outside_lead:
                break
            batches += 1
            self._renew_best()
            sets = self.promising()[: settings.batch] or self.missing_parts()
            if not sets:
                break
            self.fit(sets)

    def settle(self) -> bool:
        """Continue the leading fits until they are settled, and estimate the sets that add to those that rose.

        Returns whether any rose by more than ``near_score``: sets with one more effect were then estimated too low.
        """
        before = {members: self.score(members) for members in self.fits}
        self._take([entry.fit for entry in self.problem.settled(self.scored()) if entry.fit is not None])
        far = self.top - self.settings.far_score
        rose = [
            members
            for members in self.fits
            if self.score(members) > max(before.get(members, -np.inf) + self.settings.near_score, far)
        ]
        for members in rose:
            if not members and self.fits[()].close:
                self.extend_none()
            elif members and len(members) < self.settings.largest:
                self._extend(members)
        return bool(rose)

    @property
    def missing(self) -> bool:
        """Whether noise does not explain what the best fit leaves."""
        return self.fits[max(self.fits, key=self.score)].p_value < self.settings.usual_p

    def _renew_best(self) -> None:
        """Estimate the sets that add to the best fit anew, with sensitivities at its point, if something is missing."""
        best = max(self.fits, key=self.score)
        fit = self.fits[best]
        if not (fit.close and self.missing) or len(best) >= self.settings.largest or best in self._renewed:
            return
        self._renewed.add(best)
        self.fits[best] = self.problem.with_sensitivities(fit)
        self._extend(best)

    def _extend(self, members: Members) -> None:
        """Estimate every set with one more effect in the linear model about the fit."""
        problem = self.problem
        others = [candidate for candidate in problem.candidates if separate(candidate, members)]
        about = problem.linear_about(self.fits[members], others)
        of_part, *of_wholes = problem.criterion.of_linear(about, [(), *((other,) for other in others)]).tolist()
        for candidate, of_whole in zip(others, of_wholes, strict=True):
            more = problem.ordered((*members, candidate))
            gain = of_whole - of_part + problem.prior(more) - problem.prior(members)
            self._raise_estimate(more, self.score(members) + gain)

    def promising(self) -> list[Members]:
        """Sets without a fit that may be the best set, best estimate first."""
        top, settings = self.top, self.settings
        # A pair without an estimate from a subset waits until its members are fitted.
        sets = [
            (value, members)
            for members, (value, judged) in self._estimate.items()
            if members not in self.fits
            and value > top - (settings.near_score if judged else settings.far_score)
            and (judged or len(members) < 2)
        ]
        return [members for _, members in sorted(sets, key=lambda pair: -pair[0])]

    def missing_parts(self) -> list[Members]:
        """Subsets of the best set that have no fit."""
        best = max(self.fits, key=self.score)
        parts = [part for size in range(1, len(best)) for part in itertools.combinations(best, size)]
        return [part for part in parts if part not in self.fits]

    def scored(self) -> list[ScoredSet]:
        """All sets, best first; no set without a fit ranks above the best fitted set."""
        highest = self.top - self.settings.near_score
        sets = [ScoredSet(self.score(members), members, fit) for members, fit in self.fits.items()]
        sets += [
            ScoredSet(min(value, highest), members, None)
            for members, (value, _) in self._estimate.items()
            if members not in self.fits
        ]
        return sorted(sets, key=lambda scored: -scored.score)
