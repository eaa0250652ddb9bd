"""The diagnosis in three sentences: what is wrong, how sure, what to do next."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.compare.omitted import ERROR
from tyrefem.diagnose.verdicts.verdict import NO_GAP
from tyrefem.diagnose.words.rms import closed_clause
from tyrefem.diagnose.words.strain_laws import law_in_short, law_sure
from tyrefem.diagnose.words.verdict_texts import VERDICT_TEXTS
from tyrefem.diagnose.words.verdicts.no_gap import deviates

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData

#: What each sentence answers.
QUESTIONS = ("What is wrong", "How sure", "What to do next")


def headline(d: DiagnosisData) -> tuple[str, str, str]:
    """What is wrong, how sure that is, and what to do next: a sentence each, for every verdict."""
    wrong, sure, next_step = _after_law(d, VERDICT_TEXTS[d.verdict].three_sentences(d))
    errors = [f"{note}." for note in dict.fromkeys(d.notes) if note.startswith(ERROR)]
    if errors:
        times = "Check the unit of the times, and the drive; then diagnose again. "
        return " ".join((*errors, wrong)), sure, f"{times}Else: {next_step[0].lower()}{next_step[1:]}"
    return wrong, sure, next_step


def _after_law(d: DiagnosisData, sentences: tuple[str, str, str]) -> tuple[str, str, str]:
    """The three sentences of a verdict, after another strain law if the data prefer it."""
    if d.better_law is None:
        return sentences
    wrong, sure, next_step = sentences
    if d.better_law.alone:
        closed = closed_clause(d)
        wrong, sure = "With it no effect is missing.", f"{closed[0].upper()}{closed[1:]}."
        next_step = (
            f"Go on with amended.toml, which has the strain law {d.better_law.trial.law}; compare strain laws, section "
            "and cards where the heat differs (tyrefem strain STUDY)."
        )
    return f"{law_in_short(d)} {wrong}", f"{law_sure(d.better_law)}. {sure}", next_step


def label(d: DiagnosisData) -> str:
    """The verdict as people read it: "no gap after corrections" if the original study deviates clearly."""
    return f"{NO_GAP} after corrections" if d.verdict == NO_GAP and deviates(d) else d.verdict
