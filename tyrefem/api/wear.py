"""Wear of a study's tread in one state of rolling, and over its drive."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.api.numbers import check_numbers
from tyrefem.output import as_path
from tyrefem.wear.drive_wear import DriveWear
from tyrefem.wear.ring_wear import RingWear

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.rolling.roll import RolledStudy


@dataclass(frozen=True, eq=False, repr=False)
class RollingWear(RingWear):
    """Wear of a tread in one state of rolling, ``rolled``, with `save`."""

    rolled: RolledStudy = field(kw_only=True)

    def save(
        self, folder: str | Path, distance: float | None = None, *, pictures: bool = True, force: bool = False
    ) -> Path:
        """Write the files of `tyrefem wear`: ``wear.csv``, ``summary.json``, ``study.toml``, with pictures
        ``wear.png``; return the folder. ``distance``, m: also the worn section, ``worn-section.toml``.

        ``force``: replace the user's files and the results of other commands.

        Raises
        ------
        InputError : a tread that is worn through; the folder cannot be written; files in it are not of this command.
        """
        return _save(
            self.rolled.study, self.rolled, self, as_path(folder, "folder"), distance, pictures=pictures, force=force
        )


@dataclass(frozen=True, eq=False, repr=False)
class WearOverDrive(DriveWear):
    """Wear of a tread over the drive of its ``study``, with `save`."""

    study: StudyData = field(kw_only=True)

    def save(
        self, folder: str | Path, distance: float | None = None, *, pictures: bool = True, force: bool = False
    ) -> Path:
        """Write the files of `tyrefem wear`, as `RollingWear.save`."""
        return _save(self.study, None, self, as_path(folder, "folder"), distance, pictures=pictures, force=force)


def _save(
    study: StudyData,
    rolled: RolledStudy | None,
    wear: RingWear,
    folder: Path,
    distance: float | None,
    *,
    pictures: bool,
    force: bool,
) -> Path:
    from tyrefem.api.saving import saving
    from tyrefem.inputs.origin import StudyOrigin
    from tyrefem.reports.wear import FILES, write_files
    from tyrefem.wear.worn_section import worn_section

    check_numbers(distance=distance)
    worn = None if distance is None else worn_section(study, wear, distance / 1e3)
    with saving(folder, "wear", FILES, StudyOrigin(study), force=force) as place:
        write_files(study, rolled, wear, place, worn, pictures=pictures)
    return folder
