"""Files of a tread's wear: rings, summary, picture, and the worn section."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.inputs.origin import StudyOrigin
from tyrefem.output import atomic_folder, write_json
from tyrefem.quantity import written
from tyrefem.reports.figures.style import FONT, add_axes, figure, line_style, png, tidy, title
from tyrefem.wear.drive_wear import DriveWear
from tyrefem.wear.worn_section import WornProfile

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.rolling.roll import RolledStudy
    from tyrefem.wear.ring_wear import RingWear

#: Files of `write_files`, besides ``summary.json``.
FILES = ("wear.csv", "wear.png", "worn-section.toml")
#: What is said of every wear.
ABOUT = "wear at the first profile, not compared with any measured tread"
#: mm per 1000 km in m per km.
MILLIMETRES = 1e-6
#: Negative friction power over the positive that is mentioned: its rings count as not worn.
NEGATIVE = 0.01


def write_files(
    study: StudyData,
    rolled: RolledStudy | None,
    wear: RingWear,
    folder: Path,
    worn: dict[str, Any] | None = None,
    *,
    pictures: bool = True,
) -> None:
    """``wear.csv``, ``summary.json``; ``wear.png``; ``worn-section.toml`` if there is a worn section.

    ``rolled``: the one state of rolling; None: ``wear`` is that of the study's drive.
    """
    import tomli_w

    section = study.section
    with atomic_folder(folder) as temporary:
        rings_table(wear).to_csv(temporary / "wear.csv", index=False, float_format="%.8g", lineterminator="\n")
        write_json(summary(study, rolled, wear), temporary / "summary.json")
        if worn is not None:
            (temporary / "worn-section.toml").write_text(tomli_w.dumps(written(worn)), encoding="utf-8")
        if pictures:
            (temporary / "wear.png").write_bytes(png(wear_figure(wear, WornProfile.of(section, wear), study.title)))


def rings_table(wear: RingWear) -> Any:
    """pandas DataFrame: a row per ring, SI and mm per 1000 km as the columns state."""
    import pandas as pd

    return pd.DataFrame(
        {
            "r_m": wear.places[0],
            "z_m": wear.places[1],
            "width_m": wear.widths,
            "friction_power_W": wear.power,
            "energy_J_m2": wear.energy,
            "wear_mm_per_1000_km": wear.depth_per_km / MILLIMETRES,
        }
    )


def summary(study: StudyData, rolled: RolledStudy | None, wear: RingWear) -> dict[str, Any]:
    """Contents of ``summary.json``."""
    density = study.materials["tread"].density.at(study.card.drive.initial)
    return StudyOrigin(study).summary() | {
        "about": ABOUT,
        **(_drive(wear) if rolled is None else _state(rolled)),
        "mean_wear_mm_per_1000_km": wear.mean / MILLIMETRES,
        "most_wear_mm_per_1000_km": float(wear.depth_per_km.max()) / MILLIMETRES,
        "mass_mg_per_km": wear.volume_per_km * density * 1e6,
        "card": wear.table.model_dump(),
    }


def _state(rolled: RolledStudy) -> dict[str, Any]:
    state = rolled.state
    return {
        "slip_angle_rad": state.motion.slip_angle,
        "slip": rolled.slip,
        "camber_rad": rolled.wheel.rolling.camber,
        "force_N": state.force,
        "friction_power_W": state.friction_power,
    }


def _drive(wear: RingWear) -> dict[str, Any]:
    assert isinstance(wear, DriveWear)
    return {
        "friction_power_W": float(wear.power.sum()),
        "distance_m": wear.distance,
        "phases": [
            {"name": name, "distance_m": way, "friction_work_J": work, "mean_wear_mm_per_1000_km": depth / MILLIMETRES}
            for name, (way, work, depth) in wear.by_phase.items()
        ],
    }


def wear_figure(wear: RingWear, profile: WornProfile, heading: str) -> Figure:
    """Wear of every ring over the axial position, and the profile that the worn section takes."""
    drawn = figure(7.6, 3.6)
    axes = add_axes(drawn, 0.75, 0.5, 6.6, 2.4)
    axes.plot(wear.places[1] * 1e3, wear.depth_per_km / MILLIMETRES, "o", ms=3, color=line_style(0)["color"])
    r_z = profile.s * 1e3
    for sign in (1.0, -1.0):
        axes.plot(sign * r_z, profile.depth / MILLIMETRES, **line_style(1))
    axes.set_xlabel("axial position z of a ring; line: along the meridian, both sides averaged [mm]", fontsize=FONT)
    axes.set_ylabel("wear [mm per 1000 km]", fontsize=FONT)
    axes.set_ylim(0, None)
    tidy(axes)
    title(drawn, heading, f"mean {wear.mean / MILLIMETRES:.3g} mm per 1000 km; not compared with a measured tread")
    return drawn


def words(study: StudyData, rolled: RolledStudy | None, wear: RingWear) -> str:
    """The wear as text."""
    numbers = summary(study, rolled, wear)
    worst = int(np.argmax(wear.depth_per_km))
    if rolled is None:
        lines = [
            f"  {phase['name']}: {phase['distance_m'] / 1e3:.4g} km, friction {phase['friction_work_J'] / 1e3:.4g} kJ, "
            f"{phase['mean_wear_mm_per_1000_km']:.3g} mm per 1000 km"
            for phase in numbers["phases"]
        ]
    else:
        state = rolled.state
        lines = [
            f"  slip angle {np.degrees(state.motion.slip_angle):.3g} deg, slip {100 * rolled.slip:.3g} %: forces "
            f"{state.force[0]:.0f}, {state.force[1]:.0f}, {state.force[2]:.0f} N; friction "
            f"{state.friction_power:.1f} W"
        ]
    return "\n".join(
        [
            study.title,
            *lines,
            f"  wear {numbers['mean_wear_mm_per_1000_km']:.3g} mm per 1000 km on average, "
            f"{numbers['most_wear_mm_per_1000_km']:.3g} at z = {wear.places[1, worst] * 1e3:.0f} mm; "
            f"{numbers['mass_mg_per_km']:.3g} mg/km",
            *unresolved(wear),
            f"  {ABOUT}",
        ]
    )


def unresolved(wear: RingWear) -> list[str]:
    """A line where the mesh does not resolve the slip of the rings."""
    rings, power = wear.negative
    if -power <= NEGATIVE * float(wear.power[wear.power > 0].sum()):
        return []
    return [
        f"  friction power of {rings} of {len(wear.power)} rings is negative, {power:.3g} W in all: these count as not "
        "worn, and the mean is too high; mesh.size is too coarse for single rings"
    ]
