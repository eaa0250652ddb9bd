"""What is in an output file: its numbers and names by key, for `record_numbers.py`.

A number is taken as it is. An array (a column, a field) is count, sum, Euclidean norm, least, greatest and first
moment. Times, dates, versions, paths and sentences are left out.
"""

from __future__ import annotations

import json
import math
import re
import tomllib
import xml.etree.ElementTree as ElementTree
import zipfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

#: A number, a name, or an array's summary.
Leaf = float | int | str | dict[str, float]
Entry = dict[str, Leaf]

#: Keys of files that differ from run to run or from machine to machine.
LEFT_OUT = {
    *("versions", "wall_time", "wall_time_s", "seconds", "taken_up", "written", "date", "tool", "guid", "checksums"),
    *("files_read", "command"),
}
#: Keys that hold sentences. Sentences elsewhere are left out because they have blanks.
SENTENCES = {"title", "notes", "source", "summary", "words", "warnings", "reasons", "description", "sentence"}
LONGEST_LIST = 12
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.]*[A-Za-z_])")


def array_summary(values: Any, unit: float = 0.0) -> dict[str, float]:
    """Count, missing values, sum, norm, least, greatest and first moment; ``unit``: of the last digit printed."""
    import numpy as np

    array = np.asarray(values, dtype=float).ravel()
    finite = array[np.isfinite(array)]
    summary = {"count": float(array.size), "missing": float(array.size - finite.size)}
    if finite.size:
        places = np.arange(1, finite.size + 1) / finite.size
        summary |= {
            "sum": math.fsum(finite),
            "norm": math.sqrt(math.fsum(finite**2)),
            "min": float(finite.min()),
            "max": float(finite.max()),
            "moment": math.fsum(places * finite),
        }
    return summary | ({"unit": unit} if unit else {})


def last_digit(text: str) -> float:
    """The unit of the last digit of a printed number.

    >>> last_digit("79.5578"), last_digit("146828"), last_digit("-2.70e-18")
    (0.0001, 1.0, 1e-20)
    """
    mantissa, _, power = text.lower().partition("e")
    return float(f"1e{int(power or 0) - len(mantissa.partition('.')[2])}")


def leaves(data: Any, key: str = "", *, blanks: bool = False) -> Iterator[tuple[str, Leaf]]:
    """Numbers and names of plain data by dotted key; ``blanks``: text with blanks too, as in a study file."""
    if isinstance(data, Mapping):
        for name, value in data.items():
            if name not in LEFT_OUT and name not in SENTENCES:
                yield from leaves(value, f"{key}.{name}" if key else str(name), blanks=blanks)
    elif isinstance(data, list | tuple):
        yield from _list_leaves(list(data), key, blanks=blanks)
    elif isinstance(data, bool | int | float):
        yield key, float(data) if isinstance(data, float) else int(data)
    elif data is None:
        yield key, "none"
    elif isinstance(data, str) and "/" not in data and "\\" not in data and (blanks or " " not in data):
        yield key, data


def _list_leaves(data: list[Any], key: str, *, blanks: bool) -> Iterator[tuple[str, Leaf]]:
    flat = list(_flattened(data))
    if len(flat) > LONGEST_LIST and all(isinstance(value, int | float) for value in flat):
        yield key, array_summary(flat)
        return
    names = [value.get("name") if isinstance(value, Mapping) else None for value in data]
    named = all(isinstance(name, str) for name in names) and len(set(names)) == len(names)
    for place, value in enumerate(data):
        yield from leaves(value, f"{key}[{names[place] if named else place}]", blanks=blanks)


def _flattened(data: Any) -> Iterator[Any]:
    if isinstance(data, list | tuple):
        for value in data:
            yield from _flattened(value)
    else:
        yield data


def read_json(path: Path) -> Iterator[tuple[str, Leaf]]:
    """Every number and name of a JSON file."""
    yield from leaves(json.loads(path.read_text(encoding="utf-8")))


def read_toml(path: Path) -> Iterator[tuple[str, Leaf]]:
    """Every number, name and quantity of a study file."""
    yield from leaves(tomllib.loads(path.read_text(encoding="utf-8")), blanks=True)


def read_csv(path: Path) -> Iterator[tuple[str, Leaf]]:
    """Every column of a table: numbers summarised, names joined."""
    import pandas as pd

    table = pd.read_csv(path, dtype=str, comment="#", keep_default_na=False)
    for name in table.columns:
        yield from _column(str(name), list(table[name]))


def _column(name: str, cells: list[str]) -> Iterator[tuple[str, Leaf]]:
    filled = [cell for cell in cells if cell]
    if filled and all(NUMBER.fullmatch(cell) or cell in ("inf", "-inf", "nan") for cell in filled):
        unit = max((last_digit(cell) for cell in filled if NUMBER.fullmatch(cell)), default=0.0)
        yield name, array_summary([float(cell or "nan") for cell in cells], unit)
    elif filled and not any(" " in cell or "/" in cell for cell in filled):
        yield name, "|".join(cells)


def read_parquet(path: Path) -> Iterator[tuple[str, Leaf]]:
    """Every column of a table, to full precision."""
    import pandas as pd

    table = pd.read_parquet(path)
    for name in table.columns:
        column = table[name]
        if pd.api.types.is_numeric_dtype(column):
            yield str(name), array_summary(column)
        elif not any(" " in str(cell) or "/" in str(cell) for cell in column):
            yield str(name), "|".join(str(cell) for cell in column)


def read_mesh(path: Path) -> Iterator[tuple[str, Leaf]]:
    """Points, cells and every field of a VTK file."""
    import meshio
    import numpy as np

    mesh = meshio.read(path)
    yield "points", array_summary(mesh.points)
    for number, block in enumerate(mesh.cells):
        yield f"cells {number} {block.type}", array_summary(block.data)
    for name, values in mesh.point_data.items():
        yield f"point data {name}", array_summary(values)
    for name, blocks in mesh.cell_data.items():
        yield f"cell data {name}", array_summary(np.concatenate([np.ravel(block) for block in blocks]))


def read_npz(path: Path) -> Iterator[tuple[str, Leaf]]:
    """Every array of a result or a real-time model, and the numbers of its data, JSON as text or as bytes."""
    import numpy as np

    with np.load(path, allow_pickle=False) as arrays:
        for name, values in arrays.items():
            if name == "data" and values.dtype == np.uint8:
                yield from leaves(json.loads(values.tobytes()), name)
            elif values.dtype.kind in "fiub":
                yield name, array_summary(values)
            elif values.dtype.kind == "U" and values.ndim == 0 and values.item()[:1] in "{[":
                yield from leaves(json.loads(values.item()), name)
            elif values.dtype.kind == "U" and not any("/" in text for text in np.ravel(values)):
                yield name, "|".join(np.ravel(values))


def read_fmu(path: Path) -> Iterator[tuple[str, Leaf]]:
    """Variables of a co-simulation unit, its description and the arrays in its C source."""
    with zipfile.ZipFile(path) as archive:
        for variable in ElementTree.fromstring(archive.read("modelDescription.xml")).iter("ScalarVariable"):
            name = variable.get("name")
            for item in [variable, *variable]:
                for key, value in item.attrib.items():
                    if key not in ("name", "description"):
                        yield f"{name}.{key}", float(value) if NUMBER.fullmatch(value) else value
        for name in archive.namelist():
            if name.startswith("resources/") and name.endswith(".json"):
                yield from leaves(json.loads(archive.read(name)), name)
            elif name.endswith(".h"):
                yield from _c_arrays(archive.read(name).decode())


def _c_arrays(source: str) -> Iterator[tuple[str, Leaf]]:
    for name, values in re.findall(r"(\w+)\s*(?:\[[^=]*\])+\s*=\s*\{([^;]*)\};", source):
        yield f"C {name}", array_summary([float(number) for number in NUMBER.findall(values)])
    for name, value in re.findall(r"^#define (\w+) \(?([-+.\deE]+)\)?$", source, re.MULTILINE):
        yield f"C {name}", float(value)


READERS: dict[str, Callable[[Path], Iterator[tuple[str, Leaf]]]] = {
    ".json": read_json,
    ".toml": read_toml,
    ".csv": read_csv,
    ".parquet": read_parquet,
    ".vtu": read_mesh,
    ".npz": read_npz,
    ".fmu": read_fmu,
}


def printed(text: str) -> Iterator[tuple[str, Leaf]]:
    """What a command printed: its JSON, or the numbers of every line."""
    if text[:1] in "{[":
        yield from leaves(json.loads(text), "printed")
        return
    for number, line in enumerate(text.splitlines(), 1):
        numbers = NUMBER.findall(line)
        if numbers:
            yield f"line {number}", array_summary([float(value) for value in numbers], max(map(last_digit, numbers)))
