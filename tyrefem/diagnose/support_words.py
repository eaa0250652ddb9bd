"""How far one sensor or one run alone speaks for the named effects, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.diagnose.numbers import at_least, percent, run_words
from tyrefem.diagnose.support import ALONE, RUN, LeftOut

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData


def support_words(d: DiagnosisData) -> tuple[str, ...]:
    """The weakest support of the named effects, then every effect that only one sensor or run asks for."""
    alone, shared = [], []
    for member, support in d.supports.items():
        weakest = support.weakest
        if support.only_at:
            alone.append(f"{member.key} can show only {_where(support.only_at, d)}.")
        elif support.only and weakest is not None:
            alone.append(
                f"Only {_named(weakest)} asks for {member.key}: without it the probability is "
                f"{percent(weakest.probability)}."
            )
        if weakest is not None and weakest.probability >= ALONE:
            shared.append((weakest.probability, weakest))
    if not shared:
        return tuple(alone)
    least, weakest = min(shared, key=lambda pair: pair[0])
    others = "The other effects stay" if alone and len(d.supports) > len(shared) else "They stay"
    subject = "It stays" if len(d.supports) == 1 else others
    without = f"without any one sensor or run (least without {_named(weakest)})"
    first = f"{subject} {at_least(least)} probable {without}."
    return (first, *alone)


def _named(left: LeftOut) -> str:
    return run_words(left.name) if left.kind == RUN else left.name


def _where(place: str, d: DiagnosisData) -> str:
    runs = {run.name for run in d.gap.runs}
    return f"in {run_words(place)}" if place in runs else f"at {place}"
