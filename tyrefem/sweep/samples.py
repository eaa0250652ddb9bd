"""Which variants: grids, Latin hypercubes, Sobol sequences, lists from CSV."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.sweep.varied import Varied

Array = NDArray[np.float64]
#: More variants than this from one grid are a slip of the pen.
MOST = 1_000_000


def grid(varied: Sequence[Varied]) -> list[dict[str, Any]]:
    """Every combination of the levels, the last name running fastest.

    >>> grid([Varied("a", values=(1, 2)), Varied("b", values=("x",))])
    [{'a': 1, 'b': 'x'}, {'a': 2, 'b': 'x'}]
    """
    count = math.prod(len(one.grid) for one in varied)
    if count > MOST:
        raise InputError(f"the grid has {count:,} variants; allowed: {MOST:,}. Use fewer levels, or a Sobol sequence")
    names = [one.key for one in varied]
    return [dict(zip(names, values, strict=True)) for values in itertools.product(*(one.grid for one in varied))]


def places(varied: Sequence[Varied], sample: str, count: int, seed: int) -> Array:
    """(count, n) places in the unit cube. A Sobol sequence has a power of two of them: rounded up."""
    from scipy.stats import qmc

    rng = np.random.default_rng(seed)
    if sample == "latin-hypercube":
        return np.asarray(qmc.LatinHypercube(len(varied), rng=rng).random(count))
    return np.asarray(qmc.Sobol(len(varied), rng=rng).random_base2(max(math.ceil(math.log2(count)), 0)))


def drawn(varied: Sequence[Varied], sample: str, count: int, seed: int) -> list[dict[str, Any]]:
    """A Latin hypercube or Sobol sample as changes of the study."""
    return [
        {one.key: one.at(float(u)) for one, u in zip(varied, row, strict=True)}
        for row in places(varied, sample, count, seed)
    ]


def listed(path: Path) -> tuple[list[dict[str, Any]], list[str]]:
    """The variants of a CSV file (see `tyrefem.cases`), and their names."""
    from tyrefem.cases import read_cases

    found = read_cases(path)
    return [dict(case.changes) for case in found], [case.name for case in found]


def without_repeats(variants: Sequence[dict[str, Any]], names: Sequence[str]) -> None:
    """Raise `InputError` naming two variants that are the same."""
    seen: dict[str, str] = {}
    for changes, name in zip(variants, names, strict=True):
        key = repr(sorted((key, str(value)) for key, value in changes.items()))
        if key in seen:
            raise InputError(f"variants '{seen[key]}' and '{name}' are the same")
        seen[key] = name
