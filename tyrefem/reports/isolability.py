"""Picture of an isolability: how well each effect is distinguished from every candidate."""

from __future__ import annotations

import io

import numpy as np

from tyrefem.diagnose.layout.isolability import MARGIN, Isolability
from tyrefem.reports.figures.style import plain, without_latex


def picture(isolability: Isolability) -> bytes:
    """PNG: lead, nats, of each effect at its usual strength over each candidate; variants of a swap are left out."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import BoundaryNorm
    from matplotlib.figure import Figure

    kept = [i for i, candidate in enumerate(isolability.candidates) if candidate.name != "swapped-channels"]
    names = [plain(isolability.candidates[i].key) for i in kept]
    values = isolability.separation[np.ix_(kept, kept)].copy()
    np.fill_diagonal(values, np.nan)
    size = 2.6 + 0.19 * len(names)
    without_latex()
    figure = Figure(figsize=(size + 1.2, size), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    levels = [-20.0, 0.0, MARGIN / 2, MARGIN, 30.0, 100.0, 1e6]
    image = axes.imshow(values, cmap="RdYlBu", norm=BoundaryNorm(levels, 256))
    axes.set_xticks(range(len(names)), names, rotation=90, fontsize=6)
    axes.set_yticks(range(len(names)), names, fontsize=6)
    axes.set_xlabel("fitted candidate", fontsize=8)
    axes.set_ylabel("hidden effect, at its usual strength", fontsize=8)
    words = f"lead of the hidden effect over a candidate (above {MARGIN:g} nats: distinguished)"
    axes.set_title(f"{plain(isolability.study)}: {words}", fontsize=9)
    bar = figure.colorbar(image, ax=axes, shrink=0.7, ticks=levels[:-1])
    bar.set_label("lead, nats", fontsize=8)
    bar.ax.tick_params(labelsize=7)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=150)
    return buffer.getvalue()
