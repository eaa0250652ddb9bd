"""Files of a calibration: JSON, and one picture of reliability and ranks."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.diagnose.layout.conformal import CALIBRATION
from tyrefem.output import atomic_path, write_json
from tyrefem.reports.figures.style import FONT, PALETTE, QUIET, TITLE, add_axes, figure, png, tidy, title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.diagnose.layout.calibration import Calibration, RankTest, Reliability

PICTURE = "calibration.png"
#: Files that `save` writes.
FILES = (CALIBRATION, PICTURE)


def save(calibration: Calibration, folder: Path) -> None:
    """Write ``calibration.json`` and ``calibration.png``, each completely or not at all.

    Raises
    ------
    InputError : the folder cannot be written.
    """
    write_json(calibration.to_dict(), folder / CALIBRATION)
    with atomic_path(folder / PICTURE) as temporary:
        temporary.write_bytes(png(picture(calibration)))


def picture(calibration: Calibration) -> Figure:
    """Draw the reliability of probabilities, and the ranks of true values in their posteriors, with 95 % intervals."""
    drawn = figure(10.6, TITLE + 3.7)
    _reliability(
        add_axes(drawn, 0.7, 0.6, 3.0, 2.8),
        [("most probable set", calibration.best_sets), ("single effects", calibration.effects)],
    )
    parts = [("amplitudes", calibration.amplitudes), ("base numbers, sensors", calibration.base_numbers)]
    for number, (name, ranks) in enumerate(parts):
        _ranks(add_axes(drawn, 4.5 + 3.2 * number, 0.6, 2.6, 2.8), name, ranks)
    facts = (
        f"{len(calibration.cases)} {calibration.kind} drawn from the priors, seed {calibration.seed}; intervals of 95 %"
    )
    title(drawn, f"Calibration of {calibration.study}", facts)
    return drawn


def _reliability(axes: Any, parts: list[tuple[str, Reliability]]) -> None:
    axes.plot([0, 1], [0, 1], color=QUIET, lw=0.8, ls="--")
    for color, (name, reliability) in zip(PALETTE, parts, strict=False):
        for each in reliability.bins:
            axes.plot([each.stated] * 2, each.true.interval, color=color, lw=2.2, alpha=0.5)
        places = [each.stated for each in reliability.bins]
        axes.plot(places, [each.true.share for each in reliability.bins], "o", ms=4.5, color=color, label=name)
    axes.set_xlim(-0.02, 1.02)
    axes.set_ylim(-0.02, 1.02)
    axes.set_xlabel("stated probability [-]", fontsize=FONT)
    axes.set_ylabel("observed frequency [-]", fontsize=FONT)
    axes.legend(fontsize=FONT - 1, frameon=False, loc="lower right")
    tidy(axes)


def _ranks(axes: Any, name: str, ranks: RankTest) -> None:
    from scipy.stats import binom

    count, bins = sum(ranks.counts), len(ranks.counts)
    low, high = binom.ppf([0.025, 0.975], count, 1 / bins)
    axes.axhspan(low, high, color=QUIET, alpha=0.2, lw=0)
    axes.bar([(number + 0.5) / bins for number in range(bins)], ranks.counts, width=0.9 / bins, color=PALETTE[0])
    axes.set_xlim(0, 1)
    axes.set_xlabel(f"{name}: share of the posterior\nbelow the true value [-], p = {ranks.p_value:.2g}", fontsize=FONT)
    axes.set_ylabel("number of cases [-]", fontsize=FONT)
    tidy(axes)
