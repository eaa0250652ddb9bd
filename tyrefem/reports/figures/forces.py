"""Picture of a tyre's forces over slip and slip angle at several loads, with the Magic Formula that fits them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.reports.figures.style import FONT, PALETTE, QUIET, TITLE, add_axes, figure, tidy, title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.mechanics.rolling.force_table import TyreForces

#: Points of a drawn curve.
POINTS = 161


def forces_figure(forces: TyreForces) -> Figure:
    """Draw F_x over slip, F_y and M_z over slip angle without camber: points computed, lines fitted."""
    drawn = figure(13.2, 4.0 + TITLE)
    table, fit = forces.table, forces.fit
    formula = fit.formula
    upright = table[table["camber_rad"] == 0.0]
    panels: tuple[tuple[str, str, str, str, float, Any, float], ...] = (
        ("longitudinal", "F_x_N", "slip", "slip [%]", 100.0, formula.longitudinal_force, 1e-3),
        ("lateral", "F_y_N", "slip_angle_rad", "slip angle [deg]", 180 / np.pi, formula.lateral_force, 1e-3),
        ("aligning", "M_z_Nm", "slip_angle_rad", "slip angle [deg]", 180 / np.pi, formula.aligning_moment, 1.0),
    )
    labels = {"longitudinal": "F_x, forward [kN]", "lateral": "F_y, to the left [kN]", "aligning": "M_z [N m]"}
    loads = upright["F_z_N"].round(3).unique()
    for number, (name, column, along, label, unit, law, scale) in enumerate(panels):
        axes = add_axes(drawn, 0.75 + 4.3 * number, 0.6, 3.4, 3.25)
        rows = upright[upright["free"] == (0.0 if name == "longitudinal" else 1.0)]
        for colour, load in zip(PALETTE * (1 + len(loads) // len(PALETTE)), loads, strict=False):
            here = rows[np.isclose(rows["F_z_N"], load)]
            axes.plot(unit * here[along], scale * here[column], "o", ms=3.5, color=colour, label=f"{load / 1e3:.3g} kN")
            if name in fit.errors and len(here):
                at = np.linspace(here[along].min(), here[along].max(), POINTS)
                axes.plot(unit * at, scale * law(load, at), lw=1.2, color=colour)
        axes.axhline(0.0, color=QUIET, lw=0.6)
        axes.set_xlabel(label, fontsize=FONT)
        axes.set_ylabel(labels[name], fontsize=FONT)
        axes.legend(fontsize=FONT, frameon=False)
        tidy(axes)
    quality = ", ".join(f"{name} {100 * error:.2g} %" for name, error in fit.errors.items())
    title(
        drawn, f"{forces.study.name}: forces of the road on the tyre, and Magic Formula 6.1",
        f"points computed, lines fitted; rms of the fit over the largest value: {quality}",
    )  # fmt: skip
    return drawn
