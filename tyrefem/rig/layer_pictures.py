"""The layer study drawn: rms over the number of layers, and residuals after the laser is switched."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tyrefem.plotting.style import FONT, INK, PALETTE, TITLE, add_axes, figure, short, tidy, title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.rig.layer_study import LayerStudy


def layers_figure(done: LayerStudy) -> Figure:
    """Left: rms residual, transient and steady, over the layers of the model; right: residuals of the strongest run."""
    table = done.table()
    sensors = list(dict.fromkeys(block.series.sensor for block in done.fits[0].fit.blocks))
    drawn = figure(4.2 + 3.1 * len(sensors), 3.3 + TITLE)
    title(
        drawn,
        "Layers of the model",
        "left: misfit, noise taken out; right: measured - computed of the strongest run, mean of 7",
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
        for place, (count, found) in enumerate(zip(done.counts, done.fits, strict=True)):
            block = next(b for b in found.fit.blocks if (b.series.test, b.series.sensor) == (strongest, sensor))
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
