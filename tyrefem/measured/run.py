"""One measured run: the histories of its sensors with common times."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class MeasuredRun:
    """Temperatures of all sensors in one run.

    Parameters
    ----------
    name : of the run: its ``run`` cell, else the file's name without suffix.
    times : (n,) s, strictly increasing.
    temperatures : (n, sensors) degC, one column per sensor; NaN = no reading.
    file : the source, None for data made in memory.
    comments : comment and preamble lines of the file, without their marks.
    channels : headings of columns with other quantities than temperatures (speed, pressure), which are left out.
    """

    name: str
    times: NDArray[np.float64]
    temperatures: pd.DataFrame
    file: Path | None = None
    comments: tuple[str, ...] = ()
    channels: tuple[str, ...] = ()

    @property
    def sensors(self) -> tuple[str, ...]:
        """Names of the sensors, in the order of the columns."""
        return tuple(map(str, self.temperatures.columns))

    def shifted(self, seconds: float) -> MeasuredRun:
        """The same run with ``seconds`` added to its times."""
        return replace(self, times=self.times + seconds) if seconds else self

    def renamed(self, names: Mapping[str, str]) -> MeasuredRun:
        """The same run with renamed columns: column -> sensor. Names without a column are ignored.

        Raises
        ------
        InputError : two columns with the same name.
        """
        new = [names.get(sensor, sensor) for sensor in self.sensors]
        twice = next((name for name in new if new.count(name) > 1), None)
        if twice is not None:
            raise InputError(f"run '{self.name}': two columns for sensor '{twice}'", field="rename", file=self.file)
        return replace(self, temperatures=self.temperatures.set_axis(new, axis="columns"))

    def write(self, path: str | Path) -> Path:
        """Write as a table that `read_table` reads back, to the last bit.

        >>> import pandas as pd, tempfile
        >>> from tyrefem.measured import read_table
        >>> run = MeasuredRun("heat", np.array([0.0, 0.1]), pd.DataFrame({"crown": [25.0, np.nan]}))
        >>> file = run.write(tempfile.mkdtemp() + "/heat.csv")
        >>> print(file.read_text().strip())
        time [s],crown [degC]
        0.0,25.0
        0.1,
        >>> read_table(file)[0].times.tolist()
        [0.0, 0.1]
        """
        from tyrefem.output import atomic_path

        table = self.temperatures.rename(columns=lambda name: f"{name} [degC]")
        table = table.reset_index(drop=True)
        table.insert(0, "time [s]", self.times)
        with atomic_path(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as stream:
            stream.writelines(f"# {comment}\n" for comment in self.comments)
            table.to_csv(stream, index=False, lineterminator="\n")
        return Path(path)
