"""Files of `tyrefem roll`: numbers, maps over the footprint, curves over slip."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.interruption import keeping
from tyrefem.mechanics.rolling.rolled_loss import hysteresis
from tyrefem.output import atomic_folder, write_json
from tyrefem.reports.pressure_map import rolled_map
from tyrefem.reports.vtu import VtuFile

if TYPE_CHECKING:
    from tyrefem.mechanics.rolling.roll import RolledStudy
    from tyrefem.mechanics.rolling.slip_curve import SlipCurve
    from tyrefem.reports.revolved_rolling import Temperature

Array = NDArray[Any]
#: Files that `write_files` and `write_curve` may write.
FILES = ("roll.json", "footprint-pressure.csv", "contact.csv", "rings.csv", "contact.vtu", "tyre.vtu", "contact.png",
         "rings.png", "curve.csv", "curve.png")  # fmt: skip


def contact_table(rolled: RolledStudy) -> Any:
    """pandas DataFrame: a row per point of the tread near the footprint, SI as the columns state; 0 open, 1 sticks,
    2 slips."""
    import pandas as pd

    state = rolled.state
    across = len(state.grid.influence.places[0])
    x, y, _ = state.places
    traction, sliding = state.traction.reshape(-1, 2), state.sliding_velocity.reshape(-1, 2)
    return pd.DataFrame({
        "angle_deg": np.degrees(np.repeat(state.grid.angles, across)),
        "ring_z_m": np.tile(state.grid.influence.places[1], len(state.grid.angles)),
        "x_m": x, "y_m": y,
        "pressure_Pa": state.pressure.ravel(),
        "traction_x_Pa": traction[:, 0], "traction_y_Pa": traction[:, 1],
        "sliding_x_m_s": sliding[:, 0], "sliding_y_m_s": sliding[:, 1],
        "state": state.states.ravel(),
        "friction_power_W": state.power_map.ravel(),
    })  # fmt: skip


def rings_table(rolled: RolledStudy) -> Any:
    """pandas DataFrame: place, width, m, and friction power, W, of each ring of the tread."""
    import pandas as pd

    influence = rolled.state.grid.influence
    r, z = influence.places
    columns = {"r_m": r, "z_m": z, "width_m": influence.lengths, "friction_power_W": rolled.state.power_by_ring}
    return pd.DataFrame(columns)


def summary(rolled: RolledStudy) -> dict[str, Any]:
    """Contents of ``roll.json``: `RolledStudy.summary`, and the hysteresis of the strain cycle."""
    return {**rolled.summary(), "hysteresis_power_W": hysteresis(rolled)}


def write_contact(rolled: RolledStudy, path: Path) -> Path:
    """Write the tread near the footprint as a .vtu surface: x forward, y left, z up from the contact centre, m.

    Point data: ``pressure_Pa``, ``traction_Pa``, ``sliding_m_s``, ``state`` (0 open, 1 sticks, 2 slips),
    ``friction_power_W``.

    Raises
    ------
    InputError : the file cannot be written.
    """
    state = rolled.state
    angles, across = state.pressure.shape
    number = np.arange(angles * across).reshape(angles, across)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)

    def flat(vectors: Array) -> Array:
        return np.column_stack([vectors.reshape(-1, 2), np.zeros(angles * across)])

    return VtuFile(state.places.T, quads, "quad").write(
        path,
        {
            "pressure_Pa": state.pressure.ravel(),
            "traction_Pa": flat(state.traction),
            "sliding_m_s": flat(state.sliding_velocity),
            "state": state.states.ravel().astype(np.int32),
            "friction_power_W": state.power_map.ravel(),
        },
    )


def write_files(rolled: RolledStudy, folder: Path, *, pictures: bool = True, vtk: bool = True) -> None:
    """``roll.json``, ``footprint-pressure.csv``, ``contact.csv``, ``rings.csv``, pictures of both,
    ``contact.vtu``, ``tyre.vtu``."""
    with atomic_folder(folder) as place:
        write_json(summary(rolled), place / "roll.json")
        _csv(contact_table(rolled), place / "contact.csv")
        _csv(rings_table(rolled), place / "rings.csv")
        heading, *rows = rolled_map(rolled.state).rows()
        with (place / "footprint-pressure.csv").open("w", encoding="utf-8", newline="") as stream:
            csv.writer(stream, lineterminator="\n").writerows([heading, *rows])
    if pictures:
        from tyrefem.reports.figures.rolling import contact_figure, rings_figure
        from tyrefem.reports.figures.style import png

        with keeping(f"{folder} has the tables, but not the pictures"), atomic_folder(folder) as place:
            (place / "contact.png").write_bytes(png(contact_figure(rolled)))
            (place / "rings.png").write_bytes(png(rings_figure(rolled)))
    if vtk:
        with keeping(f"{folder} has the tables, but not the VTK files"):
            write_vtk(rolled, folder)


def write_vtk(rolled: RolledStudy, folder: Path, temperature: Temperature | None = None) -> Path:
    """Write ``contact.vtu`` and the whole rolling tyre, ``tyre.vtu``; return the path of the latter.

    ``temperature``: of the loss, as `RevolvedRolling` has it.

    Raises
    ------
    InputError : a file cannot be written.
    """
    from tyrefem.reports.revolved_rolling import RevolvedRolling

    with atomic_folder(folder) as place:
        write_contact(rolled, place / "contact.vtu")
        RevolvedRolling.of(rolled, temperature).write(place / "tyre.vtu")
    return folder / "tyre.vtu"


def write_curve(curve: SlipCurve, folder: Path, *, pictures: bool = True) -> None:
    """``roll.json``, ``curve.csv``, ``curve.png``."""
    with atomic_folder(folder) as place:
        write_json(curve.summary(), place / "roll.json")
        _csv(curve.table, place / "curve.csv")
        if pictures:
            from tyrefem.reports.figures.rolling import slip_curve_figure
            from tyrefem.reports.figures.style import png

            (place / "curve.png").write_bytes(png(slip_curve_figure(curve)))


def _csv(table: Any, path: Path) -> None:
    table.to_csv(path, index=False, float_format="%.9g", na_rep="nan", lineterminator="\n")
