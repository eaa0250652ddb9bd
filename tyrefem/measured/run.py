"""One measured run: the histories of its sensors with common times."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.measured.heading import parts

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
    notes : how content beyond the plain form was read, such as times in h:mm:ss.
    """

    name: str
    times: NDArray[np.float64]
    temperatures: pd.DataFrame
    file: Path | None = None
    comments: tuple[str, ...] = ()
    channels: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

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

    def without(self, names: Iterable[str]) -> MeasuredRun:
        """The same run without some columns, of sensors or other quantities; others are not needed."""
        left_out = set(names)
        kept = [sensor for sensor in self.sensors if sensor not in left_out]
        channels = tuple(text for text in self.channels if not {text, parts(text)[0]} & left_out)
        return replace(self, temperatures=self.temperatures[kept], channels=channels)

    def joined(self, other: MeasuredRun) -> MeasuredRun:
        """This run with the sensors of another logger, at the times of both; they have no sensor in common.

        >>> import pandas as pd
        >>> first = MeasuredRun("heat", np.array([0.0, 2.0]), pd.DataFrame({"crown": [25.0, 26.0]}))
        >>> both = first.joined(MeasuredRun("heat", np.array([1.0, 2.0]), pd.DataFrame({"bead": [20.0, 21.0]})))
        >>> both.times.tolist(), both.temperatures["bead"].tolist()
        ([0.0, 1.0, 2.0], [nan, 20.0, 21.0])
        """
        import pandas as pd

        times = np.union1d(self.times, other.times)
        sides = [run.temperatures.set_axis(run.times, axis="index").reindex(times) for run in (self, other)]
        return replace(
            self,
            times=times,
            temperatures=pd.concat(sides, axis="columns").reset_index(drop=True),
            file=self.file if self.file == other.file else None,
            comments=(*self.comments, *other.comments),
            channels=tuple(dict.fromkeys((*self.channels, *other.channels))),
            notes=tuple(dict.fromkeys((*self.notes, *other.notes))),
        )

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
