"""Pictures of heat of unknown origin: on the section, and by station of the meridian."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.heat.courses import BEGINS, ENDS
from tyrefem.diagnose.unknowns.heat_patches import ALL_LAYERS, INNER, OUTER
from tyrefem.diagnose.verdicts.verdict import PARTLY, UNEXPLAINED
from tyrefem.diagnose.words.heat import is_told, source_amount
from tyrefem.reports.diagnosis_heat import FILE, heat_course_figure
from tyrefem.reports.diagnosis_sections import DIVERGING, draw_ground
from tyrefem.reports.figures.canvas import Canvas, canvas
from tyrefem.reports.figures.style import (  # fmt: skip
    FILLS,
    FONT,
    INK,
    QUIET,
    TITLE,
    Label,
    add_axes,
    figure,
    line_style,
    millimetres,
    panel_title,
    short,
    si,
    tidy,
    title,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.heat.over_time import HeatOverTime
    from tyrefem.diagnose.heat.sources import UnknownSource
    from tyrefem.geometry import Section

Array = NDArray[np.float64]


def tells_missing_heat(d: DiagnosisData) -> bool:
    """Whether page and pictures show heat of unknown origin: unexplained, or clear sources beside the named effects.

    Not where another strain law explains the deviation by itself.
    """
    if d.verdict == UNEXPLAINED:
        return d.better_law is None or not d.better_law.alone
    return d.verdict == PARTLY and bool(d.missing.clear)


def missing_figures(d: DiagnosisData) -> dict[str, Figure]:
    """Pictures of the missing heat: on the section, by station and run with its uncertainty, and over time.

    The first two show the sources over time where they were estimated. Heat that is constant in time, by station, may
    have parts that cancel where a source begins late; it is drawn only without these sources.
    """
    drawn = {"missing-heat.png": _missing_map(d), "missing-heat-stations.png": _missing_stations(d)}
    if d.missing.over_time is not None:
        drawn[FILE] = heat_course_figure(d, d.missing.over_time)
    return drawn


def drawn_sources(d: DiagnosisData) -> tuple[UnknownSource, ...]:
    """The stated sources; all of them if none is clear; none if they were not estimated over time."""
    over_time = d.missing.over_time
    return () if over_time is None else over_time.clear or over_time.sources


# -- on the section ----------------------------------------------------------------------------------------------------


def _missing_map(d: DiagnosisData) -> Figure:
    """Draw heat inside, W/m3, over the thickness (left), and flux into the surfaces, W/m2, as bands (right).

    With one kind of source only, it is drawn on both sides.
    """
    sources = drawn_sources(d)
    section = d.original.section
    inside = not sources or any(source.inside for source in sources)
    through = not sources or not all(source.inside for source in sources)
    written = [(source_amount(source), source) for source in sources]
    drawn = canvas(section, (), [text for text, _ in written], bars=inside + through)
    draw_ground(drawn)
    s = np.linspace(0.0, section.line.length, 241)
    sides = (-1.0,) if inside and through else (-1.0, 1.0)
    if inside:
        image, unit = _draw_heat(d, drawn, s, sides)
        drawn.color_bar(image, f"heat inside while the tyre rolls [{unit}]", side=-1.0 if through else 1.0)
    if through:
        image, unit = _draw_flux(d, drawn, s, (1.0,) if inside else sides)
        drawn.color_bar(image, f"flux into the surface, always [{unit}]")
    labels = []
    for text, source in written:
        depth = float(section.total_thickness([source.station])[0]) * (0.0 if source.where == INNER else 0.5)
        x, y = (float(part) for part in millimetres(section.place(source.station, depth)))
        labels.append(Label(text, abs(x), y))
    drawn.beside(sorted(labels, key=lambda label: -label.y), 1.0)
    title(drawn.figure, "Heat of unknown origin", _map_words(sources, inside and through))
    return drawn.figure


def _map_words(sources: tuple[UnknownSource, ...], both: bool) -> str:
    split = "; left: inside, right: through a surface" if both else ""
    if not sources:
        return f"mean over the fitted runs{split}"
    clear = "sources at full strength" if sources[0].clear else "most probable sources, none of them clear"
    untold = "" if all(map(is_told, sources)) else "; heat inside is not told from a flux"
    return f"{clear}{split}{untold}"


def _draw_heat(d: DiagnosisData, drawn: Canvas, s: Array, sides: tuple[float, ...]) -> tuple[Any, str]:
    """Heat over the thickness on some sides; the image for the colour bar, and the unit."""
    missing, section = d.missing, d.original.section
    depth = np.linspace(0.0, 1.0, 33)
    total = np.asarray(section.total_thickness(s))
    x, y = millimetres(np.array([section.place(s, share * total) for share in depth]))
    sources = [source for source in drawn_sources(d) if source.inside]
    if sources:
        values = np.zeros(x.shape)
        for source in sources:
            here = _smooth(missing.stations, s, source.station) * source.amount
            regions = [section.region_at(s, share * total) for share in depth]
            where = np.array([np.asarray(region) == source.where for region in regions])
            values += np.where(where | (source.where == ALL_LAYERS), here, 0.0)
    else:
        shared = zip(missing.stations, missing.heat.mean(axis=0), strict=True)
        values = np.broadcast_to(sum(_smooth(missing.stations, s, at) * heat for at, heat in shared), x.shape)
    values, unit = _scaled(values, "W/m³")
    limit = max(float(np.abs(values).max()), 1e-9)
    for side in sides:
        image = drawn.axes.pcolormesh(
            side * np.abs(x), y, values, cmap=DIVERGING, vmin=-limit, vmax=limit, shading="gouraud", zorder=2,
            rasterized=True,
        )  # fmt: skip
    return image, unit


def _draw_flux(d: DiagnosisData, drawn: Canvas, s: Array, sides: tuple[float, ...]) -> tuple[Any, str]:
    """Flux as bands along the surfaces on some sides; the image for the colour bar, and the unit."""
    missing, section = d.missing, d.original.section
    sources = [source for source in drawn_sources(d) if not source.inside]
    bands: dict[str, Array] = {}
    if sources:
        for source in sources:
            surface = INNER if source.where == INNER else OUTER
            here = _smooth(missing.stations, s, source.station) * source.amount
            bands[surface] = bands.get(surface, np.zeros(len(s))) + here
    else:
        shared = zip(missing.stations, missing.flux.mean(axis=0), strict=True)
        bands[OUTER] = np.asarray(sum(_smooth(missing.stations, s, at) * flux for at, flux in shared))
    divisor, unit = si(max(float(np.abs(values).max()) for values in bands.values()), "W/m²")
    limit = max(*(float(np.abs(values).max()) / divisor for values in bands.values()), 1e-9)
    for surface, values in bands.items():
        outer = surface == OUTER
        x, y = millimetres(section.place(s, np.asarray(section.total_thickness(s)) * float(outer)))
        x = np.abs(x)
        further = _outwards(x, y, (0.11 if outer else -0.11) * drawn.scale)
        for side in sides:
            image = drawn.axes.pcolormesh(
                side * np.array([x, further[0]]), np.array([y, further[1]]),
                np.broadcast_to(values / divisor, (2, len(s))),
                cmap="PuOr_r", vmin=-limit, vmax=limit, shading="gouraud", zorder=4, rasterized=True,
            )  # fmt: skip
    return image, unit


def _smooth(stations: Array, s: Array, station: float) -> Array:
    """A bell of unit height about a station, of width 0.6 times the spacing of the stations (see the effects)."""
    width = 0.6 * float(stations[1] - stations[0])
    return np.asarray(np.exp(-(((s - station) / width) ** 2) / 2))


def _scaled(values: Array, unit: str) -> tuple[Array, str]:
    """Convert values to the unit whose prefix fits the largest; return them and the unit."""
    divisor, shown = si(float(np.abs(values).max()), unit)
    return values / divisor, shown


def _outwards(x: Array, y: Array, distance: float) -> tuple[Array, Array]:
    """A curve shifted outwards, away from the tyre's air space, mm."""
    dx, dy = np.gradient(x), np.gradient(y)
    length = np.hypot(dx, dy)
    return x - dy / length * distance, y + dx / length * distance


# -- by station --------------------------------------------------------------------------------------------------------


def _missing_stations(d: DiagnosisData) -> Figure:
    """Draw heat and flux of every fitted run with their standard deviations, over the meridian."""
    missing, section = d.missing, d.original.section
    sources, over_time = drawn_sources(d), missing.over_time
    kinds = [
        kind
        for kind in (
            (True, "W/m³", "heat inside, while the tyre rolls"),
            (False, "W/m²", "flux into a surface, always" if sources else "flux into the outer surface, always"),
        )
        if not sources or any(source.inside == kind[0] for source in sources)
    ]
    drawn = figure(9.4, TITLE + 0.3 + 2.45 * len(kinds))
    panels = [add_axes(drawn, 0.85, 0.5 + 2.45 * row, 8.3, 2.0) for row in reversed(range(len(kinds)))]
    spacing = float(missing.stations[1] - missing.stations[0]) * 1e3
    many = len(missing.runs)
    for axes, (inside, unit, what) in zip(panels, kinds, strict=True):
        if sources and over_time is not None:
            here = [source for source in sources if source.inside == inside]
            along = np.array([source.station for source in here]) * 1e3
            values = [by_run(source, over_time) for source in here]
            mean, spread = (np.array([pair[part] for pair in values]).reshape(len(here), many).T for part in (0, 1))
        else:
            along = missing.stations * 1e3
            mean, spread = (missing.heat, missing.heat_sd) if inside else (missing.flux, missing.flux_sd)
        divisor, shown = si(float(np.nanmax(np.abs(mean) + spread, initial=0.0)), unit)
        draw_zones(axes, section)
        for number, run in enumerate(missing.runs):
            shift = (number - (many - 1) / 2) * min(0.14 * spacing, 0.5 * spacing / many)
            label = f"{short(run, 24)}, up to {missing.speeds[number]:.1f} m/s"
            axes.errorbar(
                along + shift, mean[number] / divisor, spread[number] / divisor, fmt="o", ms=4.5, capsize=2.5, lw=1.1,
                color=line_style(number)["color"], label=label, zorder=3,
            )  # fmt: skip
        axes.axhline(0.0, color=INK, lw=0.7)
        low, high = axes.get_ylim()
        axes.set_ylim(low, high + 0.14 * (high - low))
        axes.set_ylabel(f"[{shown}]", fontsize=FONT)
        panel_title(axes, what, pad=4)
        axes.set_xlim(0.0, section.line.length * 1e3)
        tidy(axes)
    panels[-1].set_xlabel("place along the meridian from crown to bead, s [mm]", fontsize=FONT)
    panels[0].legend(
        fontsize=FONT - 0.5, frameon=False, ncols=min(many, 3), loc="lower right", bbox_to_anchor=(1.0, 0.99)
    )
    means = "; means over the times when a source acts" if sources else ""
    title(drawn, "Heat of unknown origin by station", f"± 1 standard deviation{means}")
    return drawn


def by_run(source: UnknownSource, over_time: HeatOverTime) -> tuple[Array, Array]:
    """(n_runs,) mean strength of a source while it acts, and its sd, from its free course; NaN where it never does.

    A source that begins or ends acts after or before its time; heat inside acts while the tyre rolls. The values over
    time are strongly correlated, so the sd is their mean.
    """
    means, spreads = [], []
    for knots, rolling, mean, sd in zip(
        over_time.knots, over_time.rolling, source.strength, source.strength_sd, strict=True
    ):
        acts = rolling.copy() if source.inside else np.ones(len(knots), dtype=bool)
        if math.isfinite(source.time) and source.kind.endswith(BEGINS):
            acts &= knots > source.time + source.time_sd
        elif math.isfinite(source.time) and source.kind == ENDS:
            acts &= knots < source.time - source.time_sd
        means.append(float(mean[acts].mean()) if acts.any() else math.nan)
        spreads.append(float(sd[acts].mean()) if acts.any() else math.nan)
    return np.array(means), np.array(spreads)


def draw_zones(axes: Axes, section: Section) -> None:
    """Shade the sidewall and the bead, with a label."""
    shoulder, end = section.line.shoulder_s * 1e3, section.line.length * 1e3
    for number, (name, start, stop) in enumerate((("crown", 0.0, shoulder), ("sidewall and bead", shoulder, end))):
        axes.axvspan(start, stop, color=FILLS[number], alpha=0.28, lw=0, zorder=0)
        axes.annotate(name, ((start + stop) / 2, 0.97), xycoords=("data", "axes fraction"), fontsize=FONT - 1,
                      color=QUIET, ha="center", va="top")  # fmt: skip
