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

    def save(
        self,
        folder: str | Path,
        *,
        sensitivity: bool = False,
        pictures: bool = True,
        vtk: bool = True,
        force: bool = False,
    ) -> Path:
        """Write the files of `tyrefem life`: ``summary.json``, ``life.csv``, ``life.png``, ``life.vtu``,
        ``study.toml``; return the folder. ``sensitivity``: also the `shifts`, as ``sensitivity.csv``.

        ``force``: replace the user's files and the results of other commands.

        Raises
        ------
        InputError : the folder cannot be written; files in it are not of this command.
        """
        from tyrefem.api.saving import saving
        from tyrefem.inputs.origin import StudyOrigin
        from tyrefem.reports.life import FILES, write_files

        with saving(folder, "life", FILES, StudyOrigin(self.study), force=force) as place:
            write_files(self, place, self.shifts if sensitivity else (), pictures=pictures, vtk=vtk)
        return Path(folder)
