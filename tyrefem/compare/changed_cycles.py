"""Changed strain cycles of a comparison by finite elements: each is solved once, for all processes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tyrefem.compare.packed_drive import Work, same_tyre, solve_cycles
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.cycle_schedule import CycleSchedule, same_cycles

#: Drive and changed input; None: no input is changed.
Key = tuple[str, str | None]
#: Number of drives of one pressure whose cycles with the same change are one piece of work: they share the inflated
#: tyre and its factors. More would keep other processes waiting at the end.
TOGETHER = 2


@dataclass(eq=False)
class ChangedCycles:
    """The changed strain cycles of the runs of a comparison.

    Parameters
    ----------
    studies : (drive, input) -> study. folder : of what processes share.
    each : the results of a function for pieces of work, in their order; other processes may begin at once.
    """

    studies: Mapping[Key, StudyData]
    folder: Path
    each: Callable[[Callable[[Any], Any], Iterable[Any]], Iterator[Any]]
    #: Runs whose cycles are solved.
    solved: set[Key] = field(default_factory=set)
    #: Drive -> load cases, and the first drive of the same tyre; only drives with costly cycles.
    _cases: dict[str, str] = field(default_factory=dict, init=False, repr=False)
    _tyre_of: dict[str, str] = field(default_factory=dict, init=False, repr=False)
    #: Pieces of work that have begun, with their results; the cycles in them.
    _begun: list[tuple[list[list[Key]], Iterator[Any]]] = field(default_factory=list, init=False, repr=False)
    _taken: set[tuple[str, str | None, str]] = field(default_factory=set, init=False, repr=False)

    def folder_of(self, drive: str, cycles: CycleSchedule) -> str:
        """The folder of a drive's changed cycles: that of the first drive of the same tyre. ``cycles``: unchanged."""
        study = self.studies[drive, None]
        alike = (other for other in self._tyre_of if same_tyre(study, self.studies[other, None]))
        first = self._tyre_of[drive] = next(alike, drive)
        self._cases[drive] = repr(cycles.cases)
        folder = self.folder / f"changed-{list(self._tyre_of).index(first)}"
        folder.mkdir(exist_ok=True)
        return str(folder)

    def same_inflation(self, drive: str, other: str) -> bool:
        """Whether two drives have one tyre at the same pressures."""
        study, with_other = self.studies[drive, None], self.studies[other, None]
        return _pressures(study) == _pressures(with_other) and same_tyre(study, with_other)

    def begin(self, keys: Iterable[Key], work: Callable[[Key], Work]) -> None:
        """Have the changed cycles of runs solved that have not begun: drives with the same load cases share them."""
        groups: dict[tuple[str, str | None, str], list[Key]] = {}
        for drive, name in keys:
            if drive not in self._cases or same_cycles(self.studies[drive, name], self.studies[drive, None]):
                continue
            cycle = (self._tyre_of[drive], name, self._cases[drive])
            if cycle not in self._taken:
                self._taken.add(cycle)
                pressures = repr(_pressures(self.studies[drive, None]))
                groups.setdefault((self._tyre_of[drive], name, pressures), []).append((drive, name))
        pieces = [
            group[first : first + TOGETHER] for group in groups.values() for first in range(0, len(group), TOGETHER)
        ]
        if pieces:
            self._begun.append((pieces, self.each(solve_cycles, [[work(key) for key in piece] for piece in pieces])))

    def finish(self) -> Iterator[None]:
        """Wait for what has begun, piece by piece."""
        while self._begun:
            pieces, results = self._begun.pop(0)
            for piece, _ in zip(pieces, results, strict=True):
                self.solved.update(piece)
                yield


def _pressures(study: StudyData) -> list[Any]:
    return [phase.pressure for phase in study.card.drive.phases]
