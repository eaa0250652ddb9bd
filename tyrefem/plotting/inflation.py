"""The inflated section over the undeformed one, and the load over the deflection."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.plotting.style import (
    FILLS,
    FONT,
    INK,
    PALETTE,
    QUIET,
    TITLE,
    add_axes,
    figure,
    millimetres,
    section_axes,
    tidy,
    title,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.footprint.press import Pressed
    from tyrefem.solid.inflation import Inflation

Array = NDArray[np.float64]


def inflation_figure(tyre: Inflation, name: str) -> Figure:
    """The inflated section, its regions filled, over the outline of the undeformed one; as modelled, not mirrored."""
    from matplotlib.collections import LineCollection, PolyCollection

    body = tyre.body
    mesh, free, moved = body.mesh, _curves(body.rings.nodes, tyre), _curves(tyre.places, tyre)
    points = np.concatenate([free.reshape(-1, 2), moved.reshape(-1, 2)])
    low, high = points.min(axis=0), points.max(axis=0)
    tall = 5.2
    wide = max((high[0] - low[0]) * tall / (high[1] - low[1]), 2.0)
    drawn = figure(max(wide + 3.4, 6.4), tall + 0.7 + TITLE)
    axes = add_axes(drawn, 0.7, 0.55, wide, tall)
    margin = 0.02 * (high[1] - low[1])
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    for number, region in enumerate(body.parts):
        cells = moved[np.asarray(mesh.subdomains[region])]
        colour = FILLS[number % len(FILLS)]
        axes.add_collection(PolyCollection(list(cells), facecolors=colour, edgecolors="white", lw=0.3, label=region))
    edges = ((moved, INK, "-", f"inflated, {tyre.pressure / 1e3:.0f} kPa"), (free, QUIET, (0, (4, 1.5)), "undeformed"))
    for shape, colour, dashes, label in edges:
        axes.add_collection(LineCollection(_outline(mesh, shape), colors=colour, lw=1.1, ls=dashes, label=label))
    section_axes(axes)
    axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0), fontsize=FONT, frameon=False)
    title(
        drawn, f"{name}: inflated",
        f"radius {tyre.radius_growth * 1e3:+.1f} mm, width {tyre.width_growth * 1e3:+.1f} mm; true to scale",
    )  # fmt: skip
    return drawn


def load_deflection_figure(pressed: Pressed, curve: Array) -> Figure:
    """Load over deflection, (n, 2) in m and N, with the footprint's own point and its tangent."""
    drawn = figure(6.4, 3.9 + TITLE)
    axes = add_axes(drawn, 0.8, 0.6, 5.3, 3.2)
    found = pressed.footprint
    deflection, load = curve.T
    axes.plot(deflection * 1e3, load / 1e3, "o-", ms=3, lw=1.4, color=PALETTE[0], label="load")
    ends = found.deflection + np.array([-0.3, 0.2]) * found.deflection
    tangent = found.load + found.stiffness * (ends - found.deflection)
    words = f"tangent {found.stiffness / 1e3:.0f} N/mm"
    axes.plot(ends * 1e3, tangent / 1e3, color=PALETTE[1], lw=1.2, ls=(0, (5, 1.5)), label=words)
    words = f"{found.load / 1e3:.3g} kN at {found.deflection * 1e3:.1f} mm"
    axes.plot(found.deflection * 1e3, found.load / 1e3, "s", color=PALETTE[1], ms=6, label=words)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("deflection [mm]", fontsize=FONT)
    axes.set_ylabel("load [kN]", fontsize=FONT)
    tidy(axes)
    axes.legend(fontsize=FONT, frameon=False)
    title(
        drawn, f"{pressed.study.name}: load over deflection",
        f"{pressed.tyre.pressure / 1e3:.0f} kPa, {found.harmonics} harmonics; "
        f"secant {pressed.secant_stiffness / 1e3:.0f} N/mm",
    )  # fmt: skip
    return drawn


def _curves(places: Array, tyre: Inflation) -> Array:
    """(n_elements, 8, 2) corners and edge middles of the nine-node elements in turn, (z, r) in mm."""
    nodes = tyre.body.rings.element_nodes
    x, y = millimetres(places[:, nodes[:, [0, 4, 1, 5, 2, 6, 3, 7]]].transpose(1, 2, 0))
    return np.stack([x, y], axis=-1)


def _outline(mesh: Any, cells: Array) -> list[Array]:
    """Edges of the body's boundary, three points each."""
    on_boundary = np.isin(mesh.t2f, mesh.boundary_facets())
    found = []
    for side, element in zip(*np.nonzero(on_boundary), strict=True):
        found.append(cells[element, [2 * side, 2 * side + 1, (2 * side + 2) % 8]])
    return found
