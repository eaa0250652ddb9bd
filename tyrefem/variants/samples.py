"""Samples of variants: grids, Latin hypercubes, Sobol sequences, Saltelli samples, lists from CSV."""

from __future__ import annotations

import hashlib
import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, overload

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


class Variants(Sequence[Mapping[str, Any]]):
    """The changes of all variants of a sample, made when they are asked for."""

    @abstractmethod
    def changes(self, number: int) -> dict[str, Any]:
        """The changes of a variant."""

    @overload
    def __getitem__(self, number: int) -> Mapping[str, Any]: ...
    @overload
    def __getitem__(self, number: slice) -> Sequence[Mapping[str, Any]]: ...
    def __getitem__(self, number: int | slice) -> Mapping[str, Any] | Sequence[Mapping[str, Any]]:
        places = range(len(self))[number]
        return self.changes(places) if isinstance(places, int) else self.chosen(np.array(places, dtype=np.intp))

    def chosen(self, numbers: NDArray[np.intp]) -> Sequence[Mapping[str, Any]]:
        """The changes of some variants."""
        return [self.changes(number) for number in numbers.tolist()]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Sequence) or len(self) != len(other):
            return False
        return all(mine == theirs for mine, theirs in zip(self, other, strict=True))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"{type(self).__name__} of {len(self)} variants"


def chosen(variants: Sequence[Mapping[str, Any]], numbers: NDArray[np.intp]) -> Sequence[Mapping[str, Any]]:
    """The changes of some variants of a sample, or of a list."""
    return variants.chosen(numbers) if isinstance(variants, Variants) else [variants[n] for n in numbers.tolist()]


class Grid(Variants):
    """Every combination of the levels; the last name varies fastest.

    >>> list(Grid((Varied("a", values=(1, 2)), Varied("b", values=("x",)))))
    [{'a': 1, 'b': 'x'}, {'a': 2, 'b': 'x'}]
    """

    def __init__(self, varied: Sequence[Varied]) -> None:
        self._levels = [[number.changes(value) for value in number.grid] for number in varied]

    def __len__(self) -> int:
        return math.prod(map(len, self._levels))

    def changes(self, number: int) -> dict[str, Any]:
        """The changes of a combination."""
        chosen = []
        for levels in reversed(self._levels):
            number, place = divmod(number, len(levels))
            chosen.append(levels[place])
        return {key: value for changes in reversed(chosen) for key, value in changes.items()}


class Points(Variants):
    """The values at points of the unit cube, a row each. A part of them is as small as its points when it is sent."""

    def __init__(self, varied: Sequence[Varied], points: Array) -> None:
        self.varied, self.points = varied, points

    def __len__(self) -> int:
        return len(self.points)

    def changes(self, number: int) -> dict[str, Any]:
        """The changes at a point."""
        return changes_at(self.varied, self.points[number])

    def chosen(self, numbers: NDArray[np.intp]) -> Points:
        """The changes at some of the points."""
        return Points(self.varied, self.points[numbers])


@dataclass(frozen=True)
class Counted(Sequence[str]):
    """The names "1", "2", ... of so many variants.

    >>> names = Counted(3)
    >>> list(names), names.index("3"), "4" in names
    (['1', '2', '3'], 2, False)
    """

    size: int

    def __len__(self) -> int:
        return self.size

    @overload
    def __getitem__(self, number: int) -> str: ...
    @overload
    def __getitem__(self, number: slice) -> list[str]: ...
    def __getitem__(self, number: int | slice) -> str | list[str]:
        places = range(1, self.size + 1)[number]
        return str(places) if isinstance(places, int) else [str(place) for place in places]


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


def drawn(varied: Sequence[Varied], sample: str, count: int, seed: int) -> Points:
    """The changes of all variants of a sample."""
    return Points(varied, places(varied, sample, count, seed))


def changes_at(varied: Sequence[Varied], place: Sequence[float] | Array) -> dict[str, Any]:
    """Changes of the study at a point of the unit cube."""
    return _changes(varied, [number.at(float(u)) for number, u in zip(varied, place, strict=True)])


def listed(path: Path) -> tuple[list[dict[str, Any]], list[str]]:
    """The variants of a file (see `tyrefem.measured.cases`), and their names.

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


def check_distinct(variants: Sequence[Mapping[str, Any]], names: Sequence[str]) -> None:
    """Raise `InputError` if two variants are equal. Memory: eight bytes for a variant."""
    digests = np.fromiter((_digest(changes) for changes in variants), dtype=np.uint64, count=len(variants))
    order = np.argsort(digests, kind="stable")
    again = np.flatnonzero(digests[order][1:] == digests[order][:-1])
    for first, second in sorted((int(order[place]), int(order[place + 1])) for place in again):
        if _comparable(variants[first]) == _comparable(variants[second]):
            raise InputError(f"variants '{names[first]}' and '{names[second]}' are the same: delete one of them")


def _comparable(changes: Mapping[str, Any]) -> str:
    return repr(sorted((key, str(value)) for key, value in changes.items()))


def _digest(changes: Mapping[str, Any]) -> int:
    """A number of 64 bits that equal changes share."""
    return int.from_bytes(hashlib.blake2b(_comparable(changes).encode(), digest_size=8).digest(), "little")
