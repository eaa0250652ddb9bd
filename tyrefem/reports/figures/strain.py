"""Picture of a strain cycle: the section without and under the load, and strains and energy along the meridian."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.reports.figures.style import (
    FONT,
    INK,
    PALETTE,
    QUIET,
    TITLE,
    add_axes,
    figure,
    section_axes,
    si,
    tidy,
    title,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.geometry import Section
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.arcs import Arcs

Array = NDArray[np.float64]
SURFACES = {"inner surface": (PALETTE[0], "-"), "carcass midline": (PALETTE[1], (0, (5, 1.5))),
            "outer surface": (PALETTE[2], (0, (6, 1.5, 1.2, 1.5)))}  # fmt: skip


def strain_figure(study: StudyData) -> Figure:
    """Draw arcs without and under load, and hoop strain, meridional strain and U along the meridian.

    The load case is that of the drive's largest deflection. If it does not flatten the whole crown, the arcs are drawn
    at the deflection that does, and the strains are scaled down.
    """
    from tyrefem.simulation.rolling_tyre import RollingTyre

    return cycle_figure(study, RollingTyre(study).schedule)


def cycle_figure(study: StudyData, schedule: Any) -> Figure:
    """Draw the picture of `strain_figure` from load cases already solved."""
    number, cycle = max(
        ((n, cycle) for n, cycles in enumerate(schedule.cycles) for cycle in cycles),
        key=lambda pair: float(pair[1].case.deflection),
    )
    drawn = figure(11.6, 4.9 + 0.5 + TITLE)
    _arcs(add_axes(drawn, 0.7, 0.5, 4.4, 4.75), cycle)
    _along(drawn, cycle)
    case = cycle.case
    phase = f" (phase {schedule.drive.phases[number].name})" if len(schedule.drive.phases) > 1 else ""
    road = "flat road" if math.isinf(case.drum_diameter) else f"drum Ø {case.drum_diameter:.3g} m"
    title(
        drawn, f"{study.title}{phase}",
        f"{case.load / 1e3:.4g} kN at {case.pressure / 1e3:.4g} kPa: deflection {case.deflection * 1e3:.1f} mm, "
        f"footprint {case.footprint_length * 1e3:.0f} mm = {100 * case.road_fraction:.1f} % of a revolution, {road}",
    )  # fmt: skip
    return drawn


def _arcs(axes: Axes, cycle: Arcs) -> None:
    line = cycle.section.line
    fraction = np.linspace(0.0, 1.0, 100)
    s = np.linspace(0.0, line.shoulder_s, 50)
    crown = line.position(s)
    before_r, before_z = cycle.inflated.place(fraction, np.zeros(100))
    r = np.concatenate([crown[:, 0], before_r]) * 1e3
    z = np.concatenate([crown[:, 1], before_z]) * 1e3
    lines: list[tuple[str, str, Any, Array, Array]] = [("inflated", QUIET, (0, (5, 2)), z, r)]
    deflection = max(cycle.case.deflection, cycle.full_flattening)
    loaded = cycle.case.deflection > 0
    if loaded:
        after_r, after_z = cycle.deflected.place(fraction, np.zeros(100))
        flat = line.crown_midline_radius - deflection
        words = "under the load" if cycle.case.deflection >= deflection else "at full flattening"
        r_f = np.concatenate([[flat, flat], after_r]) * 1e3
        z_f = np.concatenate([[0.0, line.shoulder_s], after_z]) * 1e3
        lines.append((f"{words} (crown flat)", INK, "-", z_f, r_f))
    for label, color, dashes, x, y in lines:
        axes.plot(
            np.concatenate([-x[::-1], x]), np.concatenate([y[::-1], y]), color=color, ls=dashes, lw=1.8, label=label
        )
    _zone_marks(axes, cycle)
    if loaded:
        top = line.crown_midline_radius * 1e3
        arrow = {"arrowstyle": "<->", "lw": 0.9, "color": INK, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (0, top), (0, top - deflection * 1e3), arrowprops=arrow)
        axes.annotate(
            f"D = {deflection * 1e3:.1f} mm", (0, top - deflection * 500), xytext=(6, 0), textcoords="offset points",
            va="center", fontsize=FONT,
        )  # fmt: skip
    section_axes(axes)
    axes.set_adjustable("datalim")
    axes.legend(loc="lower center", fontsize=FONT, frameon=False)


def _zone_marks(axes: Axes, cycle: Arcs) -> None:
    """Draw short strokes across the reference line at the ends of zones."""
    line = cycle.section.line
    for s in (line.shoulder_s,):
        for sign in (1.0, -1.0):
            place, normal = line.position(s), line.normal(s)
            ends = np.stack([place - 0.006 * normal, place + 0.006 * normal]) * 1e3
            axes.plot(sign * ends[:, 1], ends[:, 0], color=QUIET, lw=1.2)
        place = (line.position(s) + 0.010 * line.normal(s)) * 1e3
        axes.text(place[1], place[0], "shoulder", fontsize=FONT - 1, color=QUIET, ha="left", va="center")


def zone_at(section: Section, zones: Any, s: Array, depth: Array) -> list[str | None]:
    """The zone at each (s, depth); None outside all zones."""
    regions = section.region_at(s, depth)
    return [
        next((zone.name for zone in zones if zone.region == region and zone.start <= abs(at) < zone.end), None)
        for region, at in zip(regions, s, strict=True)
    ]


def along(cycle: Arcs, surface: str, count: int = 240) -> tuple[Array, Array, Array, Array]:
    """(s, hoop strain, meridional strain, U, J/m3) along the meridian at a named surface; NaN without a strain law."""
    section = cycle.section
    s = np.linspace(0.0, section.line.length, count)
    total = section.total_thickness(s)
    depths = {
        "inner surface": 1e-3 * total, "outer surface": (1 - 1e-3) * total,
        "carcass midline": section.carcass_offset(s) - section.interfaces(s)[0],
    }  # fmt: skip
    depth = depths[surface]
    points = section.place(s, depth).T
    hoop, meridional, energy = (np.full(count, np.nan) for _ in range(3))
    zones = np.array(zone_at(section, cycle.zones, s, depth), dtype=object)
    for zone in {name for name in zones if name is not None}:
        here = zones == zone
        energy[here] = cycle.energy_density(zone, points[:, here])
        if zone != "V" and cycle.case.deflection > 0:
            strains = cycle.strains(zone, points[:, here])
            hoop[here], meridional[here] = strains.hoop, strains.meridional
    return s, hoop, meridional, energy


def _along(drawn: Figure, cycle: Arcs) -> None:
    section = cycle.section
    curves = {surface: along(cycle, surface) for surface in SURFACES}
    largest = max(float(np.nanmax(curve[3], initial=0.0)) for curve in curves.values())
    factor, unit = si(largest, "J/m³")
    rows: tuple[tuple[int, str, float], ...] = (
        (1, "hoop strain [%]", 100.0),
        (2, "meridional strain [%]", 100.0),
        (3, f"U per cycle [{unit}]", 1 / factor),
    )
    shoulder, length = section.line.shoulder_s * 1e3, section.line.length * 1e3
    for row, (which, label, scale) in enumerate(rows):
        axes = add_axes(drawn, 6.1, 0.5 + (2 - row) * 1.62, 5.25, 1.42)
        for surface, (color, dashes) in SURFACES.items():
            s = curves[surface][0] * 1e3
            values = np.array(curves[surface][which] * scale)
            # The strain law has a step at the shoulder: no line is drawn across it.
            jump = np.searchsorted(s, shoulder)
            axes.plot(
                np.insert(s, jump, shoulder),
                np.insert(values, jump, np.nan),
                color=color,
                ls=dashes,
                lw=1.5,
                label=surface,
            )
        axes.axvline(shoulder, color=QUIET, lw=0.8, ls=":")
        axes.axhline(0.0, color=INK, lw=0.7)
        axes.set_xlim(0.0, length)
        axes.set_ylabel(label, fontsize=FONT)
        axes.yaxis.set_label_coords(-0.085, 0.5)
        tidy(axes)
        if row == 0:
            axes.margins(y=0.25)
            for x, words in ((shoulder / 2, "crown: I, II"), ((shoulder + length) / 2, "sidewall: III, IV, bead V")):
                axes.text(x, 1.02, words, transform=axes.get_xaxis_transform(), ha="center", fontsize=FONT, color=QUIET)
        if row == 2:
            axes.legend(fontsize=FONT - 1, frameon=False, loc="upper right", handlelength=2.8)
        if row < 2:
            axes.tick_params(labelbottom=False)
        else:
            axes.set_xlabel("distance s along the meridian from the crown [mm]", fontsize=FONT)
