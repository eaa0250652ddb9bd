"""Small studies that lack something, with made-up measurements: coarse, short, three effects to choose from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import tomli_w

from tyrefem.effects import catalogue

#: Effects that the studies may lack.
RIVALS = ("hot-road", "sun", "sensor-offset")
SENSORS = {
    "crown-outer": {"s": "0.33 in", "depth": "0.63 in"},
    "shoulder-inner": {"s": "2.00 in", "depth": "0.07 in"},
}
CASES = "name,drive.load [lbf],note\nlight,2000,\nheavy,3300,as flown\n"
END = 60.0
FITTED, HELD_OUT = {"table": "a.csv"}, {"table": "b.csv", "drive": {"load": "3300 lbf"}, "hold_out": True}


def write(
    folder: Path,
    *,
    measured: Sequence[Mapping[str, Any]] = (),
    sensors: bool = True,
    cases: bool = False,
    rivals: Sequence[str] = RIVALS,
    drive: Mapping[str, Any] | None = None,
) -> Path:
    """A study's folder: ``study.toml``, a table per measured entry (readings that rise evenly), maybe ``cases.csv``."""
    data: dict[str, Any] = {
        "title": "Odd",
        "section": "nasa-22x5.5-8pr",
        "materials": {name: f"nasa-{name}" for name in ("carcass", "tread", "sidewall", "bead")},
        "drive": {
            "speed": "20 mph", "load": "2700 lbf", "pressure": "83 psi", "ambient": "25 degC", "duration": f"{END} s",
        } | dict(drive or {}),
        "mesh": {"size": "12 mm"},
        "numerics": {"tolerance": "0.5 delta_degC"},
        "output": {"fields": 2},
        "diagnosis": {"exclude": sorted(name for name in catalogue() if name not in rivals)},
    }  # fmt: skip
    if sensors:
        data["sensors"] = SENSORS
    if measured:
        data["measured"] = [dict(entry) for entry in measured]
    if cases:
        data["cases"] = "cases.csv"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "study.toml").write_text(tomli_w.dumps(data), encoding="utf-8")
    (folder / "cases.csv").write_text(CASES, encoding="utf-8")
    columns = list(SENSORS) if sensors else ["contained-air"]
    for number, entry in enumerate(measured):
        table(folder / entry["table"], columns, seed=number)
    return folder


def table(path: Path, columns: Sequence[str], *, seed: int = 0, start: float = 0.0, rate: float = 0.1) -> Path:
    """Readings every 3 s from ``start`` s on, up from 25 degC by ``rate`` K/s, with noise of 0.5 K."""
    rng = np.random.default_rng(seed)
    times = np.arange(0.0, END + 0.1, 3.0)
    readings = {f"{name} [degC]": 25.0 + rate * times + 0.5 * rng.normal(size=len(times)) for name in columns}
    pd.DataFrame({"time [s]": times + start, **readings}).to_csv(path, index=False, float_format="%.2f")
    return path
