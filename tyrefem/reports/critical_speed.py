"""Files of critical speeds: table, numbers, picture of the speeds at which waves stand."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.output import atomic_folder, write_json

if TYPE_CHECKING:
    from tyrefem.mechanics.rolling.amplification import Amplification
    from tyrefem.mechanics.rolling.critical_speed import CriticalSpeed

#: Files of `write_files`.
FILES = ("critical-speed.csv", "critical-speed.json", "critical-speed.png", "rise.csv", "rise.png")


def write_files(
    results: Sequence[CriticalSpeed], folder: Path, *, rises: Sequence[Amplification] = (), pictures: bool = True
) -> None:
    """``critical-speed.csv``, ``critical-speed.json``, and with pictures ``critical-speed.png``.

    With ``rises`` also ``rise.csv`` and ``rise.png``.
    """
    from tyrefem.output import versions

    rows = [result.row() for result in results]
    with atomic_folder(folder) as place:
        (place / "critical-speed.csv").write_text(_table(rows), encoding="utf-8")
        waves = [
            {"kind": kind, "harmonic": n, "speed_m_s": speed, "pressure_Pa": result.pressure,
             "temperature_degC": result.temperature}
            for result in results
            for kind, standing in (("belt", result.belt), ("any", result.any_wave))
            if standing is not None
            for n, speed in standing.by_harmonic.items()
        ]  # fmt: skip
        study = results[0].study
        content: dict[str, Any] = {
            "study": study.name,
            "title": study.title,
            "critical": rows,
            "waves": waves,
            "versions": versions(),
            **plugin_summary(study),
        }
        if rises:
            (place / "rise.csv").write_text(_table([row for rise in rises for row in rise.rows()]), encoding="utf-8")
            content["rises"] = [rise.summary() for rise in rises]
        write_json(content, place / "critical-speed.json")
        if pictures:
            from tyrefem.reports.figures.critical_speed import critical_speed_figure
            from tyrefem.reports.figures.style import png

            (place / "critical-speed.png").write_bytes(png(critical_speed_figure(results)))
            if rises:
                from tyrefem.reports.figures.rise import rise_figure

                (place / "rise.png").write_bytes(png(rise_figure(rises)))


def _table(rows: Sequence[Mapping[str, Any]]) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()
