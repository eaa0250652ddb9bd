"""Files of natural modes: tables, and the moved section at the angle of its greatest motion."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.output import atomic_folder, jsonable
from tyrefem.reports.figures.style import plain, without_latex

if TYPE_CHECKING:
    from tyrefem.mechanics.footprint.natural_frequencies import NaturalFrequencies

#: Files of `write_files`.
FILES = ("modes.csv", "modes.json", "modes.png")
#: Largest displacement in the picture, over the section's height.
DRAWN = 0.15
#: Sections of a row, and of the picture.
COLUMNS, MOST = 4, 12


def write_files(result: NaturalFrequencies, folder: Path, *, pictures: bool = True) -> None:
    """``modes.csv``, ``modes.json``, and with pictures ``modes.png``."""
    with atomic_folder(folder) as temporary:
        result.table.to_csv(temporary / "modes.csv", index=False, lineterminator="\n")
        text = json.dumps(jsonable(result.summary()), indent=1, ensure_ascii=False, allow_nan=False)
        (temporary / "modes.json").write_text(text + "\n", encoding="utf-8")
        if pictures:
            (temporary / "modes.png").write_bytes(picture(result))


def picture(result: NaturalFrequencies) -> bytes:
    """PNG: the lowest modes, each as the moved section over the inflated one; colour: circumferential displacement over
    the largest displacement."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import PolyCollection
    from matplotlib.figure import Figure

    elements = result.vibration.harmonics.elements
    nodes, corners = elements.nodes, elements.element_nodes[:, :4]
    drawn = sorted(result.modes, key=lambda natural: natural.mode.frequency)[:MOST]
    rows = -(-len(drawn) // COLUMNS)
    without_latex()
    figure = Figure(figsize=(3 * COLUMNS, 2.3 * rows + 0.6), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    for axes in grid:
        axes.set_axis_off()
    image = None
    for axes, natural in zip(grid, drawn, strict=False):
        radial, lateral, around = natural.mode.shape.reshape(-1, 3).T
        largest = float(np.sqrt(radial**2 + lateral**2 + around**2).max())
        factor = DRAWN * float(np.ptp(nodes[0])) / largest
        sides = [(1.0, 1.0)]
        if natural.mode.symmetric is not None:
            sides.append((-1.0, 1.0 if natural.mode.symmetric else -1.0))
        for side, sign in sides:
            z, r = side * nodes[1], nodes[0]
            moved_z = z + factor * sign * side * lateral
            moved_r = r + factor * sign * radial
            inflated = np.stack([z, r], axis=-1)[corners]
            axes.add_collection(PolyCollection(list(inflated), facecolors="0.93", edgecolors="0.85", linewidths=0.3))
            moved = np.stack([moved_z, moved_r], axis=-1)[corners]
            image = PolyCollection(
                list(moved), array=sign * around[corners].mean(axis=1) / largest,
                cmap="coolwarm", edgecolors="0.3", linewidths=0.2,
            )  # fmt: skip
            image.set_clim(-1, 1)
            axes.add_collection(image)
        axes.autoscale_view()
        axes.set_aspect("equal")
        axes.set_title(natural.label, fontsize=9)
    if image is not None:
        bar = figure.colorbar(image, ax=grid.tolist(), shrink=0.6)
        bar.set_label("circumferential over largest displacement", fontsize=8)
    words = f"rim held, {result.tyre.pressure / 1e3:.0f} kPa, unloaded"
    figure.suptitle(f"{plain(result.study.name)}: {words}", fontsize=10)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=130)
    return buffer.getvalue()
