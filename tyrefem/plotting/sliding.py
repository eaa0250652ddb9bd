"""Contact temperatures over time, one panel per phase with slip."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.plotting.style import FONT, INK, PALETTE, QUIET, TITLE, add_axes, figure, plain, tidy, title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.sliding.outcome import SlidingOutcome

#: Panels in a row, and their size with what is around them, inches.
ACROSS, WIDE, HIGH, LEFT, BELOW = 3, 2.5, 2.1, 0.7, 0.5
#: Width that the title and the legend need, inches.
NARROWEST = 6.4
CURVES = (
    ("exit_edge_degC", "exit edge of the contact", PALETTE[1], "-", 1.8),
    ("tread_mean_degC", "mean tread surface", PALETTE[0], "-", 1.8),
    ("half_space_degC", "half-space under a locked wheel", INK, ":", 1.4),
)


def sliding_figure(outcome: SlidingOutcome) -> Figure:
    """Exit edge, mean tread surface and (locked) half-space, °C, in every phase; friction in the panels' titles."""
    count = len(outcome.phases)
    across, down = min(count, ACROSS), -(-count // ACROSS)
    wide = max(WIDE, (NARROWEST - 0.3) / across - LEFT)
    cell_w, cell_h = wide + LEFT, HIGH + BELOW + 0.3
    drawn = figure(across * cell_w + 0.3, down * cell_h + TITLE + 0.3)
    title(drawn, outcome.title, "contact with the road in phases with slip")
    limit = outcome.decomposition_temperature
    for number, phase in enumerate(outcome.phases):
        row, place = divmod(number, ACROSS)
        axes = add_axes(drawn, LEFT + place * cell_w, 0.3 + BELOW + (down - 1 - row) * cell_h, wide, HIGH)
        seen = outcome.series[outcome.series.phase == phase.name]
        time = seen.time_s - phase.start
        for name, label, color, dashes, width in CURVES:
            if seen[name].notna().any():
                axes.plot(time, seen[name], label=label, color=color, ls=dashes, lw=width)
        if phase.capped:
            axes.axhline(limit, color=QUIET, lw=0.8, ls="--")
            axes.annotate(
                "decomposition", (0.98, limit), xycoords=("axes fraction", "data"), fontsize=FONT - 2, color=QUIET,
                ha="right", va="bottom",
            )  # fmt: skip
        friction = f"{phase.friction:.2f}" + (f" → {phase.friction_lowest:.2f}" if phase.capped else "")
        axes.set_title(plain(f"{phase.name}: friction {friction}"), fontsize=FONT, color=INK)
        axes.set_xlabel("time in the phase [s]", fontsize=FONT)
        if place == 0:
            axes.set_ylabel("temperature [°C]", fontsize=FONT)
        tidy(axes)
    shown = {label: line for axes in drawn.axes for line, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    drawn.legend(shown.values(), shown.keys(), loc="lower center", ncols=3, fontsize=FONT - 1, frameon=False)
    return drawn
