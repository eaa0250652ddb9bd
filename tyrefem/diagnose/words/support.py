"""How far one sensor or one run alone speaks for the named effects, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.diagnose.fitting.support import ALONE, RUN, SENSOR, LeftOut
from tyrefem.diagnose.numbers import at_least, percent, run_words

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.unknowns.candidates import Candidate, Members


def stated_words(d: DiagnosisData, members: Members, chance: float, text: str) -> str:
    """A set at the confidence of its weakest member, as a clause: "It is at least 97 % probable ...".

    ``chance``: probability of the set with all readings, ``text``: the same in words. An effect that only one sensor or
    run asks for is said to be that.
    """
    subject = "They are together" if len(members) > 1 else "It is"
    weakest = _weakest(d)
    if weakest is None:
        return f"{subject} {text} probable"
    member, left = weakest
    least = left.probability
    if least < ALONE:
        alone = f"without {_named(left)}, which alone {_tells(member, left)}"
        return f"{subject} only {percent(least)} probable {alone}; with all readings {text}"
    where, lower = f"without {_any_one(d)}", at_least(least)
    if least >= chance or lower.removeprefix("at least ") == text.removeprefix("at least "):
        return f"{subject} {text} probable, also {where}"
    return f"{subject} {lower} probable {where} (least without {_named(left)}); with all readings {text}"


def alone_words(d: DiagnosisData, *, further: bool = False) -> tuple[str, ...]:
    """A sentence on every named effect that only one sensor or run asks for, or that can show only there.

    ``further``: without the weakest of them, which `stated_words` has.
    """
    sentences = []
    stated = _weakest(d) if further else None
    for member, support in d.supports.items():
        weakest = support.weakest
        if stated is not None and stated[0] == member and stated[1].probability < ALONE:
            continue
        if support.only_at:
            sentences.append(f"{member.key} can show only {_where(support.only_at, d)}.")
        elif support.only and weakest is not None:
            sentences.append(
                f"Only {_named(weakest)} asks for {member.key}: without it the probability is "
                f"{percent(weakest.probability)}."
            )
    return tuple(sentences)


def support_words(d: DiagnosisData) -> tuple[str, ...]:
    """The weakest support of the named effects, then every effect that only one sensor or run asks for."""
    alone = alone_words(d)
    known = [left for support in d.supports.values() if (left := support.weakest) is not None]
    shared = [(left.probability, left) for left in known if left.probability >= ALONE]
    if not shared:
        return alone
    least, weakest = min(shared, key=lambda pair: pair[0])
    others = "The other effects stay" if alone and len(d.supports) > len(shared) else "They stay"
    subject = "It stays" if len(d.supports) == 1 else others
    without = f"without {_any_one(d)} (least without {_named(weakest)})"
    first = f"{subject} {at_least(least)} probable {without}."
    return (first, *alone)


def _weakest(d: DiagnosisData) -> tuple[Candidate, LeftOut] | None:
    """The named effect with the smallest probability without one sensor or run, and this one."""
    known = [(member, left) for member, each in d.supports.items() if (left := each.weakest) is not None]
    return min(known, key=lambda pair: pair[1].probability, default=None)


def _any_one(d: DiagnosisData) -> str:
    """What was left out in turn: with a single fitted run its sensors, with a single sensor the runs."""
    kinds = {left.kind for support in d.supports.values() for left in support.left_out}
    return f"any one {' or '.join(kind for kind in (SENSOR, RUN) if kind in kinds)}"


def _tells(member: Candidate, left: LeftOut) -> str:
    """What a sensor or run alone does for an effect: another run tells an effect in one run from that in all."""
    if member.runs and left.kind == RUN and left.name not in member.runs:
        return f"tells {member.key} from the same effect in all runs"
    return f"asks for {member.key}"


def _named(left: LeftOut) -> str:
    return run_words(left.name) if left.kind == RUN else left.name


def _where(place: str, d: DiagnosisData) -> str:
    runs = {run.run for run in d.gap.runs}
    return f"in {run_words(place)}" if place in runs else f"at {place}"
