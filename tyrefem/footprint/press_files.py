"""The files of `tyrefem press`: numbers, tables, pictures and the whole tyre for ParaView."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.interruption import keeping
from tyrefem.output import atomic_folder, write_json

if TYPE_CHECKING:
    from tyrefem.footprint.cord_cycle import CordCycle
    from tyrefem.footprint.press import Pressed
    from tyrefem.footprint.press_places import CyclePlace

#: Angles of the tables of strain: 0.5 degrees apart.
ANGLES = np.linspace(-np.pi, np.pi, 721)
#: Files that `write_files` may write.
FILES = (
    "press.json", "load-deflection.csv", "strain-cycle.csv", "cord-tension.csv", "harmonics.csv", "tyre.vtu",
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
    """``press.json``, ``load-deflection.csv``, ``strain-cycle.csv``, ``cord-tension.csv``, ``harmonics.csv``; pictures
    of the same, of the section and of the contact pressure; ``tyre.vtu``.

    The tables are written before anything is drawn. Without cords there is no ``cord-tension``, and of a wheel that
    stands no ``harmonics``.

    Parameters
    ----------
    pressed : the tyre. folder : where to. places : of the strain cycle. curve : `Pressed.curve`.
    """
    from tyrefem.footprint.cord_cycle import cord_cycles
    from tyrefem.footprint.revolved import RevolvedTyre

    cords = cord_cycles(pressed.tyre, pressed.cycle)
    with atomic_folder(folder) as place:
        write_json(pressed.summary(), place / "press.json")
        for name, rows in _tables(pressed, places, curve, cords).items():
            (place / f"{name}.csv").write_text(_csv(rows), encoding="utf-8")
    with keeping(f"the tables are in {folder}, the pictures are not"), atomic_folder(folder) as place:
        if pictures:
            for name, picture in _pictures(pressed, places, curve, cords).items():
                (place / f"{name}.png").write_bytes(picture)
        if vtk:
            RevolvedTyre(pressed).write(place / "tyre.vtu")


def _tables(
    pressed: Pressed, places: Sequence[CyclePlace], curve: Any, cords: Sequence[CordCycle]
) -> dict[str, Iterable[Sequence[Any]]]:
    from tyrefem.footprint.cycle import COMPONENTS

    degrees = np.degrees(ANGLES)
    strains: list[Sequence[Any]] = [
        ["place", "region", "r_m", "z_m", "angle_deg", *(f"e_{name}" for name in COMPONENTS)]
    ]
    for one in places:
        history = pressed.cycle.strain(ANGLES, [one.element])[:, 0, one.point]
        strains += [[one.name, one.region, *one.place, *row] for row in np.column_stack([degrees, history.T])]
    found: dict[str, Iterable[Sequence[Any]]] = {
        "load-deflection": [["deflection_m", "load_N"], *curve],
        "strain-cycle": strains,
    }
    if cords:
        head = ["region", "unit", "r_m", "z_m", "angle_deg", "plus_angle", "minus_angle"]
        found["cord-tension"] = [head] + [
            [one.region, one.unit, *one.place, *row]
            for one in cords
            for row in np.column_stack([np.degrees(one.angles), one.plus, one.minus])
        ]
    if pressed.loss is not None:
        orders = np.arange(len(pressed.loss.by_harmonic))
        values = np.column_stack([orders, pressed.loss.stored_by_harmonic, pressed.loss.by_harmonic])[1:]
        found["harmonics"] = [["harmonic", "energy_J", "loss_per_revolution_J"], *values]
    return found


def _csv(rows: Iterable[Sequence[Any]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    for row in rows:
        writer.writerow([one if isinstance(one, str) else f"{one:.9g}" for one in row])
    return text.getvalue()


def _pictures(
    pressed: Pressed, places: Sequence[CyclePlace], curve: Any, cords: Sequence[CordCycle]
) -> dict[str, bytes]:
    from tyrefem.plotting.cord_tension import cord_tension_figure
    from tyrefem.plotting.footprint import (
        deformed_figure,
        harmonics_figure,
        pressure_map_figure,
        strain_history_figure,
    )
    from tyrefem.plotting.inflation import inflation_figure, load_deflection_figure
    from tyrefem.plotting.style import png

    elements = pressed.cycle.elements
    shown = {f"{one.name}, {one.region}": tuple(elements.points[:, one.element, one.point]) for one in places}
    found = {
        "section": inflation_figure(pressed.tyre, pressed.study.name),
        "section-loaded": deformed_figure(pressed.footprint),
        "pressure": pressure_map_figure(pressed.footprint),
        "load-deflection": load_deflection_figure(pressed, curve),
        "strain-cycle": strain_history_figure(pressed.cycle, shown),
    }
    if cords:
        found["cord-tension"] = cord_tension_figure(pressed.footprint, cords)
    if pressed.loss is not None:
        found["harmonics"] = harmonics_figure(pressed.loss)
    return {name: png(drawn) for name, drawn in found.items()}
