"""Pictures of a diagnosis on the section: deviations at the sensors, and heat of unknown origin."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.result_tables import rms_table
from tyrefem.reports.diagnosis_heat import heat_course_figure
from tyrefem.reports.figures.canvas import Canvas, canvas, draw_outlines
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
    short,
    si,
    tidy,
    title,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.geometry import Section

Array = NDArray[np.float64]
DIVERGING = "RdBu_r"
#: Smallest distance of the two states of a sensor at the crown, as a share of the tyre's width.
APART = 0.032


def residual_figures(d: DiagnosisData) -> dict[str, Figure]:
    """Draw the mean deviation at every sensor: original left and amended right on a half section; on a full section,
    one picture each.
    """
    table = rms_table(d)
    places = {name: d.original.section_place(card) for name, card in d.original.sensors.items()}
    seen = [name for name in places if name in set(table["sensor"])]
    if not seen:
        return {}
    means: dict[str, dict[str, float]] = {"original": {}, "amended": {}}
    for name in seen:
        part = table[table["sensor"] == name]
        for state, column in (("original", "mean_before_K"), ("amended", "mean_after_K")):
            means[state][name] = float(np.average(part[column], weights=part["n"]))
    largest = max(1.0, *(abs(value) for state in means.values() for value in state.values()))
    section = d.original.section
    if section.half:
        return {"residual-map.png": _residuals(section, places, means, largest)}
    return {
        f"residual-map-{state}.png": _residuals(section, places, {state: values}, largest)
        for state, values in means.items()
    }


def _residuals(
    section: Section, places: dict[str, tuple[float, float]], means: dict[str, dict[str, float]], largest: float
) -> Figure:
    """Draw sensors coloured by their mean deviation; two states on the two sides of a half section."""
    left: list[tuple[Label, float]] = []
    right: list[tuple[Label, float]] = []
    for number, values in enumerate(means.values()):
        for name, value in values.items():
            x, y = (float(place) for place in millimetres(places[name]))
            if len(means) == 2:
                # Each state has one side; at the crown both states would be at the same place.
                x = (-1.0 if number == 0 else 1.0) * max(abs(x), APART / 2 * section.overall_width * 1e3)
                side = right if number else left
            else:
                side = left if x < 0 else right
            side.append((Label(f"{short(name)} {value:+z.1f} K", x, y), value))
    drawn = canvas(section, [label.text for label, _ in left], [label.text for label, _ in right], below=0.25)
    _ground(drawn)
    image: Any = None
    for side in (left, right):
        image = drawn.axes.scatter(
            [label.x for label, _ in side], [label.y for label, _ in side], c=[value for _, value in side],
            cmap=DIVERGING, vmin=-largest, vmax=largest, s=70, edgecolors=INK, linewidths=0.9, zorder=8,
        )  # fmt: skip
    drawn.beside(sorted((label for label, _ in left), key=lambda label: -label.y), -1.0)
    drawn.beside(sorted((label for label, _ in right), key=lambda label: -label.y), 1.0)
    bar = drawn.color_bar(image, "measured - computed [K]")
    bar.ax.set_ylabel("measured - computed, mean [K]", fontsize=FONT)
    names = list(means)
    if len(names) == 2:
        for name, sign in zip(names, (-1.0, 1.0), strict=True):
            drawn.axes.text(sign * drawn.width / 4, drawn.low - 0.2 * drawn.scale, name, fontsize=FONT + 1,
                            fontweight="bold", ha="center", va="center", color=INK)  # fmt: skip
    second = "mean over all runs and readings; red: the tyre is hotter than the model"
    title(drawn.figure, f"Deviation on the section: {' and '.join(names)} study", second)
    return drawn.figure


def _ground(drawn: Canvas) -> None:
    """Draw the section in one pale colour, with its outlines."""
    section = drawn.section
    for region in section.regions:
        for polygon in section.outline(region, 1e-3):
            x, y = millimetres(polygon)
            for sign in (1.0, -1.0) if section.half else (1.0,):
                drawn.axes.fill(sign * x, y, color="#eef0f2", lw=0, zorder=1)
    draw_outlines(drawn.axes, section, color=QUIET, width=0.6)
    if section.half:
        drawn.axes.axvline(0.0, color=QUIET, lw=0.6, ls=(0, (8, 2, 1.5, 2)), zorder=0)


# -- heat of unknown origin --------------------------------------------------------------------------------------------


def missing_figures(d: DiagnosisData) -> dict[str, Figure]:
    """Pictures of the missing heat: on the section, by station and run with its uncertainty, and over time."""
    drawn = {"missing-heat.png": _missing_map(d), "missing-heat-stations.png": _missing_stations(d)}
    if d.missing.over_time is not None:
        drawn["missing-heat-course.png"] = heat_course_figure(d, d.missing.over_time)
    return drawn


def _missing_map(d: DiagnosisData) -> Figure:
    """Draw heat inside, W/m3, over the thickness (left), and flux into the outer surface, W/m2, as a band (right)."""
    missing, section = d.missing, d.original.section
    drawn = canvas(section, bars=2)
    _ground(drawn)
    s = np.linspace(0.0, section.line.length, 241)
    depth = np.linspace(0.0, 1.0, 5)
    total = np.asarray(section.total_thickness(s))
    places = np.array([section.place(s, share * total) for share in depth])
    x, y = millimetres(places)
    heat, unit = _scaled(_smooth(missing.stations, missing.heat.mean(axis=0), s), "W/m³")
    limit = max(float(np.abs(heat).max()), 1e-9)
    image = drawn.axes.pcolormesh(
        -np.abs(x), y, np.broadcast_to(heat, x.shape), cmap=DIVERGING, vmin=-limit, vmax=limit, shading="gouraud",
        zorder=2, rasterized=True,
    )  # fmt: skip
    drawn.color_bar(image, f"heat inside while the tyre rolls [{unit}]", side=-1.0)
    flux, unit = _scaled(_smooth(missing.stations, missing.flux.mean(axis=0), s), "W/m²")
    limit = max(float(np.abs(flux).max()), 1e-9)
    x, y = millimetres(section.place(s, total))
    x = np.abs(x)
    further = _outwards(x, y, 0.11 * drawn.scale)
    image = drawn.axes.pcolormesh(
        np.array([x, further[0]]), np.array([y, further[1]]), np.broadcast_to(flux, (2, len(s))), cmap="PuOr_r",
        vmin=-limit, vmax=limit, shading="gouraud", zorder=4, rasterized=True,
    )  # fmt: skip
    drawn.color_bar(image, f"flux into the outer surface, always [{unit}]")
    title(drawn.figure, "Heat of unknown origin", "mean over the fitted runs; left: inside, right: through the surface")
    return drawn.figure


def _smooth(stations: Array, values: Array, s: Array) -> Array:
    """The sum of the patches along the meridian, each a bell of width 0.6 times the spacing (see the effects)."""
    width = 0.6 * float(stations[1] - stations[0])
    return np.asarray(np.exp(-(((s[:, None] - stations) / width) ** 2) / 2) @ values)


def _scaled(values: Array, unit: str) -> tuple[Array, str]:
    """Convert values to the unit whose prefix fits the largest; return them and the unit."""
    divisor, shown = si(float(np.abs(values).max()), unit)
    return values / divisor, shown


def _outwards(x: Array, y: Array, distance: float) -> tuple[Array, Array]:
    """A curve shifted outwards, away from the tyre's air space, mm."""
    dx, dy = np.gradient(x), np.gradient(y)
    length = np.hypot(dx, dy)
    return x - dy / length * distance, y + dx / length * distance


def _missing_stations(d: DiagnosisData) -> Figure:
    """Draw heat and flux of every fitted run with their standard deviations, over the meridian."""
    missing, section = d.missing, d.original.section
    drawn = figure(9.4, TITLE + 5.2)
    panels = [add_axes(drawn, 0.85, bottom, 8.3, 2.0) for bottom in (2.95, 0.5)]
    along = missing.stations * 1e3
    many = len(missing.runs)
    spacing = float(along[1] - along[0])
    for axes, mean, spread, unit, what in (
        (panels[0], missing.heat, missing.heat_sd, "W/m³", "heat inside, while the tyre rolls"),
        (panels[1], missing.flux, missing.flux_sd, "W/m²", "flux into the outer surface, always"),
    ):
        divisor, shown = si(float((np.abs(mean) + spread).max()), unit)
        _zones(axes, section)
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
        axes.set_title(what, fontsize=FONT, loc="left", pad=4)
        axes.set_xlim(0.0, section.line.length * 1e3)
        tidy(axes)
    panels[1].set_xlabel("place along the meridian from crown to bead, s [mm]", fontsize=FONT)
    panels[0].legend(
        fontsize=FONT - 0.5, frameon=False, ncols=min(many, 3), loc="lower right", bbox_to_anchor=(1.0, 0.99)
    )
    title(drawn, "Heat of unknown origin by station", "± 1 standard deviation")
    return drawn


def _zones(axes: Axes, section: Section) -> None:
    """Shade the sidewall and the bead, with a label."""
    shoulder, end = section.line.shoulder_s * 1e3, section.line.length * 1e3
    for number, (name, start, stop) in enumerate((("crown", 0.0, shoulder), ("sidewall and bead", shoulder, end))):
        axes.axvspan(start, stop, color=FILLS[number], alpha=0.28, lw=0, zorder=0)
        axes.annotate(name, ((start + stop) / 2, 0.97), xycoords=("data", "axes fraction"), fontsize=FONT - 1,
                      color=QUIET, ha="center", va="top")  # fmt: skip
