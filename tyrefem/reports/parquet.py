"""Tables as Parquet files, with the unit of every column in its metadata."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.output import atomic_path

if TYPE_CHECKING:
    import pandas as pd

#: Units that end the name of a column, after the last "_".
UNITS = {"s": "s", "m": "m", "degC": "degC", "J": "J", "W": "W", "Pa": "Pa", "N": "N", "K": "K"}


def unit_of(column: str, table: pd.DataFrame) -> str:
    """Unit of a column: from ``table.attrs["units"]``, or from its name; empty: none.

    >>> import pandas as pd
    >>> unit_of("energy_J", pd.DataFrame()), unit_of("region", pd.DataFrame())
    ('J', '')
    """
    stated: dict[str, str] = table.attrs.get("units", {})
    return stated.get(column) or UNITS.get(column.rpartition("_")[2] if "_" in column else "", "")


def write_parquet(table: pd.DataFrame, path: Path) -> Path:
    """Write a table; ``pyarrow.parquet.read_schema(path).field(column).metadata[b"unit"]`` is a column's unit.

    Raises
    ------
    InputError : the file cannot be written.
    """
    import pyarrow
    from pyarrow import parquet

    content = pyarrow.Table.from_pandas(table, preserve_index=False)
    columns = [
        field.with_metadata({"unit": unit}) if (unit := unit_of(field.name, table)) else field
        for field in content.schema
    ]
    content = content.cast(pyarrow.schema(columns, metadata=content.schema.metadata))
    with atomic_path(path) as temporary:
        parquet.write_table(content, temporary, compression="zstd")
    return path
