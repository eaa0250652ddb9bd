"""Pictures of the pressed tyre: pressure, sections, strain cycles, harmonics, cord tension, load over deflection."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.reports.figures.style import (
    ENERGY_MAP,
    FILLS,
    FONT,
    INK,
    PALETTE,
    QUIET,
    TITLE,
    add_axes,
    figure,
    legend,
    line_style,
    millimetres,
    plain,
    section_axes,
    short,
    si,
    tidy,
    title,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.mechanics.footprint.cord_cycle import CordCycle
    from tyrefem.mechanics.footprint.footprint import Footprint
    from tyrefem.mechanics.footprint.loss import RevolutionLoss
    from tyrefem.mechanics.footprint.press import Pressed
    from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
    from tyrefem.mechanics.solid.inflation import Inflation

Array = NDArray[np.float64]
LABELS = {"rr": "e_rr", "zz": "e_zz", "tt": "e_θθ", "rz": "γ_rz", "rt": "γ_rθ", "zt": "γ_zθ"}


def described(footprint: Footprint) -> str:
    """Load, deflection, pressure, road and number of harmonics as one line."""
    road = footprint.pressing.road
    drum = "flat road" if math.isinf(road.drum_diameter) else f"drum Ø {road.drum_diameter:.3g} m"
    camber = f", camber {math.degrees(road.camber):.3g}°" if road.camber else ""
    return (
        f"{footprint.load / 1e3:.3f} kN at {footprint.deflection * 1e3:.1f} mm, "
        f"{footprint.pressing.state.pressure / 1e3:.0f} kPa, "
        f"{drum}{camber}, {footprint.harmonics} harmonics"
    )


def pressure_map_figure(footprint: Footprint) -> Figure:
    """Draw the contact pressure over the whole footprint and along its two middle lines."""
    from matplotlib.ticker import MaxNLocator

    drawn = figure(10.4, 4.4 + TITLE)
    x, z, pressure = pressure_map(footprint)
    scale, unit = si(float(np.median(pressure[pressure > 0])) if pressure.any() else 0.0, "Pa")
    axes = add_axes(drawn, 0.75, 0.55, 4.3, 3.7)
    # Pressure peaks at the tread's edge: the colours span all but the highest 3 % of the contact.
    usual = float(np.quantile(pressure[pressure > 0], 0.97)) if pressure.any() else 1.0
    levels = np.linspace(0, usual / scale, 16)
    filled = axes.contourf(x * 1e3, z * 1e3, pressure / scale, levels=levels, cmap=ENERGY_MAP, extend="max")
    axes.contour(x * 1e3, z * 1e3, pressure / scale, levels=[1e-6 * levels[-1]], colors=INK, linewidths=0.8)
    axes.set_aspect("equal", adjustable="box")
    reach = 0.65e3 * footprint.length + 5
    axes.set_xlim(-reach, reach)
    axes.set_xlabel("along the road x [mm]", fontsize=FONT)
    axes.set_ylabel("across z [mm]", fontsize=FONT)
    tidy(axes, grid=False)
    # A tick above the highest level would be drawn at that level.
    ticks = [tick for tick in MaxNLocator(6).tick_values(0.0, levels[-1]) if tick <= levels[-1]]
    bar = drawn.colorbar(filled, cax=add_axes(drawn, 5.2, 0.75, 0.14, 3.3), ticks=ticks)
    bar.set_label(f"contact pressure [{unit}]", fontsize=FONT)
    bar.ax.tick_params(labelsize=FONT)
    middle, ahead = int(np.abs(z).argmin()), int(np.abs(x).argmin())
    along, across = add_axes(drawn, 6.85, 2.75, 3.3, 1.55), add_axes(drawn, 6.85, 0.55, 3.3, 1.55)
    near = np.abs(x) * 1e3 <= reach
    along.plot(x[near] * 1e3, pressure[middle, near] / scale, "o-", ms=2.5, lw=1.2, color=PALETTE[0])
    across.plot(z * 1e3, pressure[:, ahead] / scale, "o-", ms=2.5, lw=1.2, color=PALETTE[1])
    inflation = footprint.pressing.state.pressure
    for panel, name in (
        (along, "x [mm] at the middle of the tread"),
        (across, "z [mm] at the middle of the footprint"),
    ):
        if inflation:
            panel.axhline(inflation / scale, color=QUIET, lw=0.8, ls=(0, (5, 1.5)))
        panel.set_xlabel(name, fontsize=FONT)
        panel.set_ylabel(f"pressure [{unit}]", fontsize=FONT)
        panel.set_ylim(bottom=0)
        tidy(panel)
    title(
        drawn, "Contact pressure",
        f"{described(footprint)}: {footprint.length * 1e3:.0f} × {footprint.width * 1e3:.0f} mm, "
        f"{footprint.area * 1e4:.0f} cm², mean "
        f"{footprint.mean_pressure / 1e3:.0f} kPa; dashed: inflation",
    )  # fmt: skip
    return drawn


def pressure_map(footprint: Footprint) -> tuple[Array, Array, Array]:
    """x (a,), z (b,) in m and pressure (b, a) in Pa over the whole footprint, mirrored if only half was solved; zero
    in the tread's grooves."""
    angles, (r, z) = footprint.grid.angles, footprint.grid.tread.places
    x = np.concatenate([-angles[:0:-1], angles]) * float(r.mean())
    pressure = np.concatenate([footprint.pressure[:0:-1], footprint.pressure]).T
    if footprint.pressing.tread.half:
        keep = z > 1e-9
        z, pressure = np.concatenate([-z[keep][::-1], z]), np.vstack([pressure[keep][::-1], pressure])
    edge = 1e-6
    for low, high in footprint.grid.tread.grooves:
        for start, end in {(low, high), (-high, -low)} if footprint.pressing.tread.half else {(low, high)}:
            at = np.array([start + edge, end - edge])
            z, pressure = np.concatenate([z, at]), np.vstack([pressure, np.zeros((2, len(x)))])
    order = np.argsort(z, kind="stable")
    return x, z[order], pressure[order]


def strain_history_figure(cycle: StrainHarmonics, places: dict[str, tuple[float, float]], count: int = 361) -> Figure:
    """Draw the six strains round the wheel at named places (r, z) of the inflated tyre, m."""
    drawn = figure(10.4, 0.1 + 2.3 * len(places) + TITLE)
    angles = np.linspace(-np.pi, np.pi, count)
    height = float(drawn.get_size_inches()[1])
    for number, (name, (r, z)) in enumerate(places.items()):
        axes = add_axes(drawn, 0.8, height - TITLE - 2.3 * (number + 1) + 0.45, 8.2, 1.7)
        for k, (component, history) in enumerate(zip(LABELS.values(), cycle.at(r, z, angles), strict=True)):
            axes.plot(np.degrees(angles), 100 * history, lw=1.3, label=component, **line_style(k))
        axes.set_title(plain(name), fontsize=FONT, loc="left", color=INK)
        axes.set_ylabel("strain [%]", fontsize=FONT)
        axes.set_xlim(-180, 180)
        axes.set_xticks(range(-180, 181, 45))
        tidy(axes)
        if number == 0:
            axes.legend(fontsize=FONT, frameon=False, loc="upper left", bbox_to_anchor=(1.01, 1.05))
    axes.set_xlabel("angle from the middle of the footprint [°]", fontsize=FONT)
    title(drawn, "Strain round the wheel, beyond inflation", described(cycle.footprint))
    return drawn


def harmonics_figure(loss: RevolutionLoss) -> Figure:
    """Draw elastic energy and loss per revolution by harmonic, and a map of the loss."""
    drawn = figure(10.4, 4.2 + TITLE)
    cycle = loss.cycle
    n = np.arange(1, cycle.footprint.harmonics + 1)
    stored = loss.stored_by_harmonic[1:]
    left = add_axes(drawn, 0.8, 2.6, 3.9, 1.6), add_axes(drawn, 0.8, 0.55, 3.9, 1.6)
    panels = zip(left, ((stored, "energy"), (loss.by_harmonic[1:], "loss")), PALETTE, strict=False)
    for axes, (values, name), colour in panels:
        scale, unit = si(float(values.max()), "J")
        axes.bar(n, values / scale, color=colour, width=0.8)
        axes.set_ylabel(f"{name} [{unit}]", fontsize=FONT)
        axes.set_xlim(0, len(n) + 1)
        tidy(axes)
        share = axes.twinx()
        share.plot(n, 100 * np.cumsum(values) / (float(values.sum()) or 1.0), color=QUIET, lw=1.0)
        share.set_ylim(0, 105)
        share.set_ylabel("sum [%]", fontsize=FONT, color=QUIET)
        share.tick_params(labelsize=FONT, colors=QUIET)
        share.spines["top"].set_visible(False)
    left[1].set_xlabel("harmonic", fontsize=FONT)
    axes = add_axes(drawn, 6.2, 0.55, 3.1, 3.65)
    weights = cycle.elements.weights
    density = (loss.density * weights).sum(axis=1) / weights.sum(axis=1)
    scale, unit = si(float(density.max()), "J/m³")
    painted = _cells(axes, cycle.elements.mesh, density / scale)
    section_axes(axes)
    bar = drawn.colorbar(painted, cax=add_axes(drawn, 9.45, 0.75, 0.14, 3.2))
    bar.set_label(f"loss per revolution [{unit}]", fontsize=FONT)
    bar.ax.tick_params(labelsize=FONT)
    title(
        drawn,
        f"Energy and loss by harmonic: {loss.energy:.1f} J per revolution, {loss.rolling_resistance:.1f} N, "
        f"coefficient {loss.coefficient:.4f}",
        described(cycle.footprint),
    )  # fmt: skip
    return drawn


def deformed_figure(footprint: Footprint, angles: tuple[float, ...] = (0.0, 0.2, math.pi)) -> Figure:
    """Draw the section at angles from the middle of the footprint (coloured outlines) over the inflated one."""
    from matplotlib.collections import LineCollection

    elements = footprint.pressing.harmonics.elements
    mesh, n = elements.mesh, np.arange(footprint.harmonics + 1)
    u = footprint.amplitudes.reshape(len(n), -1, 3)
    vertices = elements.basis.nodal_dofs[0]
    outline = mesh.facets[:, mesh.boundary_facets()].T
    shapes = [elements.nodes[:, vertices]]
    for angle in angles:
        shapes.append(shapes[0] + np.tensordot(np.cos(n * angle), u[:, vertices, :2], axes=1).T)
    everything = np.concatenate(shapes, axis=1) * 1e3
    (low_r, low_z), (high_r, high_z) = everything.min(axis=1) - 3, everything.max(axis=1) + 3
    tall = 4.0 if footprint.pressing.tread.half else 3.2
    wide = (high_z - low_z) * tall / (high_r - low_r)
    drawn = figure(max(wide + 2.7, 6.4), tall + 0.65 + TITLE)
    axes = add_axes(drawn, 0.8, 0.6, wide, tall)
    for number, (r, z) in enumerate(shapes):
        style = {"color": QUIET, "ls": "-", "lw": 0.8} if number == 0 else line_style(number - 1) | {"lw": 1.4}
        name = "inflated" if number == 0 else f"at {math.degrees(angles[number - 1]):.0f}°"
        lines = np.stack([z[outline], r[outline]], axis=-1) * 1e3
        axes.add_collection(LineCollection(list(lines), label=name, **style))
    section_axes(axes)
    axes.set_xlim(low_z, high_z)
    axes.set_ylim(low_r, high_r)
    axes.legend(fontsize=FONT, frameon=False, loc="upper left", bbox_to_anchor=(1.02, 1.0))
    title(drawn, "Section before and under load", described(footprint))
    return drawn


def _cells(axes: Axes, mesh: Any, values: Array) -> Any:
    """Colour the elements by one value each."""
    from matplotlib.collections import PolyCollection

    corners = mesh.p[:, mesh.t].transpose(2, 1, 0)[..., ::-1] * 1e3
    painted = PolyCollection(list(corners), array=values, cmap=ENERGY_MAP, edgecolors="none")
    painted.set_clim(0, float(values.max()))
    axes.add_collection(painted)
    axes.autoscale_view()
    return painted


#: Height of a panel with its axis, inches.
PANEL = 1.95


def cord_tension_figure(footprint: Footprint, cords: Sequence[CordCycle]) -> Figure:
    """Draw a panel for each layer of cords: tension in both cord directions, and in the inflated tyre."""
    rows = (len(cords) + 1) // 2
    drawn = figure(10.4, 0.35 + PANEL * rows + TITLE)
    height = float(drawn.get_size_inches()[1])
    handles: dict[str, Any] = {}
    for number, layer in enumerate(cords):
        row, column = divmod(number, 2)
        axes = add_axes(drawn, 0.75 + 5.1 * column, height - TITLE - PANEL * (row + 1) + 0.35, 4.2, PANEL - 0.65)
        largest = float(np.abs(np.concatenate([layer.plus, layer.minus])).max())
        scale, unit = si(largest, layer.unit)
        degrees = np.degrees(layer.angles)
        crossed = not np.allclose(layer.plus, layer.minus, rtol=0, atol=1e-3 * largest)
        if crossed:
            axes.plot(degrees, layer.plus / scale, color=PALETTE[0], lw=1.4, label="+angle")
            axes.plot(degrees, layer.minus / scale, color=PALETTE[1], lw=1.2, ls=(0, (5, 1.5)), label="−angle")
        else:
            axes.plot(degrees, layer.plus / scale, color=PALETTE[2], lw=1.4, label="cords")
        axes.axhline(layer.inflated / scale, color=QUIET, lw=0.9, ls=(0, (1.2, 1.2)), label="inflated")
        axes.axhline(0.0, color=INK, lw=0.5)
        r, z = (1e3 * x for x in layer.place)
        what = "cord" if layer.unit == "N" else "layer"
        name = f"{short(layer.region, 32)} (r {r:.0f}, z {z:.0f} mm)"
        axes.set_title(name, fontsize=FONT, loc="left", color=INK)
        axes.set_ylabel(f"{what} [{unit}]", fontsize=FONT)
        axes.set_xlim(-180, 180)
        axes.set_xticks(range(-180, 181, 60))
        tidy(axes)
        handles |= {str(line.get_label()): line for line in axes.lines if not str(line.get_label()).startswith("_")}
        if number >= len(cords) - 2:
            axes.set_xlabel("angle from the middle of the footprint [°]", fontsize=FONT)
    legend(drawn, [handles[name] for name in ("+angle", "−angle", "cords", "inflated") if name in handles])
    title(drawn, "Cord tension round the wheel, at its maximum in each layer", described(footprint))
    return drawn


def inflation_figure(tyre: Inflation, name: str) -> Figure:
    """Draw the inflated section, its regions filled, over the undeformed outline; a half section is not mirrored."""
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
        label = plain(region)
        axes.add_collection(PolyCollection(list(cells), facecolors=colour, edgecolors="white", lw=0.3, label=label))
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
    """Draw load over deflection, (n, 2) in m and N, with the footprint's point and its tangent."""
    drawn = figure(6.4, 3.9 + TITLE)
    axes = add_axes(drawn, 0.8, 0.6, 5.3, 3.2)
    footprint = pressed.footprint
    deflection, load = curve.T
    if pressed.balanced:  # load steps have few harmonics and a wide tolerance: no line joins them with the footprint
        steps = "load steps, few harmonics: load up to a quarter too high"
        axes.plot(deflection[:-1] * 1e3, load[:-1] / 1e3, "o", ms=4, mfc="none", color=PALETTE[0], label=steps)
    else:
        axes.plot(deflection * 1e3, load / 1e3, "o-", ms=3, lw=1.4, color=PALETTE[0], label="load")
    ends = footprint.deflection + np.array([-0.3, 0.2]) * footprint.deflection
    tangent = footprint.load + footprint.stiffness * (ends - footprint.deflection)
    words = f"tangent {footprint.stiffness / 1e3:.0f} N/mm"
    axes.plot(ends * 1e3, tangent / 1e3, color=PALETTE[1], lw=1.2, ls=(0, (5, 1.5)), label=words)
    words = f"{footprint.load / 1e3:.3g} kN at {footprint.deflection * 1e3:.1f} mm"
    axes.plot(footprint.deflection * 1e3, footprint.load / 1e3, "s", color=PALETTE[1], ms=6, label=words)
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("deflection [mm]", fontsize=FONT)
    axes.set_ylabel("load [kN]", fontsize=FONT)
    tidy(axes)
    axes.legend(fontsize=FONT, frameon=False)
    title(
        drawn, f"{pressed.study.name}: load over deflection",
        f"{pressed.tyre.pressure / 1e3:.0f} kPa, {footprint.harmonics} harmonics; "
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
    edges = []
    for side, element in zip(*np.nonzero(on_boundary), strict=True):
        edges.append(cells[element, [2 * side, 2 * side + 1, (2 * side + 2) % 8]])
    return edges
