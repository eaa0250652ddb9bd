"""The search: which sets to fit with the full model, until no unfitted set can matter."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from tyrefem.diagnose.evidence import Members
from tyrefem.diagnose.refine import Explained, Gap, refined
from tyrefem.diagnose.sets import Prior, screened
from tyrefem.diagnose.unknowns import Candidate

#: Sets fitted at once, and in all.
BATCH, MOST = 4, 14
#: A set whose ln(prior x evidence) at first sight is so far below the best needs no full fit; and one that only adds
#: to a set which has been fitted, so that its estimate can be trusted more.
FAR, NEAR = 9.0, 4.0
Scored = tuple[float, Members, Explained | None]


def search(
    gap: Gap,
    candidates: Sequence[Candidate],
    prior: Prior,
    *,
    largest: int = 3,
    tick: Callable[[str], None] | None = None,
) -> list[Scored]:
    """Sets with ln(prior x evidence of the fitted runs), best first; with the fit where there was one.

    The linear model orders the sets; the promising ones are fitted with the full model, a few at a time, and every fit
    moves the estimate for the sets that contain it.
    """
    linear = gap.linear(gap.fitted)
    first = {members: score + linear.constant for score, members in screened(linear, candidates, prior, largest)}
    done: dict[Members, Explained] = {}

    def fit(sets: list[Members]) -> None:
        for one in refined(gap, sets, (lambda: tick("simulating")) if tick else None):
            done[one.members] = one

    fit([()])
    while len(done) < MOST:
        estimate = {members: _estimate(members, first, done, prior) for members in first if members not in done}
        top = max(_score(one, prior) for one in done.values())
        ahead = sorted((-score, number, members) for number, (members, score) in enumerate(estimate.items()))
        promising = [
            members for negative, _, members in ahead if -negative > top - (NEAR if _begun(members, done) else FAR)
        ][:BATCH]
        if not promising:
            break
        fit(promising)
    scored: list[Scored] = [(_score(one, prior), one.members, one) for one in done.values()]
    scored += [(_estimate(members, first, done, prior), members, None) for members in first if members not in done]
    return sorted(scored, key=lambda one: -one[0])


def _begun(members: Members, done: dict[Members, Explained]) -> bool:
    return any(one and set(one) < set(members) for one in done)


def _score(one: Explained, prior: Prior) -> float:
    return prior(one.members) + one.log_evidence


def _estimate(members: Members, first: dict[Members, float], done: dict[Members, Explained], prior: Prior) -> float:
    """The linear score, moved by what the full fit gained for the largest fitted part of the set."""
    parts = [one for one in done if set(one) < set(members)]
    size = max((len(one) for one in parts), default=0)
    gains = [_score(done[one], prior) - first[one] for one in parts if len(one) == size]
    return first[members] + (max(gains) if gains else 0.0)
