"""Further looks at the same data: their folders, and their verdicts in sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, IDENTIFIED, NO_GAP

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData

#: Folder of a further look, within the folder of the look before it.
AGAIN = "again"


def look_folder(number: int) -> str:
    """Folder of the second, third... look, within the folder of the first."""
    return "/".join([AGAIN] * (number - 1))


def again_words(d: DiagnosisData) -> tuple[str, ...]:
    """One sentence for each further look at the same data."""
    sentences = []
    for number, diagnosis in enumerate(d.looks[1:], start=2):
        if diagnosis.verdict == NO_GAP:
            sentences.append("The amended study was diagnosed with the same data: no gap is left.")
            continue
        named = f": {diagnosis.judgement.best.key}" if diagnosis.verdict in (IDENTIFIED, CONFOUNDED) else ""
        sentences.append(
            f"The amended study was diagnosed with the same data: {diagnosis.verdict}{named}; see the folder "
            f"{look_folder(number)}."
        )
    return tuple(sentences)
