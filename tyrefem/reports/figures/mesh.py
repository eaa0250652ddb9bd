"""Pictures of a section with regions, boundaries, reference line and main dimensions, and of a mesh."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.reports.figures.canvas import (
    Canvas,
    canvas,
    draw_outlines,
    halo,
    marks,
    region_labels,
    sensor_labels,
    sides,
)
from tyrefem.reports.figures.style import (
    FILLS,
    FONT,
    INK,
    QUIET,
    TITLE,
    Label,
    add_axes,
    figure,
    millimetres,
    plain,
    section_axes,
    short,
    title,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.geometry import Section
    from tyrefem.geometry.meshing import TyreMesh

#: Boundary -> colour; boundaries of other names have the colour of the text.
BOUNDARIES = {"road": "#D55E00", "outside_air": "#56B4E9", "rim": "#8C510A", "contained_air": "#009E73"}


def section_figure(section: Section, sensors: Mapping[str, tuple[float, float]] | None = None) -> Figure:
    """Draw the whole section with regions, boundaries and dimensions; ``sensors``: name -> (r, z), m."""
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
        label: str | None = plain(name.replace("_", " "))
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
    axes.plot(x, y, color=INK, lw=0.9, ls=(0, (8, 2, 1.5, 2)), zorder=5, label=plain(f"reference line ({reading})"))


def _thicknesses(section: Section) -> list[Label]:
    """Total thickness and outer radius at crown, shoulder, mid sidewall and bead."""
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


def mesh_figure(tyre_mesh: TyreMesh) -> Figure:
    """Draw every element of the mesh; a half section is not mirrored."""
    from matplotlib.collections import LineCollection, PolyCollection

    mesh = tyre_mesh.mesh
    points = np.stack(millimetres(mesh.p.T), axis=1)
    low, high = points.min(axis=0), points.max(axis=0)
    tall = 5.6 if tyre_mesh.section.half else 4.6
    scale = (high[1] - low[1]) / tall
    wide = (high[0] - low[0]) / scale
    legend = max(2.4, 0.075 * max(len(f"{region}: 1000 elements") for region in tyre_mesh.section.regions) + 0.5)
    drawn = figure(max(wide + 0.9 + legend, 7.4), tall + 0.3 + 0.5 + TITLE)
    axes = add_axes(drawn, 0.7, 0.5, wide + 0.2, tall + 0.3)
    axes.set_xlim(low[0] - 0.1 * scale, high[0] + 0.1 * scale)
    axes.set_ylim(low[1] - 0.15 * scale, high[1] + 0.15 * scale)
    # Thin edges on fine meshes, so that they do not cover the regions' colours.
    edge = float(np.clip(0.6 * np.sqrt(2000 / max(tyre_mesh.n_elements, 1)), 0.08, 0.6))
    for number, region in enumerate(tyre_mesh.section.regions):
        elements = np.asarray(mesh.subdomains[region])
        axes.add_collection(
            PolyCollection(
                points[mesh.t[:, elements].T], facecolors=FILLS[number % len(FILLS)], edgecolors="#404040", lw=edge,
                label=plain(f"{region}: {len(elements)} elements"),
            )
        )  # fmt: skip
    for name, facets in (mesh.boundaries or {}).items():
        ends = points[mesh.facets[:, np.asarray(facets)].T]
        color = BOUNDARIES.get(name, INK)
        axes.add_collection(
            LineCollection(ends, colors=color, lw=2.2, ls=":" if name == "symmetry" else "-",
                           label=plain(f"{name.replace('_', ' ')}: {ends.shape[0]} edges"))
        )  # fmt: skip
    section_axes(axes)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=FONT, frameon=False)
    quality = tyre_mesh.quality
    title(
        drawn, f"{tyre_mesh.section.name}: {tyre_mesh.mesher} mesh",
        f"{tyre_mesh.n_nodes} nodes, {tyre_mesh.n_elements} {tyre_mesh.cell}s of {tyre_mesh.size * 1e3:.3g} mm; "
        f"scaled Jacobian ≥ {quality['scaled_jacobian']:.2f}, edge ratio ≤ {quality['edge_ratio']:.1f}",
    )  # fmt: skip
    return drawn
