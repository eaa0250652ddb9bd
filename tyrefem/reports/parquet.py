"""Tables as Parquet files, with the unit of every column in its metadata."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.output import atomic_path
from tyrefem.output.key_units import unit_of

if TYPE_CHECKING:
    import pandas as pd


def column_unit(column: str, table: pd.DataFrame) -> str:
    """Unit of a column: from ``table.attrs["units"]``, or from its name; empty: none, or a factor.

    >>> import pandas as pd
    >>> [column_unit(name, pd.DataFrame()) for name in ("sliding_speed_m_s", "region", "drive.speed [mph]", "soft [x]")]
    ['m/s', '', 'mph', '']
    """
    stated: dict[str, str] = table.attrs.get("units", {})
    in_heading = re.fullmatch(r".* \[([^\[\]]+)\]", column)
    if column not in stated and in_heading is not None:
        return "" if in_heading[1] == "x" else in_heading[1]
    return stated.get(column) or unit_of(column)


def with_units(schema: Any, table: pd.DataFrame) -> Any:
    """The schema of a table's Parquet file with the unit of each column in its metadata."""
    import pyarrow

    columns = [
        field.with_metadata({"unit": unit}) if (unit := column_unit(field.name, table)) else field for field in schema
    ]
    return pyarrow.schema(columns, metadata=schema.metadata)


def write_parquet(table: pd.DataFrame, path: Path) -> Path:
    """Write a table; ``pyarrow.parquet.read_schema(path).field(column).metadata[b"unit"]`` is a column's unit.

    Raises
    ------
    InputError : the file cannot be written.
    """
    import pyarrow
    from pyarrow import parquet

    content = pyarrow.Table.from_pandas(table, preserve_index=False)
    content = content.cast(with_units(content.schema, table))
    with atomic_path(path) as temporary:
        parquet.write_table(content, temporary, compression="zstd")
    return path
