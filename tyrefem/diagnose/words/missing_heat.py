"""Missing heat as verdicts tell it: its largest place in a clause, all places with their law, heat or errors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from tyrefem.diagnose.beside.discrepancy import READINGS
from tyrefem.diagnose.heat.sources import STATED, UnknownSource
from tyrefem.diagnose.verdicts.verdict import PARTLY, UNEXPLAINED
from tyrefem.diagnose.words.effects import moves_clause
from tyrefem.diagnose.words.heat import course_words, heat_words, source_amount, source_place
from tyrefem.diagnose.words.law import law_words

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData


def heat_clause(d: DiagnosisData, sources: Sequence[UnknownSource]) -> str:
    """The largest clear source of missing heat, and how many more there are."""
    if not sources:
        return "no place of missing heat is clear"
    first = sources[0]
    sign = "heat is missing" if first.amount > 0 else "the model has too much heat, cooling is missing,"
    course = course_words(first)
    course = f"; {course[0].lower()}{course[1:]}" if first.kinds[first.kind] >= STATED else ""
    left = len(sources) - 1
    more = f"; and {left} more place{'s' if left > 1 else ''}" if left else ""
    return f"{sign} {source_place(d, first)}: {source_amount(first)}{moves_clause(first.move)}{course}{more}"


def missing_heat_words(d: DiagnosisData) -> tuple[str, ...]:
    """Heat of unknown origin and its law over the runs, in sentences; empty where the verdict leaves none."""
    if d.verdict == UNEXPLAINED and not (d.better_law is not None and d.better_law.alone):
        return (f"{heat_words(d)}.", *(f"{sentence}." for sentence in law_words(d)))
    return tuple(f"{sentence}." for sentence in law_words(d)) if d.verdict == PARTLY else ()


def heat_before_errors(d: DiagnosisData) -> bool:
    """Whether errors of the readings are the most probable model, and clear heat has a larger evidence than they."""
    robust, heat = d.robustness, d.missing.over_time
    if robust is None or heat is None or not heat.clear or robust.models[0].name != READINGS:
        return False
    return d.missing.log_evidence > robust.log_evidence + math.log(max(robust.models[0].probability, 1e-300))
