"""The meridian of a size: an arc under the belt, the membrane in equilibrium, the bead round the rim's flange."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.errors import InputError
from tyrefem.sizes.crown import BeltedCrown
from tyrefem.sizes.membrane import Membrane
from tyrefem.sizes.rim import Rim

Array = NDArray[np.float64]
#: Samples of the line between the points that a file gets.
FINE = 241
#: Smallest angles at which plies leave the flange, rad. Beyond -90 deg they hang over it, on the narrow rims of C
#: sizes: only where no other line fits.
LEAST_ANGLES = (-1.55, -1.9)


@dataclass(frozen=True)
class SizedMeridian:
    """Carcass line from the crown to the bead seat.

    Crown arc of ``crown_radius`` over ``join`` rad, or the line ``belted``; `Membrane` from there to the angle
    ``leaves``; an arc of radius ``bend`` the other way, about the rim's flange; a straight part at right angles to the
    seat. ``offset``: material
    outside of the line at the bead.
    """

    membrane: Membrane
    crown: float
    crown_radius: float
    join: float
    leaves: float
    rim: Rim
    offset: float
    bend: float
    belted: BeltedCrown | None = None

    @property
    def bend_centre(self) -> tuple[float, float]:
        """(r, z) of the centre of the bend: on the flange's centre line, where the straight part ends."""
        away = self.rim.radius + self.offset - self.bend
        r, z = self.rim.centre
        return r - away * float(np.sin(self.rim.taper)), z - away * float(np.cos(self.rim.taper))

    def to_flange(self, s: ArrayLike) -> Array:
        """From the line to the flange's rounding along the line's normal, m, from `flange_s` to the straight part."""
        away = self.rim.radius + self.offset - self.bend
        turn = self.rim.taper - self.at(s)[2]
        depth = np.sqrt(np.maximum(self.rim.radius**2 - (away * np.sin(turn)) ** 2, 0.0))
        return np.asarray(self.bend + away * np.cos(turn) - depth)

    @cached_property
    def _line(self) -> tuple[Array, Array, Array, Array]:
        """s, r, z, phi of fine samples."""
        parts = [self._crown]
        phi, r, z, s = self.membrane.run(np.pi / 2 - self.join, self.leaves, FINE)
        parts.append((parts[-1][0][-1] + s, r, parts[-1][2][-1] + z, phi))
        bend = self.bend
        phi = np.linspace(self.leaves, self.rim.taper, 80)
        c = self.bend_centre
        r, z = c[0] - bend * np.sin(phi), c[1] - bend * np.cos(phi)
        parts.append((parts[-1][0][-1] + bend * (phi - self.leaves), r, z, phi))
        h = np.linspace(0.0, self.rim.straight, 12)
        t = self.rim.taper
        parts.append((parts[-1][0][-1] + h, r[-1] - h * np.cos(t), z[-1] + h * np.sin(t), np.full(h.shape, t)))
        joined = [np.concatenate([part[k][bool(n) :] for n, part in enumerate(parts)]) for k in range(4)]
        return joined[0], joined[1], joined[2], joined[3]

    @cached_property
    def _crown(self) -> tuple[Array, Array, Array, Array]:
        """s, r, z, phi up to where the membrane begins."""
        if self.belted is not None:
            return self.belted.line
        theta = np.linspace(0.0, self.join, 60) if self.join > 0 else np.zeros(1)
        r = self.crown - self.crown_radius * (1 - np.cos(theta))
        return self.crown_radius * theta, r, self.crown_radius * np.sin(theta), np.pi / 2 - theta

    @property
    def length(self) -> float:
        """Crown to bead seat, m."""
        return float(self._line[0][-1])

    @property
    def join_s(self) -> float:
        """Where the membrane begins, m from the crown."""
        return float(self._crown[0][-1])

    @property
    def flange_s(self) -> float:
        """Where the line begins to follow the flange."""
        return self.length - self.rim.straight - self.bend * (self.rim.taper - self.leaves)

    @property
    def widest_s(self) -> float:
        """Where the line is widest."""
        s, _, z, _ = self._line
        return float(s[int(np.argmax(z))])

    @property
    def half_width(self) -> float:
        """Largest z of the line, m."""
        return float(self._line[2].max())

    def at(self, s: ArrayLike) -> tuple[Array, Array, Array]:
        """r, z and phi at places of the line."""
        along, _, _, phi = self._line
        place = self._curve(s)
        return place[..., 0], place[..., 1], np.asarray(np.interp(np.asarray(s, dtype=float), along, phi))

    @cached_property
    def _curve(self) -> Any:
        """Cubic through the samples with their tangents dr/ds = -cos phi, dz/ds = sin phi."""
        from scipy.interpolate import CubicHermiteSpline

        s, r, z, phi = self._line
        return CubicHermiteSpline(s, np.stack([r, z], axis=-1), np.stack([-np.cos(phi), np.sin(phi)], axis=-1))

    def before(self, s: float, length: float, y: float) -> float:
        """Place of the line from which a parallel at the distance ``y``, m, outwards, has a ``length``, m, up to ``s``.

        With the curvature -dphi/ds the parallel's length is that of s - y phi.
        """
        along, _, _, phi = self._line
        parallel = np.maximum.accumulate(along - y * phi)
        return float(np.interp(np.interp(s, along, parallel) - length, parallel, along))

    def points(self, count: int) -> list[tuple[float, float]]:
        """(r, z) for a file: about so many, closer where the line bends more, with one at every change of curvature."""
        s, r, z, phi = self._line
        marks = [
            0.0,
            *([self.join_s] if self.join_s > 2e-3 else []),
            self.flange_s,
            self.length - self.rim.straight,
            self.length,
        ]
        turned = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(phi)))])
        measure = turned / turned[-1] + s / s[-1]
        stations = [0.0]
        for a, b in pairwise(marks):
            first, last = (float(end) for end in np.interp(np.array([a, b]), s, measure))
            gaps = max(2, round((last - first) / 2 * count))
            stations.extend(np.interp(np.linspace(first, last, gaps + 1)[1:], measure, s).tolist())
        r, z, _ = self.at(np.array(stations))
        return [(float(a), float(b)) for a, b in zip(r, z, strict=True)]


def radial_meridian(
    crown: float, crown_radius: float, half_width: float, rim: Rim, offset: float, bend: float
) -> SizedMeridian:
    """The line of a belted radial: r_m, the end of the crown arc and the angle at the flange are solved for.

    Raises
    ------
    InputError : no such line.
    """

    def line(x: Array) -> SizedMeridian:
        widest, join, leaves = (float(value) for value in x)
        edge = crown - crown_radius * (1 - np.cos(join))
        constant = (edge**2 - widest**2) / np.cos(join)
        return SizedMeridian(Membrane(widest, constant), crown, crown_radius, join, leaves, rim, offset, bend)

    def misses(x: Array) -> list[float]:
        drawn = line(x)
        start = crown_radius * np.sin(drawn.join)
        _, _, z, _ = drawn.membrane.run(np.pi / 2 - drawn.join, 0.0, 40)
        return [start + z[-1] - half_width, *_flange_misses(drawn, start)]

    starts = [
        (np.array([share * rim.diameter / 2 + (1 - share) * crown, join, leaves]))
        for share in (0.45, 0.35)
        for join in (0.1, 0.2, 0.05, 0.35)
        for leaves in (-0.9, -0.6)
    ]
    solution = _solved(
        misses,
        starts,
        lambda x, least: rim.diameter / 2 < x[0] < crown and 0 < x[1] < 1.2 and least < x[2] < rim.taper,
    )
    if solution is None:
        raise _impossible(half_width, rim)
    return line(solution)


def belted_meridian(
    crown: float, edge: float, power: float, half_width: float, rim: Rim, offset: float, bend: float
) -> SizedMeridian:
    """The line of a radial whose belt carries the share of `BeltedCrown` up to ``edge``, m: r_m, the share at the mid
    plane (with it the crown radius) and the angle at the flange are solved for.

    Raises
    ------
    InputError : no such line: the belt is too narrow for its ``power``.
    """

    def line(x: Array) -> SizedMeridian:
        widest, share, leaves = (float(value) for value in x)
        belted = BeltedCrown(crown, widest, edge, share, power)
        _, r, _, phi = belted.line
        membrane = Membrane(widest, float((r[-1] ** 2 - widest**2) / np.sin(phi[-1])))
        join = float(np.pi / 2 - phi[-1])
        return SizedMeridian(membrane, crown, belted.radius, join, leaves, rim, offset, bend, belted)

    def misses(x: Array) -> list[float]:
        drawn = line(x)
        start = float(drawn._crown[2][-1])
        _, _, z, _ = drawn.membrane.run(np.pi / 2 - drawn.join, 0.0, 40)
        return [start + z[-1] - half_width, *_flange_misses(drawn, start)]

    starts = [
        np.array([height * rim.diameter / 2 + (1 - height) * crown, share, leaves])
        for height in (0.45, 0.35)
        for share in (0.8, 0.6, 0.9)
        for leaves in (-0.9, -0.6)
    ]
    solution = _solved(
        misses,
        starts,
        lambda x, least: rim.diameter / 2 < x[0] < crown and 0 < x[1] < 1 and least < x[2] < rim.taper,
    )
    if solution is None:
        raise InputError(
            f"no crown line has a belt {2e3 * edge:.4g} mm wide whose share of the pressure falls with the power "
            f"{power:g}; a larger belt_power, a wider belt or crown_radius in its place",
            field="parameters.belt_power",
        )
    return line(solution)


def bias_meridian(
    crown: float, half_width: float, rim: Rim, offset: float, bend: float, angle: float | None
) -> tuple[SizedMeridian, float]:
    """The line of bias plies, in equilibrium from the crown on, and the crown angle of the cords.

    Without an ``angle`` it is the one at which the section is ``half_width`` wide on its rim; with one, the width
    follows.

    Raises
    ------
    InputError : no such line.
    """

    def line(x: Array) -> SizedMeridian:
        widest, leaves = float(x[0]), float(x[1])
        crown_angle = float(x[2]) if angle is None else angle
        lift = np.cos(crown_angle) / crown
        membrane = Membrane(widest, (crown**2 - widest**2) * np.sin(crown_angle), lift)
        return SizedMeridian(membrane, crown, 1.0, 0.0, leaves, rim, offset, bend)

    def misses(x: Array) -> list[float]:
        drawn = line(x)
        misses = _flange_misses(drawn, 0.0)
        if angle is None:
            _, _, z, _ = drawn.membrane.run(np.pi / 2, 0.0, 40)
            misses.append(z[-1] - half_width)
        return misses

    unknown = 3 if angle is None else 2
    starts = [
        np.array([share * rim.diameter / 2 + (1 - share) * crown, leaves, 0.61])[:unknown]
        for share in (0.5, 0.4, 0.6)
        for leaves in (-0.8, -0.5, -1.1)
    ]
    solution = _solved(
        misses,
        starts,
        lambda x, least: (
            rim.diameter / 2 < x[0] < crown
            and least < x[1] < rim.taper
            and (unknown < 3 or 0.3 < x[2] < 1.2)
            # Flatter crowns have a hollow in the middle.
            and float(line(x).membrane.curvature(crown)) > 0.3 / crown
        ),
    )
    if solution is None:
        raise _impossible(half_width, rim)
    return line(solution), float(solution[2]) if angle is None else angle


def _flange_misses(drawn: SizedMeridian, start: float) -> list[float]:
    """How far the end of the membrane is from the circle about the flange's centre that it must touch."""
    phi, r, z, _ = drawn.membrane.run(np.pi / 2 - drawn.join, drawn.leaves, 60)
    bend, c = drawn.bend, drawn.bend_centre
    return [r[-1] + bend * np.sin(phi[-1]) - c[0], start + z[-1] + bend * np.cos(phi[-1]) - c[1]]


def _solved(misses: Any, starts: list[Array], possible: Any) -> Array | None:
    from scipy.optimize import root

    roots = []
    for start in starts:
        with np.errstate(all="ignore"):
            x = root(misses, start, tol=1e-14).x
        if np.abs(misses(x)).max() < 1e-9:
            if possible(x, LEAST_ANGLES[0]):
                return np.asarray(x)
            roots.append(x)
    return next((np.asarray(x) for x in roots if possible(x, LEAST_ANGLES[1])), None)


def _impossible(half_width: float, rim: Rim) -> InputError:
    return InputError(
        f"no carcass line in equilibrium is {2e3 * half_width:.4g} mm wide on a rim {1e3 * rim.width:.4g} mm "
        "wide; change rim_width,"
        " section_width or crown_radius",
        field="parameters",
    )
