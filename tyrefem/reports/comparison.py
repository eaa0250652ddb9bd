"""Files of a comparison: tables, pictures of histories and deviations, and one self-contained HTML page."""

from __future__ import annotations

import io
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.compare.history import ALL
from tyrefem.compare.stored import CURVES, RECORD, RESIDUALS, TABLE, curves_table
from tyrefem.output import atomic_folder
from tyrefem.reports.figures.phases import Phase, draw_phases, make_room
from tyrefem.reports.figures.style import without_latex
from tyrefem.reports.template import embedded, rendered
from tyrefem.reports.words import history_files

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tyrefem.compare.comparison import ComparisonData

COMPUTED, MEASURED, BEYOND = "#1f5a96", "#d1600a", "#a4161a"


#: Largest number of points drawn per panel (the tables hold all).
MOST_POINTS = 400


#: Largest number of columns that are legible on a page.
MOST_COLUMNS = 15


def pictures(comparison: ComparisonData) -> dict[str, bytes]:
    """File name -> PNG: ``deviations.png``, then ``histories-<run>.png`` for each run."""
    runs = list(comparison.residuals["run"].unique())
    drawn = {file: _png(histories(comparison, run)) for file, run in zip(history_files(runs), runs, strict=True)}
    return {"deviations.png": _png(deviations(comparison)), **drawn}


def histories(comparison: ComparisonData, run: str) -> Figure:
    """One panel per sensor: measured points, the computed line, and a band of k u_val of a reading around it."""
    from matplotlib.figure import Figure

    residuals = comparison.residuals[comparison.residuals["run"] == run]
    sensors = list(residuals["sensor"].unique())
    columns = min(3, len(sensors))
    rows = math.ceil(len(sensors) / columns)
    # Margins in inches are computed here: a layout engine takes longer than the drawing.
    width, height = max(3.6 * columns, 5.0) + 0.6, 2.5 * rows + 1.2
    edges = {"left": 0.65 / width, "right": 1 - 0.1 / width, "bottom": 0.8 / height, "top": 1 - 0.65 / height}
    without_latex()
    figure = Figure(figsize=(width, height))
    grid = figure.subplots(
        rows, columns, sharex=True, sharey=True, squeeze=False, gridspec_kw={**edges, "hspace": 0.2, "wspace": 0.04}
    )
    divisor, unit = (60.0, "min") if residuals["time_s"].max() > 600.0 else (1.0, "s")
    axes = list(grid.flat)
    for panel, sensor in zip(axes, sensors, strict=False):
        part = residuals[residuals["sensor"] == sensor]
        _history(panel, part, comparison, run, sensor, divisor)
    for panel in axes[len(sensors) :]:
        panel.set_axis_off()
    phases = _phases(residuals, divisor)
    make_room(axes[0], phases)
    for panel in axes[: len(sensors)]:
        draw_phases(panel, phases, shaded=False)
    for column in range(columns):
        lowest = axes[max(i for i in range(len(sensors)) if i % columns == column)]
        lowest.set_xlabel(f"time [{unit}]")
        lowest.tick_params(labelbottom=True)
    for line in grid:
        line[0].set_ylabel("temperature [°C]")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=3, frameon=False, fontsize=9)
    figure.suptitle(f"{_plain(comparison.study)}: run {_plain(run)}", fontsize=11, y=1 - 0.1 / height, va="top")
    return figure


def _phases(residuals: pd.DataFrame, divisor: float) -> list[Phase]:
    """Start and end of the readings of every phase of a run; a reading at a border is of the phase that ends there."""
    spans = residuals.groupby("phase", sort=False)["time_s"].agg(["min", "max"]).sort_values("min") / divisor
    starts = [float(spans["min"].min()), *spans["max"].iloc[:-1]]
    return [
        (str(name), float(start), float(end))
        for name, start, end in zip(spans.index, starts, spans["max"], strict=True)
    ]


def _history(
    panel: Axes, part: pd.DataFrame, comparison: ComparisonData, run: str, sensor: str, divisor: float
) -> None:
    times = part["time_s"].to_numpy() / divisor
    computed = part["computed_degC"].to_numpy()
    band = comparison.k * part["u_val_K"].to_numpy()
    label = f"computed ± {comparison.k:g} u_val of a reading"
    panel.fill_between(times, computed - band, computed + band, color=COMPUTED, alpha=0.2, lw=0, label=label)
    curve = comparison.curves[run]
    panel.plot(curve["time_s"] / divisor, curve[sensor], color=COMPUTED, lw=1.4, label="computed")
    step = max(1, math.ceil(len(times) / MOST_POINTS))
    shown = slice(None, None, step)
    panel.plot(
        times[shown], part["measured_degC"].to_numpy()[shown], ".", color=MEASURED, ms=4, label="measured", zorder=3
    )
    row = _rows(comparison, run, sensor, ALL).iloc[0]
    color = BEYOND if row["beyond"] else "black"
    verdict = "beyond" if row["beyond"] else "within"
    panel.set_title(
        f"{_plain(sensor)}: {row['bias_K']:+z.2f} K, rms {row['rms_K']:.2f} K, {verdict}", fontsize=9, color=color
    )
    panel.grid(alpha=0.25, lw=0.5)


def deviations(comparison: ComparisonData) -> Figure:
    """Draw a map with sensors as rows, runs and phases as columns; colour and upper number: mean, lower number: rms.

    Phases are left out if every run has only one, or if they would make the map wider than a page.
    """
    from matplotlib.figure import Figure

    table = comparison.table
    if not comparison.has_phases or len(table[["run", "phase"]].drop_duplicates()) > MOST_COLUMNS:
        table = table[table["phase"] == ALL]
    sensors = list(table["sensor"].unique())
    columns = list(table[["run", "phase"]].drop_duplicates().itertuples(index=False, name=None))
    bias = np.full((len(sensors), len(columns)), np.nan)
    width, height = 0.85 * len(columns) + 3.0, 0.42 * len(sensors) + 2.0
    without_latex()
    figure = Figure(figsize=(max(width, 7.0), height), layout="constrained")
    axes = figure.subplots()
    # Noise alone must not get strong colours: full colour is at least k u_val.
    largest = max(float(table["bias_K"].abs().max()), comparison.k * float(table["u_val_K"].max()), 1.0)
    for cell in table.to_dict(orient="records"):
        i, j = sensors.index(cell["sensor"]), columns.index((cell["run"], cell["phase"]))
        bias[i, j] = cell["bias_K"]
        _cell(axes, j, i, cell, dark=abs(cell["bias_K"]) > 0.6 * largest)
    image = axes.imshow(bias, cmap="RdBu_r", vmin=-largest, vmax=largest, aspect="auto")
    for j in range(1, len(columns)):
        if columns[j][0] != columns[j - 1][0]:
            axes.axvline(j - 0.5, color="white", lw=5, zorder=1)
    axes.set_yticks(range(len(sensors)), [_plain(sensor) for sensor in sensors], fontsize=9)
    names = [f"{_plain(run)}\n{_plain(phase)}" for run, phase in columns]
    axes.set_xticks(
        range(len(columns)), names, fontsize=8, rotation=90 if len(columns) > MOST_COLUMNS else 30, ha="right"
    )
    boxed = "boxed =" if table["beyond"].any() else "none is"
    axes.set_title(
        f"computed - measured: mean (rms) in K; {boxed} beyond {comparison.k:g} u_val", fontsize=10, loc="left"
    )
    figure.colorbar(image, ax=axes, label="mean deviation [K]", fraction=0.05)
    return figure


def _cell(axes: Axes, column: int, row: int, cell: Any, *, dark: bool) -> None:
    from matplotlib.patches import Rectangle

    axes.text(
        column, row, f"{cell['bias_K']:+z.1f}\n({cell['rms_K']:.1f})", ha="center", va="center", fontsize=7.5,
        color="white" if dark else "black", fontweight="bold" if cell["beyond"] else "normal",
    )  # fmt: skip
    if cell["beyond"]:
        axes.add_patch(Rectangle((column - 0.44, row - 0.44), 0.88, 0.88, fill=False, edgecolor="black", lw=1.4))


def _rows(comparison: ComparisonData, run: str, sensor: str, phase: str) -> pd.DataFrame:
    table = comparison.table
    return table[(table["run"] == run) & (table["sensor"] == sensor) & (table["phase"] == phase)]


def _plain(text: object) -> str:
    """Escape dollar signs, which would start a formula."""
    return str(text).replace("$", r"\$")


def _png(figure: Figure) -> bytes:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    stream = io.BytesIO()
    figure.set_dpi(110)
    FigureCanvasAgg(figure).print_png(stream)
    return stream.getvalue()


#: Files that `save` may write.
FILES = (TABLE, RESIDUALS, CURVES, RECORD, "comparison.html", "histories-*.png", "deviations.png")


def save(comparison: ComparisonData, folder: str | Path) -> Path:
    """Write tables, pictures and a self-contained page into a folder; return the page's path.

    ``comparison.csv``, ``residuals.csv``, ``curves.csv``, ``comparison.json``, ``histories-<run>.png``,
    ``deviations.png``, ``comparison.html``. Each file is written completely or not at all; `tyrefem.load` gives the
    comparison back.

    Raises
    ------
    InputError : the folder cannot be written.
    """
    folder = Path(folder)
    with atomic_folder(folder) as temporary:
        tables = {TABLE: comparison.table, RESIDUALS: comparison.residuals, CURVES: curves_table(comparison)}
        for name, table in tables.items():
            table.to_csv(temporary / name, index=False, lineterminator="\n")
        text = json.dumps(comparison.to_dict(), indent=1, ensure_ascii=False, allow_nan=False)
        (temporary / RECORD).write_text(text + "\n", encoding="utf-8")
        drawn = pictures(comparison)
        for name, picture in drawn.items():
            (temporary / name).write_bytes(picture)
        (temporary / "comparison.html").write_text(page(comparison, drawn), encoding="utf-8")
    return folder / "comparison.html"


def page(comparison: ComparisonData, images: Mapping[str, bytes]) -> str:
    """The page's HTML; ``images``: file name -> PNG, from `tyrefem.reports.comparison.pictures`."""
    records = comparison.table.to_dict(orient="records")
    whole = [record for record in records if record["phase"] == ALL]
    spreads = dict(zip(comparison.inputs["key"], comparison.inputs["sd"], strict=True))
    regions = {
        key: ", ".join(names.split(", ")[1:])
        for key, names in zip(comparison.inputs["key"], comparison.inputs["regions"], strict=True)
    }
    return rendered(
        "comparison.html",
        comparison=comparison,
        whole=whole,
        records=records,
        spreads=spreads,
        regions=regions,
        pictures=embedded(images),
    )
