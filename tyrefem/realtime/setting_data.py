"""Arrays and names of the model of all settings of a box."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.realtime.tyre import CubicTable

Array = NDArray[np.float64]


class SettingData:
    """Arrays of the model of all settings of a box, with their names.

    Parameters
    ----------
    arrays : those of `tyrefem.realtime.export.arrays_of`, and those of `tyrefem.realtime.setting_arrays`.
    about : names and numbers beside them.
    """

    def __init__(self, arrays: Mapping[str, Array], about: Mapping[str, Any]) -> None:
        self.arrays, self.about = arrays, about
        self.size, self.count = len(arrays["rates"]), len(arrays["rates"]) + len(arrays["capacity"])
        self.has_gas = len(arrays["gas"]) > 0
        self.durations: Array = arrays["durations"]
        self.lagging = np.flatnonzero(arrays["lag"] > 0)
        self.read_names: list[str] = about["read"]
        self.heat_names: list[str] = about["heat"]
        self.loss_names: list[str] = about["lost"]
        ends = np.cumsum([0, *(count for _, count in about["hot"])])
        self.hot_parts = {
            f"{name} max": slice(int(a), int(b)) for (name, _), a, b in zip(about["hot"], ends, ends[1:], strict=False)
        }
        self.films, self.heat, self.bend = (
            CubicTable(arrays[f"{name}_table"], arrays[f"{name}_axes"]) for name in ("film", "heat", "bend")
        )

    def place(self, numbers: Array) -> Array:
        """Places of numbers in the box: 0 and 1 are its ends."""
        low, high, log = self.arrays["low"], self.arrays["high"], self.arrays["log"]
        linear = (numbers - low) / (high - low)
        safe = np.where(log > 0, numbers, 1.0)
        ratio = np.log(safe / np.where(log > 0, low, 1.0)) / np.where(
            log > 0, np.log(np.where(log > 0, high / np.where(log > 0, low, 1.0), 2.0)), 1.0
        )
        return np.where(log > 0, ratio, linear)
