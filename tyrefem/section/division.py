"""Names along the meridian: which region or boundary a place belongs to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.errors import InputError


@dataclass(frozen=True)
class Division:
    """The meridian cut into named parts, from the crown to the bead.

    Parameters
    ----------
    names : one per part.
    ends : where each part ends, rising [m]; the last is the end of the section.

    Raises
    ------
    InputError : a part that ends before it begins, and so never appears.

    >>> outer = Division(("tread", "sidewall"), (0.05, 0.15))
    >>> outer.at([0.02, 0.05, -0.1]).tolist()
    ['tread', 'tread', 'sidewall']
    """

    names: tuple[str, ...]
    ends: tuple[float, ...]

    def __post_init__(self) -> None:
        start = 0.0
        for name, end in zip(self.names, self.ends, strict=True):
            if not end > start + 1e-9:
                raise InputError(
                    f"'{name}' never appears: it begins at s = {start:g} m, where the part before it ends, and ends at"
                    f" {end:g} m; parts follow each other from crown to bead and cannot overlap"
                )
            start = end

    def at(self, s: ArrayLike) -> NDArray[np.str_]:
        """The name at ``s`` (any shape, either side); a border belongs to the part nearer the crown."""
        s = np.abs(np.asarray(s, dtype=float))
        return np.asarray(self.names)[np.searchsorted(np.asarray(self.ends[:-1]) + 1e-12, s)]

    def cut(self, start: float, end: float, name: str) -> Division:
        """The same with what lies between two stations under another name.

        Raises
        ------
        InputError : the stretch is not all within one part.

        >>> Division(("tread",), (0.1,)).cut(0.02, 0.03, "groove").parts()
        [('tread', 0.0, 0.02), ('groove', 0.02, 0.03), ('tread', 0.03, 0.1)]
        """
        pieces: list[tuple[str, float]] = []
        begin, found = 0.0, False
        for part, stop in zip(self.names, self.ends, strict=True):
            if begin - 1e-9 <= start and end < stop - 1e-9:
                found = True
                pieces += [(part, start)] if start > begin + 1e-9 else []
                pieces.append((name, end))
            pieces.append((part, stop))
            begin = stop
        if not found:
            raise InputError(f"'{name}' from {start:.4g} to {end:.4g} m does not lie within one part of it")
        return Division(tuple(part for part, _ in pieces), tuple(stop for _, stop in pieces))

    def parts(self) -> list[tuple[str, float, float]]:
        """(name, start, end) of each part, neighbours of the same name joined."""
        parts: list[tuple[str, float, float]] = []
        start = 0.0
        for name, end in zip(self.names, self.ends, strict=True):
            if parts and parts[-1][0] == name:
                parts[-1] = (name, parts[-1][1], end)
            else:
                parts.append((name, start, end))
            start = end
        return parts
