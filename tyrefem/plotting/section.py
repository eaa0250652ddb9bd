"""A section as drawn: regions, boundaries, reference line and the dimensions a person checks first."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.plotting.canvas import Canvas, canvas, draw_outlines, halo, marks, region_labels, sensor_labels, sides
from tyrefem.plotting.labels import Label
from tyrefem.plotting.style import FILLS, FONT, INK, QUIET, millimetres, short, title

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.section import Section

#: Boundary -> colour; a boundary of another name takes the ink's.
BOUNDARIES = {"road": "#D55E00", "outside_air": "#56B4E9", "rim": "#8C510A", "contained_air": "#009E73"}


def section_figure(section: Section, sensors: Mapping[str, tuple[float, float]] | None = None) -> Figure:
    """The whole tyre's section with its regions, boundaries and dimensions; ``sensors``: name -> (r, z), m."""
    places = dict(sensors or {})
    inside, left, right = sensor_labels(section, places, {name: short(name) for name in places})
    names = region_labels(section)
    thicknesses = _thicknesses(section)
    beside = [*thicknesses, *right]
    drawn = canvas(
        section, [label.text for label in [*names, *left]], [label.text for label in beside], bars=0, below=0.7
    )
    axes = drawn.axes
    for number, region in enumerate(section.regions):
        for polygon in section.outline(region, 1e-3):
            x, y = millimetres(polygon)
            for sign in sides(section):
                axes.fill(sign * x, y, color=FILLS[number % len(FILLS)], lw=0, zorder=1)
    draw_outlines(axes, section, color=QUIET, width=0.6)
    _boundaries(axes, section)
    _line(axes, section)
    marks(axes, [*inside, *left, *right])
    drawn.inside(inside)
    drawn.beside(sorted(beside, key=lambda label: -label.y), 1.0)
    drawn.beside(sorted([*names, *left], key=lambda label: -label.y), -1.0)
    _dimensions(drawn)
    axes.legend(loc="lower center", ncols=5, fontsize=FONT - 0.5, frameon=False, handlelength=1.6, columnspacing=1.4)
    title(
        drawn.figure, section.name,
        f"outer diameter {section.outer_diameter * 1e3:.1f} mm, overall width {section.overall_width * 1e3:.1f} mm, "
        f"meridian {section.line.length * 1e3:.1f} mm from crown to bead, air volume {_litres(section):.2f} l",
    )  # fmt: skip
    return drawn.figure


def _litres(section: Section) -> float:
    return section.as_full().gas_volume() * 1e3


def _boundaries(axes: Axes, section: Section) -> None:
    for name in section.boundaries:
        if name == "symmetry":
            continue
        label: str | None = name.replace("_", " ")
        for line in section.boundary_line(name, 1e-3):
            x, y = millimetres(line)
            for sign in sides(section):
                axes.plot(sign * x, y, color=BOUNDARIES.get(name, INK), lw=2.2, zorder=4, label=label)
                label = None


def _line(axes: Axes, section: Section) -> None:
    s = np.linspace(-section.line.length, section.line.length, 241)
    x, y = millimetres(section.as_full().line.position(s))
    reading = (
        section.reference if section.reference in ("inner", "outer", "total") else f"middle of {section.reference}"
    )
    axes.plot(x, y, color=INK, lw=0.9, ls=(0, (8, 2, 1.5, 2)), zorder=5, label=f"reference line ({reading})")


def _thicknesses(section: Section) -> list[Label]:
    """Whole thickness at the crown, the shoulder, mid sidewall and the bead, and the radius of the outer face."""
    line = section.line
    stations = {
        "crown": 0.0, "shoulder": line.shoulder_s, "mid sidewall": (line.shoulder_s + line.length) / 2,
        "bead": line.length,
    }  # fmt: skip
    labels = []
    for name, s in stations.items():
        thickness = float(section.total_thickness(s))
        x, y = millimetres(section.place(s, thickness))
        labels.append(Label(f"{name}: {thickness * 1e3:.1f} mm thick, r {y:.1f}", float(x), float(y)))
    return labels


def _dimensions(drawn: Canvas) -> None:
    axes, section = drawn.axes, drawn.section
    for label in _thicknesses(section):
        s, depth = (float(np.ravel(v)[0]) for v in section.locate(np.array([[label.y / 1e3, label.x / 1e3]])))
        x, y = millimetres(section.place([s, s], [0.0, depth]))
        axes.plot(x, y, color=INK, lw=1.0, marker="o", ms=2.5, zorder=6)
    half, below = drawn.width / 2, drawn.low - 0.2 * drawn.scale
    arrow = {"arrowstyle": "<->", "lw": 0.8, "color": INK, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (-half, below), (half, below), arrowprops=arrow, zorder=6)
    axes.text(0, below, f"{2 * half:.1f} mm", ha="center", va="center", fontsize=FONT, zorder=7, path_effects=halo(6))
    radius = _widest(section)
    for sign in (1.0, -1.0):
        axes.plot([sign * half] * 2, [radius, below], color=QUIET, lw=0.5, zorder=0)


def _widest(section: Section) -> float:
    """Radius of the widest point of the outer face, mm."""
    s = np.linspace(0.0, section.line.length, 400)
    x, y = millimetres(section.place(s, section.total_thickness(s)))
    return float(y[int(np.argmax(x))])
