"""Files of `tyrefem forces`: points, Magic Formula, `.tir` file, picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.mechanics.rolling.roll import against_the_lean_words
from tyrefem.output import atomic_folder, write_json
from tyrefem.tyre_forces.property_file import tir_text

if TYPE_CHECKING:
    from tyrefem.mechanics.rolling.force_table import TyreForces

#: Files that `write_files` may write.
FILES = ("forces.csv", "forces.json", "tyre.tir", "forces.png")
MOTIONS = {
    "linear": "motion linear about the inflated tyre",
    "large": "friction on the footprint in large motion",
}


def summary(forces: TyreForces) -> dict[str, Any]:
    """What was rolled and what was fitted, SI as the keys state, with versions."""
    from tyrefem.output import versions

    pressed, rolling = forces.wheel.pressed, forces.wheel.rolling
    return {
        "study": forces.study.name,
        "title": forces.study.title,
        "pressure_Pa": pressed.tyre.pressure,
        "friction": None if callable(rolling.friction) else rolling.friction,
        "drum_diameter_m": rolling.road.drum_diameter,
        "motion": pressed.footprint.motion,
        "magic_formula": forces.fit.summary(),
        "points": list(forces.rows),
        "versions": versions(),
        **plugin_summary(forces.study),
    }


def warnings(forces: TyreForces) -> tuple[str, ...]:
    """What a reader of the forces must know."""
    loads = ", ".join(f"{load:.0f}" for load in forces.against_the_lean)
    if not loads:
        return ()
    return (against_the_lean_words(loads, forces.wheel.pressed.footprint.motion),)


def write_files(forces: TyreForces, folder: Path, *, pictures: bool = True) -> None:
    """``forces.csv``, ``forces.json``, ``tyre.tir``, and with pictures ``forces.png``."""
    study = forces.study
    notes = (
        f"computed by tyrefem from the study {study.name}, not measured",
        f"pure slip; {MOTIONS[forces.wheel.pressed.footprint.motion]}, {_dynamics(forces)}",
        *warnings(forces),
    )
    with atomic_folder(folder) as place:
        forces.table.to_csv(place / "forces.csv", index=False, float_format="%.9g", na_rep="nan", lineterminator="\n")
        write_json(summary(forces), place / "forces.json")
        text = tir_text(forces.fit, forces.dimensions, study.title, notes)
        (place / "tyre.tir").write_text(text, encoding="utf-8")
        if pictures:
            from tyrefem.reports.figures.forces import forces_figure
            from tyrefem.reports.figures.style import png

            (place / "forces.png").write_bytes(png(forces_figure(forces)))


def _dynamics(forces: TyreForces) -> str:
    if not forces.wheel.pressed.tyre.angular_speed:
        return "without loss and inertia"
    return "with inertia and loss" if forces.wheel.rolling.points.lossy else "with inertia, without loss"
