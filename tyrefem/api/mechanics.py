"""The pressed tyre, its natural frequencies, its rolling with friction."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.mechanics.footprint import natural_frequencies as vibrations
from tyrefem.mechanics.footprint import press as presses
from tyrefem.mechanics.rolling import force_table as force_tables
from tyrefem.mechanics.rolling import roll as rolls
from tyrefem.mechanics.rolling import slip_curve as slip_curves

if TYPE_CHECKING:
    from tyrefem.reports.revolved_rolling import Temperature
    from tyrefem.wear.ring_wear import RingWear


class LoadedTyre(presses.Pressed):
    """A study's tyre, inflated and pressed on the road, with `save`."""

    def save(self, folder: str | Path, at: Iterable[str] = (), *, pictures: bool = True, vtk: bool = True) -> Path:
        """Write the files of `tyrefem press`: ``press.json``, tables, pictures, ``tyre.vtu``; return the folder.

        ``at``: places of the strain cycle, "287 mm, 80 mm" (r, z) or a region, which means its place of greatest loss;
        by default the belt's edge and the place of greatest loss.

        Raises
        ------
        InputError : a place is not in the section; the folder cannot be written.
        """
        from tyrefem.reports.press import write_files
        from tyrefem.reports.press_places import cycle_places

        write_files(self, Path(folder), cycle_places(self, at), self.curve(), pictures=pictures, vtk=vtk)
        return Path(folder)


class NaturalModes(vibrations.NaturalFrequencies):
    """Natural frequencies of a study's inflated tyre, with `save`."""

    def save(self, folder: str | Path, *, pictures: bool = True) -> Path:
        """Write ``modes.csv``, ``modes.json``, and with pictures ``modes.png``; return the folder.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.modes import write_files

        write_files(self, Path(folder), pictures=pictures)
        return Path(folder)


class RollingWheel(rolls.RolledStudy):
    """A study's tyre in steady rolling with friction, with `save`."""

    @cached_property
    def hysteresis(self) -> float:
        """Power of the strain cycle at the drive's initial temperature, W: the heat of a drive that rolls so."""
        from tyrefem.mechanics.rolling.rolled_loss import hysteresis

        return hysteresis(self)

    def wear(self) -> RingWear:
        """Wear of every ring of the tread, from its friction power; not compared with any measured tread.

        Raises
        ------
        InputError : no region ``tread``, or its card has no ``[wear]``.
        """
        from tyrefem.wear.ring_wear import ring_wear

        return ring_wear(self)

    def save(self, folder: str | Path, *, pictures: bool = True, vtk: bool = True) -> Path:
        """Write ``roll.json``, ``contact.csv``, ``rings.csv``, ``footprint-pressure.csv``, pictures, ``contact.vtu``,
        ``tyre.vtu``; return the folder.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.roll import write_files

        write_files(self, Path(folder), pictures=pictures, vtk=vtk)
        return Path(folder)

    def to_vtk(self, folder: str | Path, temperature: Temperature | None = None) -> Path:
        """Write the whole rolling tyre, ``tyre.vtu``, and its footprint, ``contact.vtu``; return the path of the first.

        ``temperature``: of the loss, degC: a number, or ``f(places)`` like `Result.temperature_field`; by default that
        of the study's regions, else the drive's initial one.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.roll import write_vtk

        return write_vtk(self, Path(folder), temperature)


class ForcesOverSlip(slip_curves.SlipCurve):
    """Forces of a study's tyre over slip angle or slip, with `save`."""

    def save(self, folder: str | Path, *, pictures: bool = True) -> Path:
        """Write ``roll.json``, ``curve.csv``, and with pictures ``curve.png``; return the folder.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.roll import write_curve

        write_curve(self, Path(folder), pictures=pictures)
        return Path(folder)


class ForceTable(force_tables.TyreForces):
    """Forces of a study's tyre over load, slip, slip angle and camber, with `save`."""

    def save(self, folder: str | Path, *, pictures: bool = True) -> Path:
        """Write ``forces.csv``, ``forces.json``, ``tyre.tir``, and with pictures ``forces.png``; return the folder.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.forces import write_files

        write_files(self, Path(folder), pictures=pictures)
        return Path(folder)
