"""The search for missing effects: the problem, the scored sets, and the interface of a search strategy."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.fitting.criterion import Criterion
from tyrefem.diagnose.fitting.fits import FittedSet, continued, first_fits, linear_about, with_sensitivities
from tyrefem.diagnose.forward.multifidelity import Predictions
from tyrefem.diagnose.inference.linear_model import LinearModel
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Candidate, Members, SetPrior, separate
from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]
Tick = Callable[[str], None]


class ScoredSet(NamedTuple):
    """A set with its score ln(prior) + criterion, estimated if there is no fit."""

    score: float
    members: Members
    fit: FittedSet | None


def sets_of(candidates: Members, size: int) -> Iterator[Members]:
    """All sets of ``size`` different effects, or of one effect in different runs."""
    combined = itertools.combinations(candidates, size)
    return (members for members in combined if all(separate(member, members[:i]) for i, member in enumerate(members)))


def rivals_of_names(scored: Sequence[ScoredSet], settings: DiagnosisSettings) -> dict[Members, FittedSet | None]:
    """The best sets without an effect that would be named, as far as they are only estimated -> starts of their fits.

    A start is the best fit with that effect beside effects of the set only, without the effect; None without one. The
    linear model about a fit with an effect says little of a strong other one in its place. ``scored``: all sets.
    """
    scores = np.array([row.score for row in scored])
    shares = np.exp(scores - np.logaddexp.reduce(scores))
    fitted = [row for row in scored if row.fit is not None]
    top = max(row.score for row in fitted)
    estimates = np.array([-np.inf if row.fit is not None else row.score for row in scored])
    rows_of: dict[Candidate, list[int]] = {}
    for number, row in enumerate(scored):
        for member in row.members:
            rows_of.setdefault(member, []).append(number)
    starts: dict[Members, FittedSet | None] = {}
    for member, rows in rows_of.items():
        others = estimates.copy()
        others[rows] = -np.inf
        number = int(np.argmax(others))
        if shares[rows].sum() < settings.challenged_probability or others[number] == -np.inf:
            continue
        best = scored[number]
        without = max((row.score for row in fitted if member not in row.members), default=-np.inf)
        if best.score > max(without, top - settings.name_score):
            together = {member, *best.members}
            wholes = [
                (row.score, row.fit) for row in fitted if member in row.members and together.issuperset(row.members)
            ]
            _, whole = max(wholes, key=lambda pair: pair[0], default=(0.0, None))
            starts[best.members] = None if whole is None or member.presence else whole.without([member])
    return starts


@dataclass(frozen=True, eq=False)
class SelectionProblem(Brief):
    """Inputs of a search: data, candidates, prior and criterion.

    Parameters
    ----------
    residuals : measured minus computed. predictions : readings at other values of the unknowns.
    candidates : effects that may be missing. prior : ln of the prior probability of a set.
    criterion : quality of a set's explanation of the data.
    outside : fit of no effect -> score of a cause outside the catalogue; None: not considered.
    tick : called at every simulation with a description.
    """

    residuals: Residuals
    predictions: Predictions
    candidates: Members
    prior: SetPrior
    criterion: Criterion
    outside: Callable[[FittedSet], float] | None = None
    tick: Tick | None = None

    @property
    def settings(self) -> DiagnosisSettings:
        """Settings of the diagnosis."""
        return self.residuals.settings

    @cached_property
    def linear(self) -> LinearModel:
        """The linear model of the fitted runs about x = 0."""
        return self.residuals.linear(self.residuals.fitted)

    @cached_property
    def _order(self) -> dict[Candidate, int]:
        return {candidate: number for number, candidate in enumerate(self.candidates)}

    def ordered(self, members: Iterable[Candidate]) -> Members:
        """A set in the order of the candidates, so that equal sets are equal tuples."""
        return tuple(sorted(members, key=self._order.__getitem__))

    def score(self, fit: FittedSet) -> float:
        """ln(prior) + criterion of a fitted set."""
        return self.prior(self.ordered(fit.members)) + self.criterion.of_fit(fit)

    def linear_scores(self, model: LinearModel, sets: Sequence[Members]) -> Array:
        """(n_sets,) ln(prior) + criterion of sets in a linear model, without the constant that all sets share."""
        return np.array([self.prior(members) for members in sets]) + self.criterion.of_linear(model, sets)

    def fitted(self, sets: Sequence[Members], starts: Mapping[Members, FittedSet]) -> list[FittedSet]:
        """First fits with the full model; ``starts``: set -> fit of a subset to start from."""
        return first_fits(self.residuals, self.predictions, sets, starts, self._count)

    def continued(self, fits: Sequence[FittedSet]) -> list[FittedSet]:
        """Fits continued to convergence."""
        return continued(self.residuals, self.predictions, fits, self._count)

    def with_sensitivities(self, fit: FittedSet) -> FittedSet:
        """The fit with sensitivities to all other effects at its point."""
        others = [each for each in self.candidates if each not in fit.members]
        unknowns = [unknown for each in others for unknown in (*each.amplitudes, *each.presence)]
        return with_sensitivities(self.residuals, self.predictions, fit, unknowns, self._count)

    def linear_about(self, fit: FittedSet, candidates: Sequence[Candidate]) -> LinearModel:
        """The linear model about a fit; further effects have the columns at x = 0 unless the fit has its own."""
        unknowns = [unknown for each in candidates for unknown in (*each.amplitudes, *each.presence)]
        return linear_about(self.residuals, fit, unknowns)

    def settled(self, scored: Sequence[ScoredSet]) -> list[ScoredSet]:
        """Scored sets, best first, whose leading fits have converged with sensitivities taken at their points.

        The evidence of a fit rests on its sensitivities: those from another point are worth some nats for nothing.
        Fits within ``leading_score`` of the best are continued until they are settled, at most ``most_settlings``
        times. A fit with a misfit that no further step can explain stays as it is. Estimates without a fit stay below
        the best fit.
        """
        settings = self.settings
        rows = {self.ordered(entry.members): entry for entry in scored}
        gap = scored[0].score - max((entry.score for entry in scored if entry.fit is None), default=float("-inf"))
        tried: set[Members] = set()
        changed = False
        for _ in range(settings.most_settlings):
            top = max(entry.score for entry in rows.values() if entry.fit is not None)
            left = [
                entry.fit
                for entry in rows.values()
                if entry.fit is not None and entry.score > top - settings.leading_score and entry.fit.worth_settling
            ]
            parts = {members: part for members, part in self._stuck_parts(rows).items() if members not in tried}
            tried |= set(parts)
            if not left and not parts:
                break
            changed = True
            for number, fit in enumerate(self.continued([*left, *parts.values()])):
                members, score = self.ordered(fit.members), self.score(fit)
                known = rows.get(members)
                # A part keeps its own fit if that is the better one.
                if number < len(left) or known is None or known.fit is None or score > known.score:
                    rows[members] = ScoredSet(score, members, fit)
        if not changed:
            return list(scored)
        highest = max(entry.score for entry in rows.values() if entry.fit is not None) - max(gap, 0.0)
        capped = (
            entry if entry.fit is not None else entry._replace(score=min(entry.score, highest))
            for entry in rows.values()
        )
        return sorted(capped, key=lambda entry: -entry.score)

    def _stuck_parts(self, rows: Mapping[Members, ScoredSet]) -> dict[Members, FittedSet]:
        """Parts of the best set whose fits ended far from their best points: part -> start for its fit.

        The linear model about the best fit, without one effect, predicts the score of the rest. Where it is among the
        leading ones, and more than ``near_score`` above that of the rest's own fit, the fit of the rest must start
        there: else the effect would be named because the rest was fitted badly.
        """
        settings = self.settings
        best = max((entry for entry in rows.values() if entry.fit is not None), key=lambda entry: entry.score)
        assert best.fit is not None
        parts = {}
        for member in (each for each in best.members if not each.presence):
            part = best.fit.without([member])
            members = self.ordered(part.members)
            of_part, of_best = (self.criterion.of_linear(fit.linear, [()])[0] for fit in (part, best.fit))
            score = best.score + float(of_part - of_best) + self.prior(members) - self.prior(best.members)
            known = rows.get(members)
            beyond = known is None or known.fit is None or score > known.score + settings.near_score
            if score > best.score - settings.leading_score and beyond:
                parts[members] = part
        return parts

    def settled_fit(self, fit: FittedSet) -> FittedSet:
        """A fit continued until it has converged with sensitivities taken at its point, if it gets there."""
        for _ in range(self.settings.most_settlings):
            if not fit.worth_settling:
                break
            (fit,) = self.continued([fit])
        return fit

    def _count(self) -> None:
        if self.tick is not None:
            self.tick("simulating")


class Strategy(Protocol):
    """A search over sets of effects."""

    def check(self, study: StudyData, candidates: Members, settings: DiagnosisSettings) -> None:
        """Check the inputs of the search before the first simulation.

        Raises
        ------
        InputError : the search is too large; the message names the limit and the remedy.
        """
        ...

    def search(self, problem: SelectionProblem) -> list[ScoredSet]:
        """Sets with their scores, best first; the empty set and all single effects are included.

        Every set that may be the best set has a fit, and the empty set has a fit.
        """
        ...
