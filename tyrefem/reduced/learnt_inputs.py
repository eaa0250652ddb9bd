"""What the reduced model needs to know of a variant, as functions of the varied numbers: no study is made for it.

Conductivities, capacities, films, sinks, strain energies at the sample nodes, tables of tan delta and the answers that
need no temperature are sums or products of functions of one number (`reduced.separated`).
"""

from __future__ import annotations

import functools
import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.reduced.separated import RELATIVE, Separated
from tyrefem.variants.varied import Varied

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LearntInputs(Brief):
    """Inputs of the variants of a box.

    Parameters
    ----------
    varied : the numbers of the box. shapes : input -> its shape. entries : inputs, or the entries of small ones, as
        functions of points of the unit box.
    """

    varied: tuple[Varied, ...]
    shapes: Mapping[str, tuple[int, ...]]
    entries: Separated

    def _title(self) -> str:
        return f"of {len(self.varied)} numbers"

    def _facts(self) -> Mapping[str, Any]:
        return self.entries._facts()

    @functools.cached_property
    def digest(self) -> str:
        """Digest of the box and of all values in its middle."""
        middle = self.at(np.full((1, len(self.varied)), 0.5))
        parts = [repr(self.varied).encode(), *(name.encode() + array.tobytes() for name, array in middle.items())]
        return hashlib.sha256(b" ".join(parts)).hexdigest()[:16]

    def place(self, changes: Mapping[str, Any]) -> Array | None:
        """The point of the unit box of a variant's changes; None: outside, or not of these numbers alone."""
        place, known = np.empty(len(self.varied)), 0
        for n, number in enumerate(self.varied):
            value = changes.get(number.key)
            if value is None:
                return None
            if len(number.keys) > 1 and any(changes.get(key) != v for key, v in number.changes(value).items()):
                return None
            known += len(number.keys)
            try:
                place[n] = number.place_of(value)
            except InputError:
                return None
        inside = bool(((place >= -RELATIVE) & (place <= 1 + RELATIVE)).all())
        return place if inside and known == len(changes) else None

    def at(self, places: Array) -> dict[str, Array]:
        """Input -> (B, *shape) values at points (B, d) of the unit box."""
        entries = self.entries(places)
        return {
            name: entries[name]
            if name in entries
            else np.stack([entries[each] for each in entry_names(name, shape)], axis=1).reshape(len(places), *shape)
            if math.prod(shape)
            else np.zeros((len(places), *shape))
            for name, shape in self.shapes.items()
        }


def entry_names(name: str, shape: tuple[int, ...]) -> list[str]:
    """Names of the entries of an input of a shape.

    >>> entry_names("films 0", (2,))
    ['films 0 0', 'films 0 1']
    """
    return [f"{name} {n}" for n in range(math.prod(shape))]
