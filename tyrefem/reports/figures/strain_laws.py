"""Picture of several strain laws: strain energy on the section, and by part of the tyre."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.strain_laws import strain_laws
from tyrefem.reports.figures.style import (
    ENERGY_MAP,
    FONT,
    INK,
    PALETTE,
    TITLE,
    add_axes,
    digits,
    figure,
    millimetres,
    section_axes,
    short,
    si,
    tidy,
    title,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.simulation.law_comparison import LawComparison, LawOutcome

Array = NDArray[np.float64]
#: Share of the section's area that the colour scale spans; higher values have the last colour.
SPANNED = 0.96
#: Width of a letter of the parts' labels, inches, and their slope, degrees, where they do not fit side by side.
LETTER, SLOPE = 0.07, 60


def strain_laws_figure(comparison: LawComparison) -> Figure:
    """Draw strain energy density of each law (above), and energy by part (below; dotted: energy that heats)."""
    maps = [_map(comparison, outcome) for outcome in comparison.outcomes]
    spread = np.concatenate([_by_area(law_map) for law_map in maps])
    top = float(np.quantile(spread, SPANNED))
    peak = max(float(values.max()) for law_map in maps for _, _, values in law_map)
    factor, unit = si(top, "J/m³")
    x, y = millimetres(np.concatenate([points.T for law_map in maps for points, _, _ in law_map]))
    low, high, left, right = y.min() - 4, y.max() + 4, x.min() - 3, x.max() + 3
    tall = 3.4
    wide = max(tall * (right - left) / (high - low), 2.3)
    width = 0.75 + len(maps) * (wide + 0.55) + 0.8
    labels = [short(part.name if part.name == part.title else f"{part.name}: {part.title}", 28)
              for part in comparison.parts]  # fmt: skip
    longest = LETTER * max(map(len, labels))
    sloping = longest > (width - 0.95) / len(labels)
    deep = longest * math.sin(math.radians(SLOPE)) if sloping else 0.0
    drawn = figure(width, tall + 2.95 + deep + TITLE)
    image: Any = None
    for number, (outcome, law_map) in enumerate(zip(comparison.outcomes, maps, strict=True)):
        axes = add_axes(drawn, 0.75 + number * (wide + 0.55), 2.65 + deep, wide, tall)
        for points, corners, values in law_map:
            image = axes.tripcolor(
                *millimetres(points.T), corners, values / factor, shading="gouraud", cmap=ENERGY_MAP, vmin=0.0,
                vmax=top / factor, rasterized=True,
            )  # fmt: skip
        axes.set_xlim(left, right)
        axes.set_ylim(low, high)
        section_axes(axes)
        if number:
            axes.set_ylabel("")
        axes.set_title(
            f"{strain_laws()[outcome.law].title}, D = {outcome.deflection * 1e3:.1f} mm", fontsize=FONT, loc="left"
        )
    bar_axes = add_axes(drawn, width - 0.85, 2.65 + deep, 0.16, tall)
    bar = drawn.colorbar(image, cax=bar_axes, extend="max" if peak > 1.001 * top else "neither")
    bar.set_label(f"U [{unit}], peak {peak / factor:{digits(peak / factor)}}", fontsize=FONT)
    bar_axes.tick_params(labelsize=FONT, colors=INK)
    bars = add_axes(drawn, 0.75, 0.4 + deep, width - 0.95, 1.4)
    _bars(bars, comparison)
    bars.set_xticks(range(len(labels)), labels)
    if sloping:
        bars.tick_params(axis="x", labelrotation=SLOPE)
        for label in bars.get_xticklabels():
            label.set(ha="right", va="top", rotation_mode="anchor")
    case = comparison.case
    title(
        drawn, f"{comparison.study.name}: strain energy by strain law",
        f"{case.load / 1e3:.4g} kN at {case.pressure / 1e3:.4g} kPa; largest change of strain within a revolution",
    )  # fmt: skip
    return drawn


def _map(comparison: LawComparison, outcome: LawOutcome) -> list[tuple[Array, Any, Array]]:
    """Points (2, n), triangles and U of every part for z >= 0; U at a border is the part's value."""
    mesh, pieces = comparison.mesh.mesh, []
    for part in comparison.parts:
        cells = mesh.t[:, mesh.subdomains[part.name]]
        cells = cells[:, mesh.p[1, cells].mean(axis=0) >= 0]
        numbers, corners = np.unique(cells, return_inverse=True)
        corners = corners.reshape(cells.shape)
        flat = corners if len(corners) == 3 else np.hstack([corners[[0, 1, 2]], corners[[0, 2, 3]]])
        points = mesh.p[:, numbers]
        pieces.append((points, flat.T, outcome.energy_density(part, points)))
    return pieces


def _by_area(pieces: list[tuple[Array, Any, Array]]) -> Array:
    """Mean U of the triangles, each repeated once per 0.1 mm2 of its area."""
    repeated = []
    for points, corners, values in pieces:
        r, z = points[:, corners.T]
        area = np.abs((r[1] - r[0]) * (z[2] - z[0]) - (r[2] - r[0]) * (z[1] - z[0])) / 2
        repeated.append(np.repeat(values[corners].mean(axis=1), np.ceil(area / 1e-7).astype(int)))
    return np.concatenate(repeated)


def _bars(axes: Axes, comparison: LawComparison) -> None:
    names = [part.name for part in comparison.parts]
    places, step = np.arange(len(names)), 0.8 / len(comparison.outcomes)
    for number, outcome in enumerate(comparison.outcomes):
        at = places + (number - (len(comparison.outcomes) - 1) / 2) * step
        energies = [comparison.energies[outcome.law][name] for name in names]
        total = sum(energies)
        colour = PALETTE[number]
        axes.bar(
            at,
            energies,
            0.9 * step,
            color=colour,
            label=f"{strain_laws()[outcome.law].title}: {total:{digits(total)}} J",
        )
        heating = [comparison.heating[outcome.law][name] for name in names]
        if not np.allclose(heating, energies):
            words = f"U that heats, all harmonics: {sum(heating):{digits(sum(heating))}} J"
            axes.bar(at, heating, 0.9 * step, fill=False, ec=INK, ls=":", lw=1.1, label=words)
    axes.set_ylabel("energy [J]", fontsize=FONT)
    tidy(axes)
    axes.legend(
        loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncol=4, fontsize=FONT - 0.5, frameon=False, borderpad=0.1,
        columnspacing=1.2, handlelength=1.5,
    )  # fmt: skip
