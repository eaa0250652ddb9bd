"""A ``.vtu`` file for ParaView: compressed, and quick where arrays repeat themselves.

The XML file format of VTK, raw appended data in blocks by zlib. Points and cells are compressed once for all times
of a run. Equal blocks are compressed once: the values of a ring repeat from segment to segment.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.output import atomic_path

Array = NDArray[Any]

#: Name of a cell -> its number in VTK.
KINDS = {
    "triangle": 5, "quad": 9, "hexahedron": 12, "wedge": 13, "triangle6": 22, "quad9": 28,
}  # fmt: skip
#: Kind and size of a number -> its name in VTK.
_TYPES = {"f4": "Float32", "f8": "Float64", "i4": "Int32", "i8": "Int64", "u1": "UInt8", "u4": "UInt32"}
#: Bytes of a block, unless an array repeats itself. zlib's level: higher ones take longer and gain nothing.
BLOCK, LEVEL = 1 << 16, 1


class VtuFile:
    """Points and cells of one kind, with data that change from file to file.

    Parameters
    ----------
    points : (n, 3) m. cells : (m, nodes of a cell), numbers of points. cell : a name of `KINDS`.
    parts : the values at points and in cells repeat themselves so many times, e.g. round a ring.
    """

    def __init__(self, points: Array, cells: Array, cell: str, parts: int = 1) -> None:
        self.parts = parts
        self.n_points, (self.n_cells, size) = len(points), cells.shape
        ends = np.arange(size, size * (self.n_cells + 1), size, dtype=np.int32)
        kinds = np.full(self.n_cells, KINDS[cell], dtype=np.uint8)
        self._points = _entry("Points", points)
        self._cells = [
            _entry("connectivity", cells.astype(np.int32)), _entry("offsets", ends), _entry("types", kinds),
        ]  # fmt: skip
        self._kept: dict[str, tuple[Array, tuple[str, bytes]]] = {}

    def write(
        self,
        path: Path,
        point_data: Mapping[str, Array] | None = None,
        cell_data: Mapping[str, Array] | None = None,
        names: Mapping[str, Sequence[str]] | None = None,
        time: float | None = None,
    ) -> Path:
        """Write a file, completely or not at all.

        Parameters
        ----------
        point_data, cell_data : name -> (n,) or (n, 3). time : s.
        names : array -> names of its numbers from 1; a comment of the file, not an array: not all readers know words.

        Raises
        ------
        InputError : the file cannot be written.
        """
        at_points = [self._values(name, values) for name, values in (point_data or {}).items()]
        in_cells = [self._values(name, values) for name, values in (cell_data or {}).items()]
        groups = [
            ("PointData", at_points), ("CellData", in_cells), ("Points", [self._points]), ("Cells", self._cells),
        ]  # fmt: skip
        fields = ""
        if time is not None:
            fields = (
                f'<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{time!r}</DataArray>'
            )
        offset, body, content = 0, [], []
        for group, arrays in groups:
            body.append(f"<{group}>")
            for header, data in arrays:
                body.append(f'<DataArray {header} format="appended" offset="{offset}"/>')
                content.append(data)
                offset += len(data)
            body.append(f"</{group}>")
        head = (
            f'<?xml version="1.0"?>\n{_words(names or {})}<VTKFile type="UnstructuredGrid" version="0.1" '
            'byte_order="LittleEndian" '
            'header_type="UInt32" compressor="vtkZLibDataCompressor">\n<UnstructuredGrid>\n'
            f"<FieldData>{fields}</FieldData>\n"
            f'<Piece NumberOfPoints="{self.n_points}" NumberOfCells="{self.n_cells}">\n'
        )
        foot = '\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding="raw">\n_'
        with atomic_path(path) as temporary, temporary.open("wb") as stream:
            stream.write((head + "\n".join(body) + foot).encode("utf-8"))
            stream.writelines(content)
            stream.write(b"\n</AppendedData>\n</VTKFile>\n")
        return path

    def _values(self, name: str, values: Array) -> tuple[str, bytes]:
        """An array's entry; an array that was in the file before is not compressed again."""
        known = self._kept.get(name)
        if known is None or known[0] is not values:
            known = self._kept[name] = values, _entry(name, values, self.parts)
        return known[1]


def _entry(name: str, values: Array, parts: int = 1) -> tuple[str, bytes]:
    """Attributes of an array's element, and its compressed data."""
    little = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
    components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 and name != "connectivity" else ""
    header = f'type="{_TYPES[little.dtype.str[1:]]}" Name="{escape(name)}"{components}'
    return header, compressed(little.tobytes(), little.nbytes // parts if parts > 1 else BLOCK)


def compressed(data: bytes, block: int) -> bytes:
    """Data as VTK reads them: number and lengths of the blocks, then the blocks.

    >>> compressed(b"abab", 2) == compressed(b"abab", 2)
    True
    """
    if not data:
        return np.zeros(1, dtype="<u4").tobytes()
    known: dict[bytes, bytes] = {}
    blocks = []
    for start in range(0, len(data), block):
        part = data[start : start + block]
        if part not in known:
            known = {part: zlib.compress(part, LEVEL)}
        blocks.append(known[part])
    lengths = [len(blocks), block, len(data) % block, *map(len, blocks)]
    return np.array(lengths, dtype="<u4").tobytes() + b"".join(blocks)


def _words(names: Mapping[str, Sequence[str]]) -> str:
    """The names of numbers as a comment."""
    rows = [
        f"  {array} {number} = {comment(name)}\n"
        for array, words in names.items()
        for number, name in enumerate(words, start=1)
    ]
    return f"<!--\n{''.join(rows)}-->\n" if rows else ""


def comment(text: str) -> str:
    """A text for a comment of XML, which may hold neither markup nor two hyphens in a row.

    >>> comment("a -- b <c>")
    'a - - b &lt;c&gt;'
    """
    return re.sub(r"-(?=-)|-$", "- ", escape(text, quote=False))
