"""Files of critical speeds: table, numbers, picture of the speeds at which waves stand."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.output import atomic_folder, write_json

if TYPE_CHECKING:
    from tyrefem.mechanics.rolling.critical_speed import CriticalSpeed

#: Files of `write_files`.
FILES = ("critical-speed.csv", "critical-speed.json", "critical-speed.png")


def write_files(results: Sequence[CriticalSpeed], folder: Path, *, pictures: bool = True) -> None:
    """``critical-speed.csv``, ``critical-speed.json``, and with pictures ``critical-speed.png``."""
    from tyrefem.output import versions

    rows = [result.row() for result in results]
    with atomic_folder(folder) as place:
        text = io.StringIO()
        writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
        (place / "critical-speed.csv").write_text(text.getvalue(), encoding="utf-8")
        waves = [
            {"kind": kind, "harmonic": n, "speed_m_s": speed, "pressure_Pa": result.pressure,
             "temperature_degC": result.temperature}
            for result in results
            for kind, standing in (("belt", result.belt), ("any", result.any_wave))
            if standing is not None
            for n, speed in standing.by_harmonic.items()
        ]  # fmt: skip
        study = results[0].study
        content = {"study": study.name, "title": study.title, "critical": rows, "waves": waves, "versions": versions()}
        write_json(content, place / "critical-speed.json")
        if pictures:
            (place / "critical-speed.png").write_bytes(picture(results))


def picture(results: Sequence[CriticalSpeed]) -> bytes:
    """PNG: speed of standing waves over their number round the wheel; the section moved by the slowest of the belt."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import PolyCollection
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4.2), layout="constrained")
    FigureCanvasAgg(figure)
    speeds, section = figure.subplots(1, 2)
    for result in results:
        label = f"{result.pressure / 1e3:.0f} kPa"
        label += "" if result.temperature is None else f", {result.temperature:.4g} °C"
        for standing, style, kind in ((result.belt, "o-", "belt"), (result.any_wave, "x--", "any")):
            if standing is not None:
                orders = list(standing.by_harmonic)
                speeds.plot(orders, list(standing.by_harmonic.values()), style, markersize=4, label=f"{label}: {kind}")
    speeds.set_xlabel("waves round the wheel")
    speeds.set_ylabel("speed at which the wave stands, m/s")
    speeds.set_ylim(bottom=0)
    speeds.grid(alpha=0.3)
    if speeds.get_legend_handles_labels()[0]:
        speeds.legend(fontsize=8)
    standing = results[0].belt or results[0].any_wave
    section.set_axis_off()
    if standing is not None:
        elements = standing.tyre.body.rings
        corners, nodes = elements.element_nodes[:, :4], standing.tyre.places
        motion = standing.wave.shape.reshape(-1, 3)
        scale = 0.12 * float(nodes[0].max() - nodes[0].min()) / float(abs(motion[:, :2]).max())
        sides = (1,) if standing.wave.symmetric is None else (1, -1)
        for side in sides:
            sign = 1.0 if side == 1 or standing.wave.symmetric else -1.0
            for moved, colour, edge in ((0.0, "0.93", "0.8"), (scale, "none", "C0")):
                z = side * (nodes[1] + moved * sign * motion[:, 1])
                r = nodes[0] + moved * sign * motion[:, 0]
                cells = [list(zip(z[cell], r[cell], strict=True)) for cell in corners]
                section.add_collection(PolyCollection(cells, facecolors=colour, edgecolors=edge, linewidths=0.5))
        section.autoscale_view()
        section.set_aspect("equal")
        section.set_title(f"{standing.harmonic} waves, {standing.speed:.1f} m/s, on the spinning tyre", fontsize=9)
    figure.suptitle(f"{results[0].study.name}: waves that stand still while the tyre turns", fontsize=10)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=130)
    return buffer.getvalue()
