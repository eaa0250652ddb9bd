"""The verdict "identified" in words: the effects that explain the deviation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.diagnose.numbers import percent
from tyrefem.diagnose.verdicts.verdict import NO_GAP
from tyrefem.diagnose.words.effects import effect_amounts, effect_clause, effect_words, joined
from tyrefem.diagnose.words.looks import look_folder
from tyrefem.diagnose.words.rms import closed_clause, closing_sentence
from tyrefem.diagnose.words.support import alone_words, stated_words, support_words

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData


def three_sentences(d: DiagnosisData) -> tuple[str, str, str]:
    """What is wrong, how sure that is, and what to do next."""
    wrong = joined([effect_clause(d, member) for member in d.best.members])
    chance = d.judgement.probability
    sure = f"{stated_words(d, d.best.members, chance, percent(chance))}, among all that was tried; {closed_clause(d)}."
    sure = " ".join((sure, *alone_words(d, further=True)))
    amounts = [clause for member in d.best.members for clause in effect_amounts(member, d.best)]
    what = "the values" if len(amounts) > 1 else "the value" if amounts else "this"
    step = f"Check that you believe {what}, then go on with amended.toml"
    if d.again is not None and d.again.verdict != NO_GAP:
        return wrong, sure, f"{step}; a second look at it says: {d.again.verdict} (folder {look_folder(2)})."
    return wrong, sure, f"{step}{'' if d.again is None else ', in which no gap is left'}."


def paragraph(d: DiagnosisData) -> tuple[str, ...]:
    """The effects with their amounts, how sure they are, and what the amended study makes of the deviation."""
    effects = joined([effect_words(d, member) for member in d.best.members])
    sure = f"Probability {percent(d.judgement.probability)}."
    return " ".join((effects, sure, *support_words(d))), closing_sentence(d)
