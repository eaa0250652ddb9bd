"""The pressed tyre, its natural frequencies, its rolling with friction."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.api.numbers import check_numbers
from tyrefem.api.verbs import with_verbs
from tyrefem.mechanics.footprint import natural_frequencies as vibrations
from tyrefem.mechanics.footprint import press as presses
from tyrefem.mechanics.rolling import force_table as force_tables
from tyrefem.mechanics.rolling import roll as rolls
from tyrefem.mechanics.rolling import slip_curve as slip_curves
from tyrefem.output import as_path

if TYPE_CHECKING:
    from tyrefem.api.wear import RollingWear
    from tyrefem.reports.revolved_rolling import Temperature


class LoadedTyre(presses.Pressed):
    """A study's tyre, inflated and pressed on the road, with `save`."""

    def save(
        self,
        folder: str | Path,
        at: Iterable[str] = (),
        *,
        pictures: bool = True,
        vtk: bool = True,
        force: bool = False,
    ) -> Path:
        """Write the files of `tyrefem press`: ``press.json``, tables, pictures, ``tyre.vtu``, ``study.toml``,
        ``summary.json``; return the folder.

        ``at``: places of the strain cycle, "287 mm, 80 mm" (r, z) or a region, which means its place of greatest loss;
        by default the belt's edge and the place of greatest loss. ``force``: replace the user's files and the results
        of other commands.

        Raises
        ------
        InputError : a place is not in the section; the folder cannot be written; files in it are not of this command.
        """
        from tyrefem.api.saving import saving
        from tyrefem.inputs.origin import StudyOrigin
        from tyrefem.reports.press import FILES, write_files
        from tyrefem.reports.press_places import cycle_places

        places = cycle_places(self, at)
        with saving(folder, "press", FILES, StudyOrigin(self.study), force=force) as place:
            write_files(self, place, places, self.curve(), pictures=pictures, vtk=vtk)
        return Path(folder)


class NaturalModes(vibrations.NaturalFrequencies):
    """Natural frequencies of a study's inflated tyre, with `save`."""

    def save(self, folder: str | Path, *, pictures: bool = True, force: bool = False) -> Path:
        """Write the files of `tyrefem modes`: ``modes.csv``, ``modes.json``, with pictures ``modes.png``; as
        `LoadedTyre.save`."""
        from tyrefem.api.saving import saving
        from tyrefem.inputs.origin import StudyOrigin
        from tyrefem.reports.modes import FILES, write_files

        with saving(folder, "modes", FILES, StudyOrigin(self.study), force=force) as place:
            write_files(self, place, pictures=pictures)
        return Path(folder)


class RollingWheel(rolls.RolledStudy):
    """A study's tyre in steady rolling with friction, with `save`."""

    @cached_property
    def hysteresis(self) -> float:
        """Power of the strain cycle at the drive's initial temperature, W: the heat of a drive that rolls so."""
        from tyrefem.mechanics.rolling.rolled_loss import hysteresis

        return hysteresis(self)

    def wear(self) -> RollingWear:
        """Wear of every ring of the tread, from its friction power; not compared with any measured tread.

        Raises
        ------
        InputError : no region ``tread``, or its card has no ``[wear]``.
        """
        from tyrefem.api.wear import RollingWear
        from tyrefem.wear.ring_wear import ring_wear

        return with_verbs(RollingWear, ring_wear(self), rolled=self)

    def save(self, folder: str | Path, *, pictures: bool = True, vtk: bool = True, force: bool = False) -> Path:
        """Write the files of `tyrefem roll`: ``roll.json``, ``contact.csv``, ``rings.csv``, ``footprint-pressure.csv``,
        pictures, ``contact.vtu``, ``tyre.vtu``; as `LoadedTyre.save`."""
        from tyrefem.api.saving import saving
        from tyrefem.inputs.origin import StudyOrigin
        from tyrefem.reports.roll import FILES, write_files

        with saving(folder, "roll", FILES, StudyOrigin(self.study), force=force) as place:
            write_files(self, place, pictures=pictures, vtk=vtk)
        return Path(folder)

    def to_vtk(self, folder: str | Path, temperature: Temperature | None = None) -> Path:
        """Write the whole rolling tyre, ``tyre.vtu``, and its footprint, ``contact.vtu``; return the path of the first.

        ``temperature``: of the loss, degC: a number, or ``f(places)`` like `Result.temperature_field`; by default that
        of the study's regions, else the drive's initial one.

        Raises
        ------
        InputError : no number; the folder cannot be written.
        """
        from tyrefem.reports.roll import write_vtk

        if not callable(temperature):
            check_numbers(temperature=temperature)
        return write_vtk(self, as_path(folder, "folder"), temperature)


class ForcesOverSlip(slip_curves.SlipCurve):
    """Forces of a study's tyre over slip angle or slip, with `save`."""

    def save(self, folder: str | Path, *, pictures: bool = True, force: bool = False) -> Path:
        """Write the files of `tyrefem roll` of several slips: ``roll.json``, ``curve.csv``, with pictures
        ``curve.png``; as `LoadedTyre.save`."""
        from tyrefem.api.saving import saving
        from tyrefem.inputs.origin import StudyOrigin
        from tyrefem.reports.roll import FILES, write_curve

        with saving(folder, "roll", FILES, StudyOrigin(self.study), force=force) as place:
            write_curve(self, place, pictures=pictures)
        return Path(folder)


class ForceTable(force_tables.TyreForces):
    """Forces of a study's tyre over load, slip, slip angle and camber, with `save`."""

    def save(self, folder: str | Path, *, pictures: bool = True, force: bool = False) -> Path:
        """Write the files of `tyrefem forces`: ``forces.csv``, ``forces.json``, ``tyre.tir``, with pictures
        ``forces.png``; as `LoadedTyre.save`."""
        from tyrefem.api.saving import saving
        from tyrefem.inputs.origin import StudyOrigin
        from tyrefem.reports.forces import FILES, write_files

        with saving(folder, "forces", FILES, StudyOrigin(self.study), force=force) as place:
            write_files(self, place, pictures=pictures)
        return Path(folder)
