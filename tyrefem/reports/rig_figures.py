"""Pictures of the rig: readings and residuals, intervals, correlations, the heated patch, the layer study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.heating_test.selection import COVERAGE
from tyrefem.heating_test.verdict import name_in_words
from tyrefem.reports.figures.phases import draw_phases, make_room
from tyrefem.reports.figures.style import (
    FONT,
    INK,
    PALETTE,
    QUIET,
    TITLE,
    add_axes,
    figure,
    line_style,
    plain,
    png,
    short,
    temperature_map,
    tidy,
    title,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.heating_test.card import HeatingPhases, RigCard
    from tyrefem.heating_test.grid import PatchGrid
    from tyrefem.heating_test.identification import IdentificationData
    from tyrefem.heating_test.layer_study import LayerStudy
    from tyrefem.heating_test.noise import Block

Array = NDArray[Any]


def pictures(identification: IdentificationData) -> dict[str, bytes]:
    """File name -> PNG: ``residuals-RUN``, ``intervals``, ``correlation``."""
    drawn = {}
    for test in identification.tests:
        drawn[f"residuals-{test.name}.png"] = png(residuals(identification, test.name))
    drawn["intervals.png"] = png(intervals(identification))
    drawn["correlation.png"] = png(correlation(identification))
    return drawn


def bands(phases: HeatingPhases) -> list[tuple[str, float, float]]:
    """The phases, min, for shading."""
    ends = np.cumsum([0.0, phases.idle, phases.heating, phases.cooling]) / 60
    named = zip(("idle", "heating", "cooling"), ends, ends[1:], strict=False)
    return [(name, float(a), float(b)) for name, a, b in named if b > a]


def residuals(identification: IdentificationData, run: str) -> Figure:
    """Draw readings, computed line and residuals of every sensor in one test."""
    blocks = [block for block in identification.fit.blocks if block.series.test == run]
    columns = len(blocks)
    width = 3.3 * columns + 0.3
    drawn = figure(width, 5.0 + TITLE)
    power = identification.card.runs[run].power
    title(
        drawn,
        f"Run {run}: {power:g} W",
        "points: measured; line: computed; below: measured - computed; grey: expected 95 % band",
    )
    for number, block in enumerate(blocks):
        left = 0.6 + 3.3 * number
        high, low = add_axes(drawn, left, 2.35, 2.6, 2.45), add_axes(drawn, left, 0.5, 2.6, 1.6)
        _histories(identification, block, high, low)
        if number == 0:
            high.set_ylabel("temperature [°C]", fontsize=FONT)
            low.set_ylabel("residual [K]", fontsize=FONT)
    return drawn


def _histories(identification: IdentificationData, block: Block, high: Axes, low: Axes) -> None:
    series, noise = block.series, identification.fit.noise
    t = series.times / 60
    shown = bands(identification.card.phases)
    for axes in (high, low):
        tidy(axes)
        axes.set_xlim(0, shown[-1][2])
    high.plot(t, series.readings, ".", ms=2.5, color=PALETTE[1])
    high.plot(t, block.computed, color=PALETTE[0], lw=1.3)
    rms = float(np.sqrt(np.mean(block.residual**2)))
    high.set_title(f"{short(series.sensor, 18)}: rms {rms:.2f} K", fontsize=FONT, color=INK, loc="left")
    high.set_xticklabels([])
    make_room(high, shown)
    draw_phases(high, shown)
    draw_phases(low, shown, names=False)
    sd = np.sqrt(noise.reading[series.sensor] ** 2 / series.counts + (noise.model[series.sensor] * block.rise) ** 2)
    low.fill_between(t, -1.96 * sd, 1.96 * sd, color="#dddddd", lw=0)
    low.plot(t, block.residual, ".", ms=2.5, color=PALETTE[1])
    low.axhline(0, color=INK, lw=0.7)
    low.set_xlabel("time [min]", fontsize=FONT)


def references(card: RigCard) -> str:
    """Text on the layers' reference temperatures."""
    return "at " + ", ".join(f"{layer.reference_temperature:g} °C ({layer.name})" for layer in card.layers)


def intervals(identification: IdentificationData) -> Figure:
    """Draw prior and identified value of every property with 95 % intervals, relative to the identified value."""
    shown = identification.properties
    drawn = figure(8.2, 0.42 * len(shown) + 0.95 + TITLE)
    title(drawn, "Identified properties", f"{references(identification.card)}; 95 % intervals; grey: prior")
    axes = add_axes(drawn, 2.3, 0.55, 3.4, 0.42 * len(shown) + 0.3)
    for row, estimate in enumerate(shown):
        spread = np.log1p(estimate.prior_sd / estimate.prior_value) * COVERAGE
        guess = estimate.prior_value / estimate.value
        axes.plot(guess * np.exp([-spread, spread]), [row + 0.16] * 2, color="#bbbbbb", lw=5, solid_capstyle="butt")
        axes.plot(guess, row + 0.16, "|", color=QUIET, ms=9)
        color = PALETTE[0] if estimate.verdict == "determined" else PALETTE[1]
        axes.plot(
            [estimate.low / estimate.value, estimate.high / estimate.value],
            [row - 0.14] * 2,
            color=color,
            lw=3,
            solid_capstyle="butt",
        )
        axes.plot(1.0, row - 0.14, "o", color=color, ms=5)
        axes.text(
            1.03, row,
            f"{estimate.value:.4g} {estimate.unit} ± {COVERAGE * (estimate.relative_sd or 0):.1%}\n{estimate.verdict}",
            fontsize=FONT - 0.5, color=color, va="center", transform=axes.get_yaxis_transform(),
        )  # fmt: skip
    axes.set_yticks(range(len(shown)), [plain(name_in_words(estimate.name)) for estimate in shown])
    axes.set_ylim(len(shown) - 0.4, -0.6)
    axes.set_xscale("log")
    ticks = [0.25, 0.5, 0.7, 1.0, 1.4, 2.0, 4.0]
    low, high = axes.get_xlim()
    kept = [tick for tick in ticks if low <= tick <= high]
    axes.set_xticks(kept, [f"{tick:g}" for tick in kept])
    axes.minorticks_off()
    axes.set_xlabel("relative to the identified value", fontsize=FONT)
    tidy(axes)
    axes.grid(visible=False, axis="y")
    return drawn


def correlation(identification: IdentificationData) -> Figure:
    """Draw the correlation of every pair of free parameters; strong ones with their number."""
    n = len(identification.estimates)
    size = 0.36 * n
    drawn = figure(size + 3.6, size + 2.6)
    title(drawn, "Correlation of the parameters", "posterior; properties first")
    axes = add_axes(drawn, 2.4, 1.75, size, size)
    image = axes.imshow(identification.correlation, cmap="RdBu_r", vmin=-1, vmax=1)
    names = [plain(name_in_words(estimate.name)) for estimate in identification.estimates]
    axes.set_xticks(range(n), names, rotation=60, ha="right", rotation_mode="anchor", fontsize=FONT - 1)
    axes.set_yticks(range(n), names, fontsize=FONT - 1)
    for i in range(n):
        for j in range(n):
            r = identification.correlation[i, j]
            if i != j and abs(r) >= 0.3:
                color = "white" if abs(r) > 0.65 else INK
                axes.text(
                    j,
                    i,
                    _correlated(r),
                    ha="center",
                    va="center",
                    fontsize=6.5,
                    color=color,
                )
    bar = drawn.colorbar(image, cax=add_axes(drawn, size + 2.55, 1.75, 0.14, size))
    bar.ax.tick_params(labelsize=FONT)
    return drawn


def _correlated(r: float) -> str:
    """Format a correlation without its leading 0; as 1 only if it is 1.

    >>> _correlated(0.97), _correlated(-0.42), _correlated(0.9996)
    ('.97', '-.4', '.9996')
    """
    for decimals in range(1, 6):
        text = f"{r:.{decimals}f}"
        if abs(float(text)) < 1:
            return text.replace("0.", ".")
    return f"{r:.0f}"


def histories(
    phases: HeatingPhases, runs: Mapping[str, tuple[Array, Array]], sensors: Sequence[str], powers: Mapping[str, float]
) -> Figure:
    """Draw simulated readings of every run, one panel per sensor; runs: name -> (times, (times, sensors))."""
    drawn = figure(3.4 * len(sensors) + 0.3, 3.3 + TITLE)
    title(drawn, "Simulated test", "; ".join(f"{name} {powers[name]:g} W" for name in runs))
    for number, sensor in enumerate(sensors):
        axes = add_axes(drawn, 0.6 + 3.4 * number, 0.5, 2.65, 2.5)
        tidy(axes)
        for place, (name, (times, values)) in enumerate(runs.items()):
            axes.plot(times / 60, values[:, number], lw=1.4, label=short(name, 16), **line_style(place))
        axes.set_title(short(sensor, 24), fontsize=FONT, color=INK, loc="left")
        axes.set_xlabel("time [min]", fontsize=FONT)
        axes.set_xlim(0, phases.end / 60)
        make_room(axes, bands(phases))
        draw_phases(axes, bands(phases))
        if number == 0:
            axes.set_ylabel("temperature [°C]", fontsize=FONT)
            axes.legend(fontsize=FONT - 1, frameon=False, loc="center right")
    return drawn


def heated_patch(grid: PatchGrid, temperatures: Array, borders: Sequence[float], words: str) -> Figure:
    """Draw the temperature in a cut through the beam's axis; the laser is above."""
    reach = float(grid.along[-1])
    s = np.concatenate([[0.0], np.linspace(0.0, 1.0, 160)[1:] ** 1.3 * reach])
    d = np.linspace(0.0, float(grid.depths[-1]), 70)
    T = (grid.at(*(a.ravel() for a in np.meshgrid(s, d))) @ temperatures).reshape(d.size, s.size)
    width = 7.4
    high = max(1.3, width * float(grid.depths[-1]) / (2 * reach) * 1.6)
    drawn = figure(width + 1.9, high + 0.7 + TITLE)
    title(drawn, "Heated patch at the end of heating", words)
    axes = add_axes(drawn, 0.75, 0.6, width, high)
    whole = np.concatenate([-s[:0:-1], s]) * 1e3
    field = np.concatenate([T[:, :0:-1], T], axis=1)
    levels = np.linspace(float(T.min()), float(T.max()), 40)
    image = axes.contourf(whole, d * 1e3, field, levels, cmap=temperature_map())
    for depth in np.cumsum(borders)[:-1]:
        axes.axhline(1e3 * float(depth), color="white", lw=0.8, ls="--")
    axes.set_ylim(float(grid.depths[-1]) * 1e3, 0.0)
    axes.set_xlabel("distance along the face from the beam [mm]", fontsize=FONT)
    axes.set_ylabel("depth [mm]", fontsize=FONT)
    axes.tick_params(labelsize=FONT, colors=INK)
    bar = drawn.colorbar(image, cax=add_axes(drawn, width + 0.95, 0.6, 0.14, high), format="%.0f")
    bar.set_label("°C", fontsize=FONT)
    bar.ax.tick_params(labelsize=FONT)
    return drawn


def layers_figure(done: LayerStudy) -> Figure:
    """Draw the rms residual, transient and steady, over the number of layers, and residuals of the strongest run."""
    table = done.table()
    sensors = list(dict.fromkeys(block.series.sensor for block in done.fits[0].fit.blocks))
    drawn = figure(4.2 + 3.1 * len(sensors), 3.3 + TITLE)
    title(
        drawn,
        "Number of layers of the model",
        "left: misfit without noise; right: measured - computed of the run of highest power, mean of 7 readings",
    )
    axes = add_axes(drawn, 0.65, 0.5, 3.0, 2.6)
    for key, words, color in (
        ("transient_misfit_K", "transient", PALETTE[1]),
        ("steady_misfit_K", "later", PALETTE[0]),
    ):
        axes.plot(table["layers"], table[key], "o-", color=color, label=words)
    axes.set_xticks(table["layers"])
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("layers", fontsize=FONT)
    axes.set_ylabel("misfit [K]", fontsize=FONT)
    tidy(axes)
    axes.legend(fontsize=FONT, frameon=False)
    powers = {test.name: test.run.power for test in done.fits[0].tests}
    strongest = max(powers, key=lambda name: powers[name])
    for number, sensor in enumerate(sensors):
        panel = add_axes(drawn, 4.35 + 3.1 * number, 0.5, 2.55, 2.6)
        for place, (count, identification) in enumerate(zip(done.counts, done.fits, strict=True)):
            block = next(
                b for b in identification.fit.blocks if (b.series.test, b.series.sensor) == (strongest, sensor)
            )
            t, r = (np.convolve(v, np.ones(7) / 7, mode="valid") for v in (block.series.times / 60, block.residual))
            panel.plot(t, r, color=PALETTE[place % len(PALETTE)], lw=1.2, label=f"{count}")
        panel.axhline(0, color=INK, lw=0.6)
        panel.set_title(short(sensor, 22), fontsize=FONT, loc="left", color=INK)
        panel.set_xlabel("time [min]", fontsize=FONT)
        tidy(panel)
        if number == 0:
            panel.set_ylabel("measured - computed [K]", fontsize=FONT)
            handles, counts = panel.get_legend_handles_labels()
            labels = [f"{count} layer{'s' if count != '1' else ''}" for count in counts]
            drawn.legend(handles, labels, loc="upper right", ncols=len(labels), fontsize=FONT - 0.5, frameon=False)
    return drawn
