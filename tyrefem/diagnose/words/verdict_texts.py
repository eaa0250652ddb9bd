"""The module of `tyrefem.diagnose.words.verdicts` that has the texts of a verdict."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, IDENTIFIED, NO_GAP, PARTLY, UNEXPLAINED
from tyrefem.diagnose.words.verdicts import confounded, identified, no_gap, partly_identified, unexplained

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData


class VerdictTexts(Protocol):
    """The texts of a verdict, functions of its module."""

    def three_sentences(self, d: DiagnosisData) -> tuple[str, str, str]:
        """What is wrong, how sure that is, and what to do next."""

    def paragraph(self, d: DiagnosisData) -> tuple[str, ...]:
        """The same in more sentences, the most important first."""


#: Verdict -> its texts.
VERDICT_TEXTS: Mapping[str, VerdictTexts] = {
    IDENTIFIED: identified,
    CONFOUNDED: confounded,
    NO_GAP: no_gap,
    PARTLY: partly_identified,
    UNEXPLAINED: unexplained,
}
