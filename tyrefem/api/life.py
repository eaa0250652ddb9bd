"""How long a study's tyre lasts."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.fatigue import life as lives

if TYPE_CHECKING:
    from tyrefem.fatigue.places import FailurePlace
    from tyrefem.fatigue.sensitivity import LifeShift


class Life(lives.LifeData):
    """How long a study's tyre lasts, with `places`, `shifts`, `summary` and `save`."""

    @property
    def places(self) -> tuple[FailurePlace, ...]:
        """The ten places that fail first, the shortest life first."""
        from tyrefem.fatigue.places import first_places

        return first_places(self)

    @cached_property
    def shifts(self) -> tuple[LifeShift, ...]:
        """The shortest life with 10 % more speed, 10 % more load, 10 % less pressure, 10 K more ambient: a run each.

        If the tyre rolls with friction and slips, also with 10 % more slip.
        """
        from tyrefem.fatigue.sensitivity import shifts

        return shifts(self)

    def summary(self) -> dict[str, Any]:
        """Contents of `summary.json` without the shifts."""
        from tyrefem.reports.life import summary

        return summary(self)

    def save(self, folder: str | Path, *, sensitivity: bool = False, pictures: bool = True, vtk: bool = True) -> Path:
        """Write the files of `tyrefem life`: ``summary.json``, ``life.csv``, ``life.png``, ``life.vtu``; return the
        folder. ``sensitivity``: also the `shifts`, as ``sensitivity.csv``.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.life import write_files

        write_files(self, Path(folder), self.shifts if sensitivity else (), pictures=pictures, vtk=vtk)
        return Path(folder)
