"""Plain data and arrays in one compressed file. Reading runs no code of the file: no pickle."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.output import atomic_path

Array = NDArray[Any]

#: Entry of the plain data, and suffix of a packed array.
DATA, PACKED = "data", ".packed"
#: Step to which packed numbers are rounded.
STEP = 2.0**-30
#: Differences between successive rows that are stored.
DIFFERENCES = 3


def write_arrays(path: Path, data: Mapping[str, Any], arrays: Mapping[str, Array], packed: Mapping[str, Array]) -> Path:
    """Write plain data, arrays, and arrays to be `packed` as one ``.npz`` file.

    Raises
    ------
    InputError : the file cannot be written.
    """
    entries: dict[str, Any] = {name: np.asarray(array) for name, array in arrays.items()}
    entries |= {f"{name}{PACKED}": packed_bytes(array) for name, array in packed.items()}
    text = json.dumps(data, default=_plain, separators=(",", ":"))
    entries[DATA] = np.frombuffer(text.encode("utf-8"), np.uint8)
    with atomic_path(path) as temporary, temporary.open("wb") as stream:
        np.savez_compressed(stream, **entries)
    return path


def read_arrays(path: Path) -> tuple[dict[str, Any], dict[str, Array]]:
    """The plain data and the arrays of a file of `write_arrays`.

    Raises
    ------
    InputError : the file cannot be read, is another kind of file, or is damaged.
    """
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as stored:
            data = json.loads(stored[DATA].tobytes().decode("utf-8"))
            arrays = {
                name.removesuffix(PACKED): unpacked(stored[name]) if name.endswith(PACKED) else stored[name]
                for name in stored.files
                if name != DATA
            }
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", file=path) from None
    except (ValueError, KeyError, EOFError, zipfile.BadZipFile, TypeError, AttributeError) as error:
        raise InputError("is damaged, or is no file of arrays written by tyrefem", file=path) from error
    if not isinstance(data, dict):
        raise InputError("is damaged, or is no file of arrays written by tyrefem", file=path)
    return data, arrays


def packed_bytes(values: Array) -> Array:
    """Numbers (n, m) that change smoothly over n, rounded to `STEP`, as bytes that compress well.

    Whole multiples of the step; of these the third differences over n; of these the first bytes of all, then the
    second bytes. Temperatures so take a quarter of the space.

    >>> temperatures = np.linspace(25.0, 26.0, 50)[:, None] ** 2 + np.arange(3)
    >>> float(abs(unpacked(packed_bytes(temperatures)) - temperatures).max()) <= STEP / 2
    True
    """
    values = np.asarray(values, dtype=float)
    numbers = np.rint(values / STEP).astype("<i8")
    for _ in range(DIFFERENCES):
        numbers = np.diff(numbers, axis=0, prepend=np.zeros_like(numbers[:1]))
    shape = np.array(values.shape, dtype="<i8").view(np.uint8)
    return np.concatenate([shape, np.ascontiguousarray(numbers).reshape(-1, 1).view(np.uint8).T.reshape(-1)])


def unpacked(content: Array) -> Array:
    """The numbers (n, m) of `packed_bytes`."""
    shape = tuple(int(size) for size in content[:16].copy().view("<i8"))
    numbers = np.ascontiguousarray(content[16:].reshape(8, -1).T).view("<i8").reshape(shape)
    for _ in range(DIFFERENCES):
        numbers = np.cumsum(numbers, axis=0)
    return numbers * STEP


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{value!r:.60} cannot be stored")
