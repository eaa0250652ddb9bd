"""Corrections of base numbers, films and sensors in words: how far they are from what was stated, what they move."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tyrefem.brief import Brief
from tyrefem.diagnose.fitting.materiality import Movement, largest_change
from tyrefem.diagnose.fitting.pulls import Pull, pulls
from tyrefem.diagnose.numbers import correction_words

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData


@dataclass(frozen=True)
class CorrectionMove(Brief):
    """A correction of a base number, film or sensor, and the largest change of a reading by it."""

    pull: Pull
    move: Movement

    def _title(self) -> str:
        return self.words

    @property
    def words(self) -> str:
        """The correction, its standard deviations of what was stated, and what it moves."""
        name = correction_words(self.pull.unknown, self.pull.x, self.pull.sd)
        return f"{name} ({self.pull.pull:+z.1f} sd of what was stated, {self.move.kelvin:+z.1f} K at the most)"


def corrections(d: DiagnosisData) -> tuple[CorrectionMove, ...]:
    """The corrections of the amended study, those that move a reading most first."""
    made = []
    for change in d.changes:
        if not change.missing:
            pull = Pull(change.unknown, change.x, change.sd, change.x / change.unknown.sd)
            made.append(CorrectionMove(pull, _moved(d, pull)))
    return tuple(sorted(made, key=lambda each: -abs(each.move.kelvin)))


def _moved(d: DiagnosisData, pull: Pull) -> Movement:
    """The largest change of a reading by a correction, by the sensitivities about x = 0."""
    column = d.gap.unknowns.index(pull.unknown)
    return largest_change(d.gap.sensitivities.drives, [J[:, column] * pull.x for J in d.gap.sensitivities.jacobians])


def corrected_words(d: DiagnosisData, most: int = 6) -> tuple[str, ...]:
    """The corrections that move a reading, and by how many prior standard deviations, largest first."""
    kept = {change.unknown for change in d.changes}
    shown = [pull for pull in pulls(d.best) if pull.unknown in kept]
    if not shown:
        return ()
    items = [f"{correction_words(each.unknown, each.x, each.sd)} ({each.pull:+z.1f} sd)" for each in shown[:most]]
    more = f"; and {len(shown) - most} more" if len(shown) > most else ""
    return (f"Corrected for it, in standard deviations of what was stated: {'; '.join(items)}{more}.",)
