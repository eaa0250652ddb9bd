"""Files of `tyrefem press`: numbers, tables, pictures, and the whole pressed tyre as a VTK file for ParaView."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.interruption import keeping
from tyrefem.output import atomic_folder, write_json
from tyrefem.reports.pressure_map import pressed_map
from tyrefem.reports.revolved import RevolvedSection, wheel_angles

if TYPE_CHECKING:
    from tyrefem.mechanics.footprint.cord_cycle import CordCycle
    from tyrefem.mechanics.footprint.loss import RevolutionLoss
    from tyrefem.mechanics.footprint.press import Pressed
    from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
    from tyrefem.reports.press_places import CyclePlace

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class RevolvedTyre(RevolvedSection):
    """Points, cells and fields of the whole pressed tyre: x is axial, y up from the wheel's centre, z forward."""

    @cached_property
    def angles(self) -> Array:
        """(n,) from the middle of the footprint, rad."""
        grid = self.pressed.footprint.grid
        return wheel_angles(min(1.1 * float(grid.angles[-1]), np.pi))

    @property
    def motions(self) -> tuple[Array, ...]:
        """Amplitudes of the footprint, the same on both sides."""
        return (self.pressed.footprint.amplitudes,)

    @property
    def strains(self) -> tuple[StrainHarmonics, ...]:
        """The strain cycle, the same on both sides."""
        return (self.pressed.cycle,)

    @property
    def losses(self) -> tuple[RevolutionLoss, ...]:
        """The loss of the strain cycle; none if the wheel does not roll."""
        return () if self.pressed.loss is None else (self.pressed.loss,)

    def in_space(self, places: Array) -> Array:
        """(3, ...) places (x forward, y down, z along the axis) as (axial, up, forward): right-handed."""
        forward, down, axial = places
        return np.stack([axial, -down, forward])

    @cached_property
    def contact_pressure(self) -> Array:
        """(n_points,) contact pressure, Pa; zero outside the tread."""
        footprint, angles = self.pressed.footprint, np.abs(self.angles)
        grid = footprint.grid
        columns = {(int(node), 1): column for column, node in enumerate(grid.tread.nodes)}
        return self.on_tread(
            angles, grid.angles, footprint.pressure, columns | {(n, -1): c for (n, _), c in columns.items()}
        )

    @property
    def point_data(self) -> dict[str, Array]:
        """``contact_pressure_Pa``."""
        return {"contact_pressure_Pa": self.contact_pressure}


#: Angles of the tables of strain: 0.5 degrees apart.
ANGLES = np.linspace(-np.pi, np.pi, 721)


#: Files that `write_files` may write.
FILES = (
    "press.json", "footprint-pressure.csv", "load-deflection.csv", "strain-cycle.csv", "cord-tension.csv",
    "harmonics.csv", "tyre.vtu",
    *(f"{name}.png" for name in ("section", "section-loaded", "pressure", "load-deflection", "strain-cycle",
                                 "cord-tension", "harmonics")),
)  # fmt: skip


def write_files(
    pressed: Pressed,
    folder: Path,
    places: Sequence[CyclePlace],
    curve: Any,
    *,
    pictures: bool = True,
    vtk: bool = True,
) -> None:
    """``press.json``, ``footprint-pressure.csv``, ``load-deflection.csv``, ``strain-cycle.csv``, ``cord-tension.csv``,
    ``harmonics.csv``; pictures of these, of the section and of the contact pressure; ``tyre.vtu``.

    The tables are written before the pictures. Without cords there is no ``cord-tension``; without rolling there is
    no ``harmonics``.

    Parameters
    ----------
    pressed : the tyre. folder : folder of the files. places : places of the strain cycle. curve : `Pressed.curve`.
    """
    from tyrefem.mechanics.footprint.cord_cycle import cord_cycles

    cords = cord_cycles(pressed.tyre, pressed.cycle)
    with atomic_folder(folder) as place:
        write_json(pressed.summary(), place / "press.json")
        for name, rows in _tables(pressed, places, curve, cords).items():
            (place / f"{name}.csv").write_text(_csv(rows), encoding="utf-8")
    with keeping(f"{folder} has the tables, but not the pictures"), atomic_folder(folder) as place:
        if pictures:
            for name, picture in _pictures(pressed, places, curve, cords).items():
                (place / f"{name}.png").write_bytes(picture)
        if vtk:
            RevolvedTyre(pressed).write(place / "tyre.vtu")


def _tables(
    pressed: Pressed, places: Sequence[CyclePlace], curve: Any, cords: Sequence[CordCycle]
) -> dict[str, Iterable[Sequence[Any]]]:
    from tyrefem.mechanics.footprint.strain_harmonics import COMPONENTS

    degrees, harmonics = np.degrees(ANGLES), pressed.curve_harmonics(curve)
    strains: list[Sequence[Any]] = [
        ["place", "region", "r_m", "z_m", "angle_deg", *(f"e_{name}" for name in COMPONENTS)]
    ]
    for place in places:
        history = pressed.cycle.strain(ANGLES, [place.element])[:, 0, place.point]
        strains += [[place.name, place.region, *place.place, *row] for row in np.column_stack([degrees, history.T])]
    tables: dict[str, Iterable[Sequence[Any]]] = {
        "footprint-pressure": pressed_map(pressed.footprint).rows(),
        "load-deflection": [["deflection_m", "load_N", "harmonics"], *np.column_stack([curve, harmonics])],
        "strain-cycle": strains,
    }
    if cords:
        head = ["region", "unit", "r_m", "z_m", "angle_deg", "plus_angle", "minus_angle"]
        tables["cord-tension"] = [head] + [
            [place.region, place.unit, *place.place, *row]
            for place in cords
            for row in np.column_stack([np.degrees(place.angles), place.plus, place.minus])
        ]
    if pressed.loss is not None:
        orders = np.arange(len(pressed.loss.by_harmonic))
        values = np.column_stack([orders, pressed.loss.stored_by_harmonic, pressed.loss.by_harmonic])[1:]
        tables["harmonics"] = [["harmonic", "energy_J", "loss_per_revolution_J"], *values]
    return tables


def _csv(rows: Iterable[Sequence[Any]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    for row in rows:
        writer.writerow([cell if isinstance(cell, str) else f"{cell:.9g}" for cell in row])
    return text.getvalue()


def titled_places(pressed: Pressed, places: Sequence[CyclePlace]) -> dict[str, tuple[float, float]]:
    """Name, region and place before inflation, as in the table -> (r, z) in the inflated tyre, m."""
    titled = {}
    for place in places:
        r, z = pressed.cycle.elements.points[:, place.element, place.point]
        before = "r {:.0f}, z {:.0f} mm".format(*(1e3 * length for length in place.place))
        titled[f"{place.name}, {place.region} ({before})"] = (float(r), float(z))
    return titled


def _pictures(
    pressed: Pressed, places: Sequence[CyclePlace], curve: Any, cords: Sequence[CordCycle]
) -> dict[str, bytes]:
    from tyrefem.reports.figures.footprint import (
        cord_tension_figure,
        deformed_figure,
        harmonics_figure,
        inflation_figure,
        load_deflection_figure,
        pressure_map_figure,
        strain_history_figure,
    )
    from tyrefem.reports.figures.style import png

    figures = {
        "section": inflation_figure(pressed.tyre, pressed.study.name),
        "section-loaded": deformed_figure(pressed.footprint),
        "pressure": pressure_map_figure(pressed.footprint),
        "load-deflection": load_deflection_figure(pressed, curve),
        "strain-cycle": strain_history_figure(pressed.cycle, titled_places(pressed, places)),
    }
    if cords:
        figures["cord-tension"] = cord_tension_figure(pressed.footprint, cords)
    if pressed.loss is not None:
        figures["harmonics"] = harmonics_figure(pressed.loss)
    return {name: png(drawn) for name, drawn in figures.items()}
