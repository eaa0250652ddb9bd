"""A measured table as a pandas DataFrame, with the same columns, checks and errors as a file."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.errors import InputError
from tyrefem.measured.heading import in_brackets, is_time, parts
from tyrefem.measured.lines import decode, is_comment, split
from tyrefem.measured.names import in_table_words
from tyrefem.measured.sheet import Sheet
from tyrefem.measured.table import TableLines

if TYPE_CHECKING:
    import pandas as pd

#: Name of the frame in errors. Line numbers are those of the frame written as CSV.
PLACE = Path("DataFrame (line 1: its column names)")
#: Timestamps as they are written, with the offset from UTC, if any: clocks that are put back repeat an hour.
STAMP = "%Y-%m-%dT%H:%M:%S.%f%z"


def is_frame(table: object) -> bool:
    """True for a pandas DataFrame."""
    return hasattr(table, "to_csv") and hasattr(table, "columns")


def frame_lines(frame: pd.DataFrame, rename: Mapping[str, str] | None = None) -> TableLines:
    """The rows of a frame with the columns of a file: ``time [s]`` (or the index so named), perhaps ``run``, sensors.

    Without such a column an index of timestamps or elapsed times (timedelta) is the time, whatever its name.
    A result's `readings` have this form. A frame without a column ``run`` is one run, "measured".
    ``rename``: column -> name, for columns of times and runs that are called otherwise.

    >>> import pandas as pd
    >>> frame = pd.DataFrame({"time [min]": [0, 1, 2], "crown [degF]": [77.0, None, 95.0]})
    >>> run, = frame_lines(frame).read().runs
    >>> run.name, run.times.tolist(), run.temperatures["crown"].tolist()
    ('measured', [0.0, 60.0, 120.0], [25.0, nan, 35.0])
    """
    with tempfile.TemporaryDirectory(prefix="tyrefem-") as folder:
        # It is read like a file, so that a frame and a file follow the same rules.
        file = Path(folder) / "measured.csv"
        flat = _without_comments(_flat(frame, rename or {}))
        flat.to_csv(file, index=False, lineterminator="\n", date_format=STAMP)
        try:
            lines = split(decode(file), file, rename)
        except InputError as error:
            raise InputError(error.message, field=error.field, file=PLACE) from None
    sheet = Sheet(lines, PLACE, file.stem, in_memory=True)
    return TableLines((sheet,), PLACE, file.stem, in_memory=True)


def _flat(frame: pd.DataFrame, rename: Mapping[str, str]) -> pd.DataFrame:
    """The frame with time or run from its index as a column; a result's `readings` get their units."""
    if frame.columns.nlevels > 1:
        raise InputError("its columns have several levels; wanted: one name each, like 'crown [degC]'", file=PLACE)
    timed = any(_is_time(name, rename) for name in frame.columns)
    if not timed and frame.index.nlevels == 1 and not _is_time(frame.index.name, rename) and _kind(frame.index) in "mM":
        # pandas forgets the name of an index that is computed with.
        frame = frame.rename_axis("time")
    levels = {name: level for level, name in enumerate(frame.index.names) if _is_needed(name, rename, timed=timed)}
    # `set_index(..., drop=False)` keeps the column beside the index.
    missing = [level for name, level in levels.items() if name not in frame.columns]
    flat = _in_seconds(frame.reset_index(missing) if missing else frame, rename)
    if "time_s" not in flat.columns:
        return flat
    return flat.rename(columns=lambda name: "time [s]" if name == "time_s" else _in_degC(str(name)))


def _without_comments(frame: pd.DataFrame) -> pd.DataFrame:
    """The frame with its first column last if that has texts which would make comments of their rows, as run "#1"."""
    first = [str(frame.columns[0]), *frame.iloc[:, 0].astype(str)] if len(frame.columns) else []
    return frame.iloc[:, [*range(1, len(frame.columns)), 0]] if any(map(is_comment, first)) else frame


def _in_seconds(frame: pd.DataFrame, rename: Mapping[str, str]) -> pd.DataFrame:
    """The frame with elapsed times of pandas (timedelta) as numbers in seconds."""
    elapsed = [
        place for place, name in enumerate(frame.columns)
        if _kind(frame.iloc[:, place]) == "m" and _is_time(name, rename)
    ]  # fmt: skip
    if not elapsed:
        return frame
    named, frame = list(frame.columns), frame.copy()
    for place in elapsed:
        frame.isetitem(place, frame.iloc[:, place].dt.total_seconds())
        named[place] = f"{parts(named[place])[0]} [s]"
    return frame.set_axis(named, axis=1)


def _kind(values: pd.Index | pd.Series) -> str:
    """The letter of a kind of numbers: m of elapsed times, M of timestamps."""
    return str(getattr(values.dtype, "kind", "O"))


def _is_time(name: object, rename: Mapping[str, str]) -> bool:
    """Whether a column or a level of the index is a time, in any language that a table may have."""
    if not isinstance(name, str):
        return False
    named = in_table_words(name, rename)
    return named == "time_s" or is_time(named) or is_time(named, in_other_words=True)


def _is_needed(name: object, rename: Mapping[str, str], *, timed: bool) -> bool:
    """Whether a level of the index is a time or the run; ``timed``: a column is a time."""
    if not isinstance(name, str):
        return False
    named = in_table_words(name, rename)
    return named == "time_s" or is_time(named) or named.lower() == "run" or (not timed and _is_time(name, rename))


def _in_degC(name: str) -> str:
    """The heading, with its unit, of a column of `Result.readings`, which has none."""
    return name if in_brackets(name)[1] or name.lower() == "run" else f"{name} [degC]"
