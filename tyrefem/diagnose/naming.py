"""Which effects a gap is put down to: search, heat of unknown origin, judgement."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable

from tyrefem.diagnose.explained import Explained
from tyrefem.diagnose.gap import Gap
from tyrefem.diagnose.missing import MissingHeat, missing_heat, missing_heat_fitted, patches
from tyrefem.diagnose.refine import refined
from tyrefem.diagnose.search import Scored, search
from tyrefem.diagnose.sets import Prior
from tyrefem.diagnose.unknowns import Candidate
from tyrefem.diagnose.verdict import IMPROBABLE, OUTSIDE, judge, standings
from tyrefem.studies import Study

#: Heat of unknown origin that the linear model puts this far, or less, below the best set is fitted in the full model.
NEAR = 10.0


class Naming:
    """What the search of one look comes to.

    Attributes
    ----------
    judgement : verdict and sets with their probabilities. best, null : fits with the most probable set and with none.
    missing : heat of unknown origin.
    """

    def __init__(
        self, gap: Gap, study: Study, found: tuple[Candidate, ...], largest: int, count: Callable[[str], None]
    ) -> None:
        self.gap = gap
        prior = Prior(found, study.card.diagnosis.effects_expected)
        scored, self.missing = _searched(gap, study, found, prior, largest, count)
        self.explained = {one.members: one for _, _, one in scored if one is not None}
        self.null = self.explained[()]
        self.judgement = judge(standings(scored, _outside(study) + self.missing.log_evidence), self.fitted)
        ahead = self.judgement.best
        self.best = ahead.explained or (self.null if ahead.unexplained else self.fitted(ahead.members))

    def fitted(self, members: tuple[Candidate, ...]) -> Explained:
        """The fit of a set, made if it has none."""
        if members not in self.explained:
            self.explained[members] = refined(self.gap, [members])[0]
        return self.explained[members]


def _outside(study: Study) -> float:
    """ln of the prior probability that what is missing is not in the catalogue."""
    return math.log(study.card.diagnosis.effects_expected * OUTSIDE)


def _searched(
    gap: Gap, study: Study, found: tuple[Candidate, ...], prior: Prior, largest: int, count: Callable[[str], None]
) -> tuple[list[Scored], MissingHeat]:
    """All sets with their scores, and heat of unknown origin: in the full model where it may matter."""
    unknown, outside = patches(study), _outside(study)

    @functools.cache
    def linear(null: Explained) -> MissingHeat:
        return missing_heat(gap, unknown, null)

    def elsewhere(null: Explained) -> float:
        return outside + linear(null).log_evidence

    scored = search(gap, found, prior, largest=largest, tick=count, outside=elsewhere)
    null = next(one for _, members, one in scored if one is not None and not members)
    missing = linear(null)
    score, _, ahead = scored[0]
    doubtful = ahead is None or ahead.p_value < IMPROBABLE or ahead.held_out_p < IMPROBABLE
    if doubtful or outside + missing.log_evidence > score - NEAR:
        missing = missing_heat_fitted(gap, unknown, null, lambda: count("fitting heat of unknown origin"))
    return scored, missing
