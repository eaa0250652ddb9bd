"""Picture of strain energy per cycle and heat source on the section, by zone."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.reports.figures.canvas import Canvas, canvas, draw_outlines
from tyrefem.reports.figures.cells import triangles
from tyrefem.reports.figures.style import (
    ENERGY_MAP,
    Label,
    digits,
    millimetres,
    plain,
    si,
    temperature_map,
    time_unit,
    title,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.inputs.study import StudyData
    from tyrefem.simulation.result import ResultData
    from tyrefem.simulation.strain_by_region import StrainByRegion

Array = NDArray[np.float64]
#: Share of the section's area that a colour scale spans; higher values have the last colour.
SPANNED = 0.99
#: Difference of the heat of both sides, over the whole, above which both are drawn.
UNEVEN = 0.03


@dataclass(frozen=True)
class ZoneHeat:
    """Triangles of a strain zone with separate nodes, nodal U, J/m3, and q, W/m3, and power of the whole tyre, W."""

    name: str
    title: str
    points: Array
    corners: NDArray[Any]
    energy: Array
    source: Array
    power: float


def zone_heat(result: ResultData, i: int) -> list[ZoneHeat]:
    """Every zone with separate values, so that the steps between zones stay sharp."""
    operators = result.tyre.problem.operators
    t = float(result.times[i]) * (1 - 1e-12)
    sources = result.heat_source(i)
    powers = result.heat_budget.powers
    heats = []
    for zone in result.tyre.schedule.zones:
        corners, _ = triangles(operators, operators.elements(zone.name))
        numbers = np.full(operators.size, -1)
        numbers[operators.dofs(zone.name)] = np.arange(len(operators.dofs(zone.name)))
        nodes, source = sources[zone.name]
        energy = result.tyre.hysteresis[zone.name].energy_density(nodes, t)
        power = float(powers["generated", zone.title][i])
        heats.append(ZoneHeat(zone.name, zone.title, nodes, numbers[corners], energy, source, power))
    return heats


def heat_source_figure(result: ResultData) -> Figure:
    """Draw strain energy per cycle, J/m3 (left), and heat source, W/m3, of the phase with most heat (right).

    Where the heat of both sides differs, as under a slip angle or camber, only the heat source, on both sides.
    """
    i = result.rolling_reading
    zones = zone_heat(result, len(result.times) - 1 if i is None else i)
    total = sum(zone.power for zone in zones)
    uneven = not result.study.section.half and unevenness(zones) > UNEVEN
    return energy_and_heat(result.study, zones, _subtitle(result, i, total, uneven=uneven), uneven=uneven)


def cycle_heat_figure(strains: StrainByRegion) -> Figure:
    """Draw strain energy per cycle (left) and heat source at the start (right) of a load case."""
    tyre, case = strains.tyre, strains.case
    operators, zones = tyre.problem.operators, []
    powers = dict(zip(strains.table["region"], strains.table["heat_W"], strict=True))
    for zone in tyre.schedule.zones:
        corners, _ = triangles(operators, operators.elements(zone.name))
        dofs = operators.dofs(zone.name)
        numbers = np.full(operators.size, -1)
        numbers[dofs] = np.arange(len(dofs))
        nodes = tyre.problem.points(zone.name)
        name = zone.name if zone.name == zone.title else f"{zone.name}: {zone.title}"
        zones.append(
            ZoneHeat(
                zone.name, zone.title, nodes, numbers[corners], strains.cycle.energy_density(zone.name, nodes),
                strains.heat_density(zone, nodes), float(powers[name]),
            )
        )  # fmt: skip
    road = "flat road" if math.isinf(case.drum_diameter) else f"drum Ø {case.drum_diameter:.3g} m"
    subtitle = (
        f"{case.load / 1e3:.4g} kN at {case.pressure / 1e3:.4g} kPa, {road}: D = {case.deflection * 1e3:.1f} mm; "
        f"left: strain energy per cycle; right: heat source at the start"
    )
    return energy_and_heat(tyre.study, zones, subtitle)


def energy_and_heat(study: StudyData, zones: list[ZoneHeat], subtitle: str, *, uneven: bool = False) -> Figure:
    """Draw strain energy per cycle (left) and heat source (right) of zones, with their powers beside; ``uneven``: the
    heat source on both sides."""
    total = sum(zone.power for zone in zones)
    energies, sources = [zone.energy for zone in zones], [zone.source for zone in zones]
    top_u, top_q = scale_top(zones, energies), scale_top(zones, sources)
    factor_u, unit_u = si(top_u, "J/m³")
    factor_q, unit_q = si(top_q, "W/m³")
    rows = [_row(zone, total) for zone in zones]
    names = [plain(zone.title if zone.name == zone.title else f"{zone.name}: {zone.title}") for zone in zones]
    drawn = canvas(study.section, names, rows, bars=1 if uneven else 2)
    left = right = None
    for zone in zones:
        right = _half(drawn, zone, zone.source / factor_q, 1.0, temperature_map(), top_q / factor_q or 1.0)
        if uneven:
            _half(drawn, zone, zone.source / factor_q, -1.0, temperature_map(), top_q / factor_q or 1.0)
        else:
            left = _half(drawn, zone, zone.energy / factor_u, -1.0, ENERGY_MAP, top_u / factor_u or 1.0)
    draw_outlines(drawn.axes, study.section, color="#505050", width=0.7)
    if not uneven:
        peak = max(float(u.max()) for u in energies) / factor_u
        drawn.axes.plot([0, 0], [drawn.section.place(0.0, 0.0)[0] * 1e3, drawn.high], color="white", lw=2.5, zorder=4)
        _bar(drawn, left, "strain energy per cycle U", unit_u, peak, -1.0)
    _bar(drawn, right, "heat source q", unit_q, max(float(q.max()) for q in sources) / factor_q, 1.0)
    anchors = [_anchor(drawn, zone) for zone in zones]
    order = sorted(range(len(zones)), key=lambda n: -anchors[n][1])
    drawn.beside([Label(names[n], -anchors[n][0], anchors[n][1]) for n in order], -1.0)
    drawn.beside([Label(rows[n], anchors[n][0], anchors[n][1]) for n in order], 1.0)
    title(drawn.figure, study.title, subtitle)
    return drawn.figure


def unevenness(zones: list[ZoneHeat]) -> float:
    """Difference of the heat of both sides of a full section, over their sum; 0 without heat."""
    sides = np.zeros(2)
    for zone in zones:
        r, z = zone.points[:, zone.corners.T]
        area = np.abs((r[1] - r[0]) * (z[2] - z[0]) - (r[2] - r[0]) * (z[1] - z[0])) / 2
        heat = area * r.mean(axis=0) * zone.source[zone.corners].mean(axis=1)
        sides += [heat[z.mean(axis=0) < 0].sum(), heat[z.mean(axis=0) > 0].sum()]
    return float(abs(sides[1] - sides[0]) / sides.sum()) if sides.sum() > 0 else 0.0


def scale_top(zones: list[ZoneHeat], values: list[Array]) -> float:
    """The value that 99 % of the section's area does not exceed, so that a peak does not darken the picture."""
    areas, means = [], []
    for zone, value in zip(zones, values, strict=True):
        r, z = zone.points[:, zone.corners.T]
        areas.append(np.abs((r[1] - r[0]) * (z[2] - z[0]) - (r[2] - r[0]) * (z[1] - z[0])) / 2)
        means.append(value[zone.corners].mean(axis=1))
    area, mean = np.concatenate(areas), np.concatenate(means)
    order = np.argsort(mean)
    below = np.cumsum(area[order])
    place = min(int(np.searchsorted(below, SPANNED * below[-1])), len(order) - 1)
    # Heat in less than 1 % of the area: its peak is the scale.
    return float(mean[order[place]]) or max(float(value.max()) for value in values)


def _bar(drawn: Canvas, image: Any, label: str, unit: str, peak: float, side: float) -> None:
    """Draw a colour bar; if values exceed it, with an arrow at its end and the peak in its label."""
    beyond = peak > 1.001 * image.norm.vmax
    text = f"{label} [{unit}]" + (f", peak {peak:{digits(peak)}}" if beyond else "")
    drawn.color_bar(image, text, side=side, extend="max" if beyond else "neither")


def _row(zone: ZoneHeat, total: float) -> str:
    factor, unit = si(total, "W")
    share = f" ({100 * zone.power / total:.1f} %)" if total > 0 else ""
    return f"{zone.power / factor:{digits(total / factor)}} {unit}{share}"


def _subtitle(result: ResultData, i: int | None, total: float, *, uneven: bool = False) -> str:
    if i is None:
        return "no heat: the tyre never rolls under load; left: strain energy of a cycle, if it rolled"
    divisor, unit = time_unit(float(result.times[-1]))
    force = total / result.tyre.motion(float(result.times[i]) * (1 - 1e-12)).speed
    shown = "heat source of both sides" if uneven else "left: strain energy per cycle; right: heat source"
    return (
        f"{shown} after {result.times[i] / divisor:.4g} {unit}; "
        f"whole tyre {total:.4g} W = rolling resistance {force:.3g} N times speed"
    )


def _half(drawn: Canvas, zone: ZoneHeat, values: Array, sign: float, colours: Any, top: float) -> Any:
    """Draw one half of the picture; for a full section, only the elements on that side."""
    x, y = millimetres(zone.points.T)
    corners = zone.corners
    if drawn.section.half:
        x = sign * x
    else:
        corners = corners[sign * x[corners].mean(axis=1) > 0]
    return drawn.axes.tripcolor(
        x, y, corners, values, shading="gouraud", cmap=colours, vmin=0.0, vmax=top, rasterized=True, zorder=1
    )


def _anchor(drawn: Canvas, zone: ZoneHeat) -> tuple[float, float]:
    """The node with z >= 0 nearest to the middle of the zone's side there, mm."""
    x, y = millimetres(zone.points.T)
    here = np.flatnonzero(x >= 0)
    s, depth = drawn.section.locate(zone.points.T[here])
    off = np.abs(s - (s.min() + s.max()) / 2)
    # A coarse mesh may have no node near the middle.
    away = off + np.abs(depth - np.median(depth[off < max(3e-3, 1.01 * float(off.min()))]))
    node = here[int(np.argmin(away))]
    return float(x[node]), float(y[node])
