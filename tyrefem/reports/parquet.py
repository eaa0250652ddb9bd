"""Tables as Parquet files, with the unit of every column in its metadata."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.output import atomic_path
from tyrefem.output.key_units import unit_of

if TYPE_CHECKING:
    import pandas as pd


def column_unit(column: str, table: pd.DataFrame) -> str:
    """Unit of a column: from ``table.attrs["units"]``, or from its name; empty: none.

    >>> import pandas as pd
    >>> column_unit("sliding_speed_m_s", pd.DataFrame()), column_unit("region", pd.DataFrame())
    ('m/s', '')
    """
    stated: dict[str, str] = table.attrs.get("units", {})
    return stated.get(column) or unit_of(column)


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
        field.with_metadata({"unit": unit}) if (unit := column_unit(field.name, table)) else field
        for field in content.schema
    ]
    content = content.cast(pyarrow.schema(columns, metadata=content.schema.metadata))
    with atomic_path(path) as temporary:
        parquet.write_table(content, temporary, compression="zstd")
    return path
