"""Samples of variants: grids, Latin hypercubes, Sobol sequences, Saltelli samples, lists from CSV."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.estimates.work import check_memory, rounded_down, variants
from tyrefem.variants.varied import Varied, in_one_unit

Array = NDArray[np.float64]


def size_of(varied: Sequence[Varied], sample: str, count: int | None) -> int:
    """Number of variants of a sample, before any is built; raises as `check_size`.

    >>> size_of([Varied("a", levels=3), Varied("b", values=("x",))], "grid", None)
    3
    >>> size_of([Varied("a")], "sobol", 100), size_of([Varied("a"), Varied("b")], "saltelli", 64)
    (128, 256)
    """
    if sample == "grid":
        count_of_variants = math.prod(len(number.values) or number.levels for number in varied)
        check_size(count_of_variants, len(varied), "the grid", "vary")
        return count_of_variants
    assert count is not None
    count_of_variants = {"sobol": 1 << (count - 1).bit_length(), "saltelli": count * (len(varied) + 2)}.get(
        sample, count
    )
    check_size(count_of_variants, len(varied), f"sample = '{sample}'", "count")
    return count_of_variants


def check_size(count: int, numbers: int, what: str, field: str) -> None:
    """Check that a number of variants fits in memory.

    Raises
    ------
    InputError : at ``field``; the message states how many would fit.
    """
    words = f"{count:,}" if count < 10**15 else "more than 10^15"
    try:
        check_memory(
            variants(count, numbers),
            f"{what} makes {words} variants",
            lambda free: f"{rounded_down(free / variants(1, numbers)):,.0f} variants would fit",
        )
    except InputError as error:
        raise error.within(field=field) from None


def grid(varied: Sequence[Varied]) -> list[dict[str, Any]]:
    """Every combination of the levels; the last name varies fastest.

    >>> grid([Varied("a", values=(1, 2)), Varied("b", values=("x",))])
    [{'a': 1, 'b': 'x'}, {'a': 2, 'b': 'x'}]
    """
    return [_changes(varied, values) for values in itertools.product(*(number.grid for number in varied))]


def _changes(varied: Sequence[Varied], values: Sequence[Any]) -> dict[str, Any]:
    changes: dict[str, Any] = {}
    for number, value in zip(varied, values, strict=True):
        changes |= number.changes(value)
    return changes


def places(varied: Sequence[Varied], sample: str, count: int, seed: int) -> Array:
    """Points in the unit cube, a row each: ``count`` of a Latin hypercube.

    A Sobol sequence has ``count`` rounded up to a power of two. A Saltelli sample (2010), for Sobol indices, has
    ``count`` x (numbers + 2) points; ``count`` must be a power of two.
    """
    from scipy.stats import qmc

    if sample == "saltelli":
        from SALib.sample import sobol

        if count < 2 or count & (count - 1):
            raise InputError(f"Saltelli's sample needs a power of two, e.g. 64, not {count}", field="count")
        if len(varied) < 2:
            raise InputError("Sobol indices need at least two numbers that vary", field="vary")
        return np.asarray(sobol.sample(problem(varied), count, calc_second_order=False, seed=seed))
    rng = np.random.default_rng(seed)
    if sample == "latin-hypercube":
        return np.asarray(qmc.LatinHypercube(len(varied), seed=rng).random(count))
    return np.asarray(qmc.Sobol(len(varied), seed=rng).random_base2(max(math.ceil(math.log2(count)), 0)))


def problem(varied: Sequence[Varied]) -> dict[str, Any]:
    """Problem of SALib: names, and the unit cube as bounds; `Varied.at` maps its points to values."""
    return {"num_vars": len(varied), "names": [number.label for number in varied], "bounds": [[0.0, 1.0]] * len(varied)}


def drawn(varied: Sequence[Varied], sample: str, count: int, seed: int) -> list[dict[str, Any]]:
    """The changes of all variants of a sample."""
    return [changes_at(varied, row) for row in places(varied, sample, count, seed)]


def changes_at(varied: Sequence[Varied], place: Sequence[float] | Array) -> dict[str, Any]:
    """Changes of the study at a point of the unit cube."""
    return _changes(varied, [number.at(float(u)) for number, u in zip(varied, place, strict=True)])


def listed(path: Path) -> tuple[list[dict[str, Any]], list[str]]:
    """The variants of a CSV file (see `tyrefem.measured.cases`), and their names.

    Raises
    ------
    InputError : the file is not a table of cases, or two variants are equal, also in different units.
    """
    from tyrefem.measured.cases import read_cases

    cases = read_cases(path)
    keys = list(dict.fromkeys(key for case in cases for key in case.changes))
    check_size(len(cases), len(keys), path.name, "cases")
    changes, names = [dict(case.changes) for case in cases], [case.name for case in cases]
    columns = {key: in_one_unit([changes_of_case.get(key) for changes_of_case in changes]) for key in keys}
    plain = [{key: columns[key][place] for key in changes_of_case} for place, changes_of_case in enumerate(changes)]
    try:
        check_distinct(plain, names)
    except InputError as error:
        raise error.within(file=path) from None
    return changes, names


def check_distinct(variants: Sequence[dict[str, Any]], names: Sequence[str]) -> None:
    """Raise `InputError` if two variants are equal."""
    names_of_changes: dict[str, str] = {}
    for changes, name in zip(variants, names, strict=True):
        key = repr(sorted((key, str(value)) for key, value in changes.items()))
        if key in names_of_changes:
            raise InputError(f"variants '{names_of_changes[key]}' and '{name}' are the same: delete one of them")
        names_of_changes[key] = name
