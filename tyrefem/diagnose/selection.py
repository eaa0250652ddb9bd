"""What a search for the missing effects is given, and what it gives back; the search itself is a `Strategy`."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

from tyrefem.brief import Brief
from tyrefem.diagnose.candidates import Candidate, Members, SetPrior
from tyrefem.diagnose.criterion import Criterion
from tyrefem.diagnose.fits import FittedSet, carried_on, first_fits, linear_about
from tyrefem.diagnose.linear_model import LinearModel
from tyrefem.diagnose.multifidelity import Predictions
from tyrefem.diagnose.residuals import Residuals
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.inputs.study import StudyData

Tick = Callable[[str], None]


class ScoredSet(NamedTuple):
    """A set with ln(prior) + criterion; estimated where it was not fitted."""

    score: float
    members: Members
    fit: FittedSet | None


def sets_of(candidates: Members, size: int) -> Iterator[Members]:
    """All sets of so many different effects."""
    combined = itertools.combinations(candidates, size)
    return (members for members in combined if len({member.name for member in members}) == size)


@dataclass(frozen=True, eq=False)
class SelectionProblem(Brief):
    """Data, candidates and criterion: everything but the order in which sets are tried.

    Parameters
    ----------
    residuals : measured minus computed. predictions : what the sensors read at other points.
    candidates : effects that may be missing. prior : ln of the prior probability of a set.
    criterion : how well a set explains the data.
    outside : score of a cause outside the catalogue, given the fit of no effect; None: not asked for.
    tick : called with what is done at every simulation.
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
        """Those of the diagnosis."""
        return self.residuals.settings

    @cached_property
    def linear(self) -> LinearModel:
        """The linear model of the fitted runs about the study as it is."""
        return self.residuals.linear(self.residuals.fitted)

    @cached_property
    def _order(self) -> dict[Candidate, int]:
        return {candidate: number for number, candidate in enumerate(self.candidates)}

    def ordered(self, members: Iterable[Candidate]) -> Members:
        """A set in the order of the candidates: the same set is always the same tuple."""
        return tuple(sorted(members, key=self._order.__getitem__))

    def score(self, fit: FittedSet) -> float:
        """ln(prior) + criterion of a fitted set."""
        return self.prior(self.ordered(fit.members)) + self.criterion.of_fit(fit)

    def linear_score(self, model: LinearModel, members: Members) -> float:
        """The same in a linear model, without the constant that all its sets share."""
        return self.prior(members) + self.criterion.of_linear(model, members)

    def fitted(self, sets: Sequence[Members], starts: Mapping[Members, FittedSet]) -> list[FittedSet]:
        """First fits with the full model; ``starts``: the fit of a part of a set to begin with."""
        return first_fits(self.residuals, self.predictions, sets, starts, self._count)

    def carried_on(self, fits: Sequence[FittedSet]) -> list[FittedSet]:
        """Fits carried on to convergence."""
        return carried_on(self.residuals, self.predictions, fits, self._count)

    def linear_about(self, fit: FittedSet, candidates: Sequence[Candidate]) -> LinearModel:
        """The linear model about a fit, with further effects' columns as in the study as it is."""
        unknowns = [unknown for each in candidates for unknown in (*each.amplitudes, *each.presence)]
        return linear_about(self.residuals, fit, unknowns)

    def _count(self) -> None:
        if self.tick is not None:
            self.tick("simulating")


class Strategy(Protocol):
    """Which sets are fitted, in which order."""

    def check(self, study: StudyData, candidates: Members, settings: DiagnosisSettings) -> None:
        """Refuse what the search cannot do, before anything is simulated.

        Raises
        ------
        InputError : what is too much, and what to do.
        """
        ...

    def search(self, problem: SelectionProblem) -> list[ScoredSet]:
        """Sets with their scores, best first, among them that of no effect and all single effects.

        Every set that may be the best one has a fit. No effect has one in any case.
        """
        ...
