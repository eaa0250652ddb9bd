"""Arrays as functions of a few numbers in a box, learnt from few evaluations as sums or products of functions of one.

Every array is one of

    f(x) = f(0) + sum_g (f_g(x_g) - f(0)),        f(x) = f(0) prod_g f_g(x_g) / f(0),

f_g(x_g) = f with all numbers but those of the group g at the centre 0. A group has one number, or two that do not
separate. f_g is a polynomial through Chebyshev points (Trefethen 2013, Approximation Theory and Approximation Practice,
ch. 2 and 5), whose number is doubled until the values between them are met.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief

Array = NDArray[np.float64]
#: A function of a point (d,) of the unit box: the point that it used, and the arrays there.
Function = Callable[[Array], tuple[Array, Mapping[str, Array]]]
#: Largest error of an array over its largest entry: some times that of 9 written digits.
RELATIVE = 1e-8
#: Intervals between the Chebyshev points of a number, doubled until a polynomial converges.
INTERVALS = (2, 4, 8, 16)
#: Points that test whether an array is a sum or a product, and points that test the whole.
TRIALS, CHECKS = 2, 6
#: Points at most of each of two numbers that do not separate.
MOST_POINTS = 13


class NotSeparableError(Exception):
    """The arrays are no sums or products of functions of one or two numbers."""


@dataclass(frozen=True, eq=False)
class Part:
    """A polynomial of one or two numbers.

    Parameters
    ----------
    numbers : which numbers of the box. nodes : their values at the points, (k_i,) each. values : (k_1 k_2, size).
    """

    numbers: tuple[int, ...]
    nodes: tuple[Array, ...]
    values: Array

    def __call__(self, x: Array) -> Array:
        """(B, size) values at points (B, d)."""
        weights = lagrange(self.nodes[0], x[:, self.numbers[0]])
        for number, nodes in zip(self.numbers[1:], self.nodes[1:], strict=True):
            other = lagrange(nodes, x[:, number])
            weights = (weights[:, :, None] * other[:, None, :]).reshape(len(x), -1)
        return np.asarray(weights @ self.values)


def lagrange(nodes: Array, x: Array) -> Array:
    """Values (B, k) at x (B,) of the polynomials that are 1 at one of the nodes (k,) and 0 at the others.

    >>> lagrange(np.array([0.0, 0.5, 1.0]), np.array([0.5, 0.25])).tolist()
    [[0.0, 1.0, 0.0], [0.375, 0.75, -0.125]]
    """
    apart = nodes[:, None] - nodes
    np.fill_diagonal(apart, 1.0)
    weights, distance = 1.0 / apart.prod(axis=1), x[:, None] - nodes
    exact = distance == 0.0
    terms = weights / np.where(exact, 1.0, distance)
    values = terms / terms.sum(axis=1, keepdims=True)
    at_node = exact.any(axis=1)
    values[at_node] = exact[at_node]
    return np.asarray(values)


@dataclass(frozen=True, eq=False)
class SeparatedArray:
    """One array: its value at the centre, and its parts. ``product``: of the parts, else their sum."""

    centre: Array
    parts: tuple[Part, ...]
    product: bool

    def __call__(self, x: Array) -> Array:
        """(B, *shape) values at points (B, d)."""
        base = np.reshape(self.centre, (1, -1))
        flat = np.repeat(base, len(x), axis=0)
        for part in self.parts:
            if self.product:
                flat *= np.divide(part(x), base, out=np.ones_like(flat), where=base != 0.0)
            else:
                flat += part(x) - base
        return flat.reshape(len(x), *np.shape(self.centre))


@dataclass(frozen=True, eq=False)
class Separated(Brief):
    """Named arrays as functions of points of the unit box; ``evaluations``: how many they were learnt from."""

    arrays: Mapping[str, SeparatedArray]
    evaluations: int

    def _title(self) -> str:
        return f"{len(self.arrays)} arrays"

    def _facts(self) -> Mapping[str, object]:
        return {"evaluations": self.evaluations, "parts": sum(len(each.parts) for each in self.arrays.values())}

    def __call__(self, x: Array) -> dict[str, Array]:
        """Name -> (B, *shape) values at points (B, d)."""
        return {name: array(x) for name, array in self.arrays.items()}


def separated(function: Function, count: int, most: int = 1000, seed: int = 0) -> Separated:
    """Learn the arrays of a function of ``count`` numbers from ``most`` evaluations at most.

    Raises
    ------
    NotSeparableError : more evaluations would be needed, polynomials do not converge, more than two numbers do not
        separate, or a test point is missed.
    """
    return _Learning(function, count, most, seed).learnt()


class _Learning:
    def __init__(self, function: Function, count: int, most: int, seed: int) -> None:
        self.function, self.count, self.most, self.evaluations = function, count, most, 0
        self.random = np.random.default_rng(seed)
        self.middle, self.centre = self._at(np.full(count, 0.5))

    def learnt(self) -> Separated:
        lines = [self._line(number) for number in range(self.count)]
        trials = [self._at(self.random.random(self.count)) for _ in range(TRIALS)]
        grids: dict[tuple[int, int], Mapping[str, Part]] = {}
        arrays: dict[str, SeparatedArray] = {}
        for name, centre in self.centre.items():
            parts = tuple(line[name] for line in lines if name in line)
            sums = [SeparatedArray(centre, parts, product) for product in (False, True)]
            good = [each for each in sums if all(_meets(each, x, values[name]) for x, values in trials)]
            arrays[name] = good[0] if good else self._paired(name, parts, grids, lines)
        for _ in range(CHECKS):
            x, values = self._at(self.random.random(self.count))
            missed = [name for name, array in arrays.items() if not _meets(array, x, values[name])]
            if missed:
                raise NotSeparableError(f"'{missed[0]}' is missed at a test point")
        return Separated(arrays, self.evaluations)

    def _at(self, x: Array) -> tuple[Array, Mapping[str, Array]]:
        self._check(1)
        self.evaluations += 1
        return self.function(x)

    def _check(self, more: int) -> None:
        if self.evaluations + more > self.most:
            raise NotSeparableError(f"more than {self.most} evaluations would be needed")

    def _moved(self, numbers: Sequence[int], places: Sequence[float]) -> tuple[Array, Mapping[str, Array]]:
        x = np.full(self.count, 0.5)
        x[list(numbers)] = places
        return self._at(x)

    def _line(self, number: int) -> dict[str, Part]:
        """Parts of one number, of the arrays that depend on it."""
        at: dict[float, tuple[float, Mapping[str, Array]]] = {0.5: (float(self.middle[number]), self.centre)}
        done: dict[str, Part] = {}
        left = set(self.centre)
        for intervals in INTERVALS:
            points = chebyshev(intervals + 1).tolist()
            new = [point for point in points if point not in at]
            for point in new:
                used, values = self._moved([number], [point])
                at[point] = float(used[number]), values
            for name in sorted(left):
                if intervals == INTERVALS[0]:
                    # Three points that agree: an array that does not depend on the number.
                    if all(np.array_equal(values[name], self.centre[name]) for _, values in at.values()):
                        left.discard(name)
                    continue
                between = points[::2]
                part = _part(number, [at[point] for point in between], name)
                if all(_near(part(_line_of(self.count, number, at[p][0])), at[p][1][name]) for p in new):
                    done[name] = _part(number, [at[point] for point in points], name)
                    left.discard(name)
            if not left:
                return done
        raise NotSeparableError(f"'{sorted(left)[0]}' is not smooth over number {number + 1}")

    def _paired(
        self,
        name: str,
        parts: tuple[Part, ...],
        grids: dict[tuple[int, int], Mapping[str, Part]],
        lines: Sequence[Mapping[str, Part]],
    ) -> SeparatedArray:
        """An array with pairs of numbers that do not separate, as a product of all else, or as a sum."""
        for product in (True, False):
            pairs = []
            for first, second in itertools.combinations(parts, 2):
                numbers = first.numbers[0], second.numbers[0]
                x, values = self._moved(numbers, self.random.random(2).tolist())
                if not _meets(SeparatedArray(self.centre[name], (first, second), product), x, values[name]):
                    pairs.append(numbers)
            members = [number for pair in pairs for number in pair]
            if not pairs or len(set(members)) < len(members):
                continue
            for pair in pairs:
                if pair not in grids:
                    grids[pair] = self._grid(pair, lines)
            single = tuple(part for part in parts if part.numbers[0] not in members)
            if all(name in grids[pair] for pair in pairs):
                return SeparatedArray(self.centre[name], (*single, *(grids[pair][name] for pair in pairs)), product)
        raise NotSeparableError(f"'{name}' depends on more than two numbers at once")

    def _grid(self, pair: tuple[int, int], lines: Sequence[Mapping[str, Part]]) -> dict[str, Part]:
        """Parts of two numbers, of the arrays that depend on both."""
        names = [name for name in lines[pair[0]] if name in lines[pair[1]]]
        # Fewer points than of a line may do: the test points decide.
        nodes = tuple(
            chebyshev(min(max(len(lines[number][name].nodes[0]) for name in names), MOST_POINTS)) for number in pair
        )
        self._check(len(nodes[0]) * len(nodes[1]))
        values = [self._moved(pair, places)[1] for places in itertools.product(*nodes)]
        return {name: Part(pair, nodes, np.array([np.ravel(each[name]) for each in values])) for name in names}


def chebyshev(count: int) -> Array:
    """Chebyshev points of the unit interval, with its ends: those of 3 are among those of 5.

    >>> chebyshev(3).tolist()
    [0.0, 0.5, 1.0]
    """
    return np.round(0.5 - 0.5 * np.cos(np.pi * np.arange(count) / (count - 1)), 12)


def _part(number: int, at: Sequence[tuple[float, Mapping[str, Array]]], name: str) -> Part:
    nodes = np.array([place for place, _ in at])
    return Part((number,), (nodes,), np.array([np.ravel(values[name]) for _, values in at]))


def _line_of(count: int, number: int, place: float) -> Array:
    x = np.full((1, count), 0.5)
    x[0, number] = place
    return x


def _near(value: Array, exact: Array) -> bool:
    exact = np.ravel(exact)
    return bool(np.abs(np.ravel(value) - exact).max(initial=0.0) <= RELATIVE * np.abs(exact).max(initial=0.0))


def _meets(array: SeparatedArray, x: Array, values: Array) -> bool:
    return _near(array(x[None]), values)
