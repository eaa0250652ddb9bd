"""Pictures of rolling with friction: maps over the footprint, friction power over the tread, forces over slip."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.reports.figures.style import (
    ENERGY_MAP,
    FONT,
    PALETTE,
    QUIET,
    TITLE,
    add_axes,
    figure,
    tidy,
    title,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.mechanics.rolling.roll import RolledStudy
    from tyrefem.mechanics.rolling.slip_curve import SlipCurve

Array = NDArray[np.float64]
#: Colour of slipping points.
SLIP_COLOUR = PALETTE[1]
#: Road drawn beyond the contact, mm.
MARGIN = 12.0


def described(rolled: RolledStudy) -> str:
    """Motion of the wheel in words."""
    state = rolled.state
    words = [
        f"slip angle {math.degrees(state.motion.slip_angle):.3g}°",
        f"slip {100 * rolled.slip:.3g} %",
        f"camber {math.degrees(rolled.wheel.rolling.camber):.3g}°",
    ]
    if state.motion.turn_slip:
        words.append(f"path curvature {state.motion.turn_slip:.3g} 1/m")
    return f"{state.force[2]:.0f} N, " + ", ".join(words)


def contact_figure(rolled: RolledStudy) -> Figure:
    """Draw pressure, traction with its direction, and sliding speed with the slipping points, over the footprint."""
    from matplotlib.tri import Triangulation

    state = rolled.state
    drawn = figure(13.2, 4.0 + TITLE)
    shape = state.pressure.shape
    x, y = (1e3 * row.reshape(shape) for row in state.places[:2])
    touching = state.states > 0
    triangles = _triangles(*shape)
    apart = np.append(_over_grooves(rolled), False)
    # A triangle between two rings is counted by its lower ring.
    lower = (triangles % shape[1]).min(axis=1)
    drawn_over = Triangulation(x.ravel(), y.ravel(), triangles)
    drawn_over.set_mask(~touching.ravel()[triangles].any(axis=1) | apart[lower])
    size = np.linalg.norm(state.traction, axis=-1) / 1e3
    panels = (
        ("contact pressure [kPa]", state.pressure / 1e3),
        ("traction of the road on the tread [kPa]", size),
        ("sliding speed [m/s]", state.sliding_speed),
    )
    for number, (label, values) in enumerate(panels):
        axes = add_axes(drawn, 0.7 + 4.35 * number, 0.55, 2.7, 3.3)
        highest = float(np.quantile(values[touching], 0.98)) if touching.any() else 1.0
        filled = axes.tripcolor(
            drawn_over, values.ravel(), shading="gouraud", cmap=ENERGY_MAP, vmin=0.0, vmax=max(highest, 1e-9)
        )
        if number == 1:
            _arrows(axes, x[touching], y[touching], state.traction[touching] / 1e3)
        if number == 2:
            slides = state.states == 2
            axes.plot(x[slides], y[slides], ".", ms=2.0, color=SLIP_COLOUR)
        axes.set_xlim(x[touching].min() - MARGIN, x[touching].max() + MARGIN)
        axes.set_ylim(y[touching].min() - MARGIN, y[touching].max() + MARGIN)
        axes.set_aspect("equal", adjustable="box")
        axes.set_xlabel("forward x [mm]", fontsize=FONT)
        axes.set_ylabel("left y [mm]", fontsize=FONT)
        tidy(axes, grid=False)
        above = "max" if float(values[touching].max(initial=0.0)) > highest else "neither"
        bar = drawn.colorbar(filled, cax=add_axes(drawn, 3.5 + 4.35 * number, 0.7, 0.1, 3.0), extend=above)
        bar.set_label(label, fontsize=FONT)
        bar.ax.tick_params(labelsize=FONT)
    title(drawn, f"{rolled.study.name}: footprint", f"{described(rolled)}; dots: points that slip")
    return drawn


def _triangles(angles: int, across: int) -> NDArray[np.int64]:
    """(n, 3) points of two triangles in each cell of the grid of angles and rings."""
    number = np.arange(angles * across).reshape(angles, across)
    a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def _over_grooves(rolled: RolledStudy) -> NDArray[np.bool_]:
    """(m - 1,) True where a groove of the tread lies between a point and the next to its left."""
    influence = rolled.state.grid.influence
    z, grooves = influence.places[1], influence.tread.grooves
    middle = (z[1:] + z[:-1]) / 2
    middle = np.abs(middle) if influence.tread.half else middle
    return np.asarray(((middle[:, None] > grooves[:, 0]) & (middle[:, None] < grooves[:, 1])).any(axis=1))


def _arrows(axes: Axes, x: Array, y: Array, traction: Array) -> None:
    axes.quiver(x, y, traction[:, 0], traction[:, 1], color="white", width=0.004, angles="xy")


def rings_figure(rolled: RolledStudy) -> Figure:
    """Draw the friction power of each ring of the tread over its width, W/m."""
    state = rolled.state
    drawn = figure(6.4, 3.6 + TITLE)
    axes = add_axes(drawn, 0.8, 0.6, 5.3, 2.9)
    influence = state.grid.influence
    axes.plot(1e3 * influence.places[1], state.power_by_ring / influence.lengths, "o-", ms=3, lw=1.3, color=PALETTE[1])
    axes.set_xlabel("left z [mm]", fontsize=FONT)
    axes.set_ylabel("friction power per width [W/m]", fontsize=FONT)
    axes.set_ylim(bottom=0)
    tidy(axes)
    title(drawn, f"{rolled.study.name}: {state.friction_power:.4g} W of friction", described(rolled))
    return drawn


def slip_curve_figure(curve: SlipCurve) -> Figure:
    """Draw forces and aligning moment over slip angle or slip."""
    drawn = figure(9.6, 3.6 + TITLE)
    table = curve.table
    angle = curve.varied == "slip_angle"
    along = np.degrees(table["slip_angle_rad"]) if angle else 100 * table["slip"]
    name = "slip angle [deg]" if angle else "slip [%]"
    forces, moment = add_axes(drawn, 0.8, 0.6, 3.7, 2.9), add_axes(drawn, 5.6, 0.6, 3.7, 2.9)
    forces.plot(along, table["F_y_N"] / 1e3, "o-", ms=3, lw=1.3, color=PALETTE[0], label="F_y, to the left")
    forces.plot(along, table["F_x_N"] / 1e3, "s-", ms=3, lw=1.3, color=PALETTE[1], label="F_x, forward")
    forces.set_ylabel("force [kN]", fontsize=FONT)
    forces.legend(fontsize=FONT, frameon=False)
    moment.plot(along, table["M_z_Nm"], "o-", ms=3, lw=1.3, color=PALETTE[2])
    moment.set_ylabel("aligning moment M_z [N m]", fontsize=FONT)
    for axes in (forces, moment):
        axes.axhline(0.0, color=QUIET, lw=0.6)
        axes.set_xlabel(name, fontsize=FONT)
        tidy(axes)
    stiffness = curve.stiffness
    title(
        drawn, f"{curve.study.name}: forces of the road on the tyre",
        f"cornering stiffness {stiffness.cornering / 1e3:.4g} kN/rad, slip stiffness {stiffness.slip / 1e3:.4g} kN, "
        f"trail {stiffness.trail * 1e3:.3g} mm",
    )  # fmt: skip
    return drawn
