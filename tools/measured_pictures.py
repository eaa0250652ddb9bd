"""Figures of docs/measured.md: measured points over computed curves with bands, and footprints beside ink prints."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from measured_comparison import (
    ECF,
    INCH,
    LBF,
    PASSENGER,
    PSI,
    RE71R,
    changes,
    column,
    data,
    rows_at,
    table,
    uncertainties,
)
from numpy.typing import NDArray

from tyrefem.reports.figures.style import ENERGY_MAP, FONT, INK, PALETTE, QUIET, add_axes, figure, tidy

Array = NDArray[np.float64]
#: Bands: so many standard uncertainties of the computed value.
BAND = 2.0
COLORS = (PALETTE[0], PALETTE[2], PALETTE[1], PALETTE[3])


def _width(tyre: str, quantity: str) -> float:
    """Half width of a band, relative."""
    _, numerical, inputs = uncertainties(tyre, quantity)
    return BAND * math.hypot(numerical, inputs)


def _curves(axes: Any, tyre: str, quantity: str, pressure: float, color: str) -> None:
    for motion, style in (("large", "-"), ("linear", ":")):
        rows = rows_at(tyre, pressure, motion)
        line = np.array(sorted((column(row, "load") / 1e3, column(row, quantity)) for row in rows))
        axes.plot(*line.T, style, color=color, lw=1.4)
        if motion == "large":
            wide = _width(tyre, quantity)
            low, high = line[:, 1] * (1 - wide), line[:, 1] * (1 + wide)
            axes.fill_between(line[:, 0], low, high, color=color, alpha=0.13, lw=0)


def _panels(title: str, panels: Sequence[tuple[str, Callable[[Any], None]]]) -> Any:
    drawn = figure(8.2, 6.2)
    for number, (label, draw) in enumerate(panels):
        axes = add_axes(drawn, 0.75 + 4.0 * (number % 2), 0.5 + 2.85 * (1 - number // 2), 3.2, 2.3)
        draw(axes)
        axes.set_xlabel("load, kN", fontsize=FONT)
        axes.set_ylabel(label, fontsize=FONT)
        tidy(axes)
    drawn.suptitle(title, fontsize=FONT, y=0.995)
    return drawn


def passenger() -> Any:
    """205/60R15 at 2.2 bar."""
    rows = data("measured-205-60r15/summary.csv")
    names = {
        "deflection": "deflection",
        "length": "contact_length",
        "width": "contact_width",
        "rolling radius": "effective_rolling_radius",
    }

    def panel(quantity: str) -> Callable[[Any], None]:
        def draw(axes: Any) -> None:
            _curves(axes, PASSENGER, quantity, 220, COLORS[0])
            pairs = [(r["load [N]"] / 1e3, r[f"{names[quantity]} [mm]"]) for r in rows]
            axes.plot(*zip(*pairs, strict=True), "o", color=INK, ms=4)

        return draw

    return _panels(
        "205/60R15, 220 kPa. Points: measured; solid: large motion; dotted: linear; band: 2 u of the computed",
        [(f"{quantity}, mm", panel(quantity)) for quantity in names],
    )


def prints() -> Any:
    """ECF ink prints."""
    rows = data("measured-255-40r17/footprints-ecf.csv")
    names = {
        "length": ("length [in]", INCH, "mm"),
        "width": ("width [in]", INCH, "mm"),
        "gross area": ("gross_area [in**2]", INCH**2 / 100, "cm²"),
        "net area": ("net_area [in**2]", INCH**2 / 100, "cm²"),
    }

    def panel(quantity: str) -> Callable[[Any], None]:
        name, unit, _ = names[quantity]

        def draw(axes: Any) -> None:
            for psi, color in zip((26, 28, 30), COLORS, strict=False):
                part = [r for r in rows if r["pressure [psi]"] == psi]
                _curves(axes, ECF, quantity, psi * PSI, color)
                pairs = [(r["load [lbf]"] * LBF / 1e3, r[name] * unit) for r in part]
                axes.plot(*zip(*pairs, strict=True), "o", color=color, ms=4, label=f"{psi * PSI:.0f} kPa")
            axes.legend(fontsize=7, frameon=False)

        return draw

    return _panels(
        "255/40ZR17 ECF, ink prints. Points: measured; solid: large motion; dotted: linear; bands: 2 u of the computed",
        [(f"{quantity}, {names[quantity][2]}", panel(quantity)) for quantity in names],
    )


def radius() -> Any:
    """RE-71R: load over loaded radius."""
    drawn = figure(6.4, 4.2)
    axes = add_axes(drawn, 0.7, 0.55, 5.3, 3.25)
    rows = data("measured-255-40r17/load-radius-re71r.csv")
    for psi, color in zip((24, 27, 30, 33), COLORS, strict=True):
        part = [(r["loaded_radius [mm]"], r["load [N]"] / 1e3) for r in rows if r["pressure [psi]"] == psi]
        axes.plot(*zip(*part, strict=True), "o", ms=3, color=color, label=f"{psi * PSI:.0f} kPa")
        for motion, style in (("large", "-"), ("linear", ":")):
            names = ("loaded radius", "load", "deflection")
            line = sorted(tuple(column(row, name) for name in names) for row in rows_at(RE71R, psi * PSI, motion))
            free = line[-1][0] + line[-1][2]
            r, load, deflection = np.array([*line, (free, 0.0, 0.0)]).T
            axes.plot(r, load / 1e3, style, color=color, lw=1.2)
            if motion == "large":
                wide = _width(RE71R, "deflection") * deflection
                axes.fill_betweenx(load / 1e3, r - wide, r + wide, color=color, alpha=0.12, lw=0)
    axes.set_xlabel("loaded radius, mm", fontsize=FONT)
    axes.set_ylabel("load, kN", fontsize=FONT)
    axes.legend(fontsize=8, frameon=False)
    tidy(axes)
    title = "255/40R17 RE-71R. Points: measured; lines: large motion, band 2 u; dotted: linear"
    drawn.suptitle(title, fontsize=FONT, y=0.99)
    return drawn


def print_outline(length: float, width: float, area: float, count: int = 400) -> tuple[Array, Array]:
    """(x, z) of a superellipse |2x/length|^n + |2z/width|^n = 1 with the given area: an ink print's outline."""
    from scipy.optimize import brentq

    def missing(n: float) -> float:
        return math.gamma(1 + 1 / n) ** 2 / math.gamma(1 + 2 / n) - area / (length * width)

    n = float(brentq(missing, 0.5, 200.0))
    angle = np.linspace(0, 2 * np.pi, count)
    cos, sin = np.cos(angle), np.sin(angle)
    return (
        length / 2 * np.sign(cos) * np.abs(cos) ** (2 / n),
        width / 2 * np.sign(sin) * np.abs(sin) ** (2 / n),
    )


def whole_print(rows: list[dict[str, str]]) -> tuple[Array, Array, Array]:
    """x (a,), z (b,) and pressure (b, a) over the whole footprint of the rows of one quarter."""
    x, z, p = (np.array([float(row[key]) for row in rows]) for key in ("x [mm]", "z [mm]", "pressure [kPa]"))
    along = np.unique(x)
    z, p = z[x == along[0]], p.reshape(len(along), -1).T
    x, p = np.concatenate([-along[:0:-1], along]), np.concatenate([p[:, :0:-1], p], axis=1)
    off = z > 1e-6
    return x, np.concatenate([-z[off][::-1], z]), np.concatenate([p[off][::-1], p])


def pressure() -> Any:
    """Computed contact pressure of the ECF with the outlines of its ink prints, three pressures by three loads."""
    drawn = figure(9.7, 7.0)
    measured = data("measured-255-40r17/footprints-ecf.csv")
    rows = table("pressure")
    loads, pressures = (500, 1000, 1400), (26, 28, 30)
    levels = np.array([2.0, *np.arange(25, 601, 25)])
    for i, psi in enumerate(pressures):
        for j, load in enumerate(loads):
            axes = add_axes(drawn, 0.7 + 2.7 * j, 0.5 + 2.1 * (2 - i), 2.6, 1.75)
            part = [
                row for row in rows
                if abs(float(row["inflation [kPa]"]) - psi * PSI) < 0.5 and round(float(row["load [lbf]"])) == load
            ]  # fmt: skip
            x, z, p = whole_print(part)
            filled = axes.contourf(z, x, p.T, levels=levels, cmap=ENERGY_MAP, extend="max")
            row = next(r for r in measured if r["pressure [psi]"] == psi and r["load [lbf]"] == load)
            length, width = row["length [in]"] * INCH, row["width [in]"] * INCH
            along, across = print_outline(length, width, row["gross_area [in**2]"] * INCH**2)
            axes.plot(across, along, color="#D55E00", lw=1.6)
            axes.set_aspect("equal")
            axes.set_xlim(-128, 128)
            axes.set_ylim(-85, 85)
            axes.set_title(f"{psi * PSI:.0f} kPa, {load * LBF / 1e3:.2f} kN", fontsize=FONT, color=INK, pad=2)
            tidy(axes, grid=False)
            axes.tick_params(labelbottom=i == 2, labelleft=j == 0)
            if i == 2:
                axes.set_xlabel("across z, mm", fontsize=FONT)
            if j == 0:
                axes.set_ylabel("along the road x, mm", fontsize=FONT)
    bar = drawn.colorbar(filled, cax=add_axes(drawn, 8.9, 0.8, 0.14, 5.4), ticks=np.arange(0, 601, 100))
    bar.set_label("computed contact pressure, kPa", fontsize=FONT)
    bar.ax.tick_params(labelsize=FONT)
    title = "255/40ZR17 ECF: computed contact pressure, large motion, and outline of the ink print (orange)"
    drawn.suptitle(title, fontsize=FONT, y=0.99)
    return drawn


def uncertain_numbers() -> Any:
    """How far each uncertain number moves the compared quantities of two tyres."""
    drawn = figure(9.0, 5.5)
    quantities = {
        PASSENGER: ("deflection", "length", "width", "gross area", "net area", "rolling resistance at 20 degC"),
        ECF: ("length", "width", "gross area", "net area"),
    }
    left = 2.7
    for tyre, names_of in quantities.items():
        names = list(changes(tyre, "length"))
        shift = np.array([[100 * changes(tyre, quantity)[name] for quantity in names_of] for name in names])
        axes = add_axes(drawn, left, 0.4, 0.58 * len(names_of), 4.3)
        axes.imshow(shift, cmap="RdBu_r", vmin=-8, vmax=8, aspect="auto")
        for i, j in np.ndindex(shift.shape):
            ink = "white" if abs(shift[i, j]) > 6 else INK
            axes.text(j, i, f"{shift[i, j]:+.1f}", ha="center", va="center", fontsize=6.5, color=ink)
        axes.set_xticks(range(len(names_of)), [q.split(" at")[0].replace(" ", "\n") for q in names_of], fontsize=6.5)
        axes.xaxis.tick_top()
        axes.set_yticks(range(len(names)), names if tyre == PASSENGER else [], fontsize=7)
        axes.tick_params(length=0)
        for spine in axes.spines.values():
            spine.set_visible(False)
        axes.set_xlabel(tyre, fontsize=FONT, color=INK)
        left += 0.58 * len(names_of) + 0.3
    title = "Change of results, %, with each number one standard deviation higher"
    drawn.suptitle(title, fontsize=FONT, y=0.995, color=QUIET)
    return drawn


def aircraft() -> Any:
    """Catalogue and computed deflections of 395 bias tyres."""
    drawn = figure(5.2, 4.4)
    axes = add_axes(drawn, 0.7, 0.55, 4.2, 3.5)
    pairs = np.array(
        [(float(r["catalogue deflection [mm]"]), float(r["computed deflection [mm]"])) for r in table("aircraft")]
    )
    ends = np.array([0.0, 140.0])  # one row, a slip of the transcription, lies beyond
    axes.fill_between(ends, 0.8 * ends, 1.2 * ends, color=PALETTE[2], alpha=0.15, lw=0, label="20 % either way")
    axes.plot(ends, ends, color=QUIET, lw=1)
    axes.plot(*pairs.T, ".", color=PALETTE[0], ms=4, label="tyre of the data book")
    axes.set_xlim(*ends)
    axes.set_ylim(*ends)
    axes.set_xlabel("catalogue deflection at rated load, mm", fontsize=FONT)
    axes.set_ylabel("computed by TR R-64, mm", fontsize=FONT)
    axes.legend(fontsize=8, frameon=False)
    tidy(axes)
    return drawn


FIGURES: dict[str, Callable[[], Any]] = {
    "passenger": passenger,
    "radius": radius,
    "prints": prints,
    "pressure": pressure,
    "sensitivities": uncertain_numbers,
    "aircraft": aircraft,
}
