"""The verdict "no gap" in words: noise, and corrections of what the study states as uncertain."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from tyrefem.diagnose.numbers import correction_subject, percent
from tyrefem.diagnose.words.corrections import corrected_words, corrections
from tyrefem.diagnose.words.rms import closed_clause, gap_clause, gap_words

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData

#: A gap is more than noise if its rms is so many times that of noise and discrepancy.
CLEAR_GAP = 1.5
#: Largest number of corrections in a first sentence.
CORRECTIONS = 3


def three_sentences(d: DiagnosisData) -> tuple[str, str, str]:
    """What is wrong, how sure that is, and what to do next."""
    chance = percent(d.judgement.best.probability)
    other = next((entry for entry in d.judgement.ranking[1:] if not entry.outside), None)
    against = "" if other is None else f" (next: {other.key}, {percent(other.probability)})"
    sure = f"That no effect is missing is {chance} probable{against}"
    if not deviates(d):
        wrong = f"Nothing is wrong beyond noise and what the study states as uncertain: {gap_clause(d)}."
        step = "Nothing needs to be done; smaller effects need better measurements (tyrefem isolability)."
        return wrong, f"{sure}.", step
    sure = f"{sure}; {closed_clause(d)}."
    shown = corrections(d)
    wrong = f"The study deviates ({gap_clause(d)}), but no effect is needed: corrections of stated numbers explain it"
    if not shown:
        return f"{wrong}.", sure, "Measure the uncertain numbers of the study more exactly, then diagnose again."
    items = "; ".join(each.words for each in shown[:CORRECTIONS])
    more = f"; and {len(shown) - CORRECTIONS} more" if len(shown) > CORRECTIONS else ""
    first = correction_subject(shown[0].pull.unknown)
    step = f"Measure what was corrected most ({first}), or go on with amended.toml, which has the corrections."
    return f"{wrong}. {items[0].upper()}{items[1:]}{more}.", sure, step


def paragraph(d: DiagnosisData) -> tuple[str, ...]:
    """What explains the deviation, and the corrections."""
    extent = f"rms {gap_words(d)}, noise {d.noise:.1f} K"
    first = f"Noise and the uncertainty of base numbers and sensors explain the deviation ({extent})."
    return (first, *corrected_words(d))


def deviates(d: DiagnosisData) -> bool:
    """Whether the original study deviates by more than noise and discrepancy, in the fitted or the held-out runs."""
    level = CLEAR_GAP * math.hypot(d.noise, d.original.card.diagnosis.discrepancy)
    return any(d.rms(after=False, held_out=held_out) > level for held_out in (False, True))
