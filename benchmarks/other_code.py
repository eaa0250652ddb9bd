"""One tyre by two codes: inflated and pressed on a flat road by harmonics, and by FElupe in three dimensions.

    python benchmarks/other_code.py [--quick] [--out TABLE.csv]

The plain belted tyre (`PlainTyre.body`): neo-Hookean rubber with cords, a pressure that follows the wall, no friction.
Each code inflates the same section mesh from rest and presses it by 20 mm from its inflated state. Prints one table for
each mesh, and one of the strains over all meshes; --quick: only the coarsest mesh. Goals hold for means of strain over
patches of a stated size; strains at points grow without end at the sharp ends of belt and rim.
FElupe is under the GPL: only this benchmark and its test use it.
"""

from __future__ import annotations

import argparse
import csv
import functools
import math
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray
from strain_patches import Patches

from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.elements import COMPONENTS, SectionElements, WheelAngles
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.inflation import Inflation
from tyrefem.mechanics.solid.newton import equilibrium
from tyrefem.output import atomic_path

try:
    from felupe_tyre import SolidTyre
except ModuleNotFoundError as error:
    if error.name != "felupe":
        raise
    sys.exit("this benchmark needs FElupe 11.3 or later: pip install felupe")

Array = NDArray[np.float64]
Sample = Callable[[Array, str], Array]
#: Pa, m.
PRESSURE, DEFLECTION = 2e5, 0.02
#: Elements along the half section and through the tread, and size of hexahedra round the wheel near the footprint,
#: degrees.
MESHES = ((8, 1, 5.0), (8, 1, 1.25), (14, 1, 2.5), (20, 1, 2.5), (28, 2, 5.0))
#: Largest deviations.
LOAD, AREA, STRAIN = 0.02, 0.05, 0.05
#: Radii of the patches over which strains are averaged, m, and their goals: the smaller is not resolved by the meshes.
PATCHES: dict[float, float | None] = {4e-3: STRAIN, 2e-3: None}
#: Rows that are printed over all meshes.
OVER_MESHES = ("patch of radius", "at a point")
#: Meshes of the harmonics alone: elements along the half section and through ply, belt and tread; with these harmonics
#: and angles of the strains, rad.
FINER = ((20, (1, 1, 1)), (28, (1, 1, 2)), (40, (2, 2, 4)), (80, (2, 2, 6)))
FINER_HARMONICS, FINER_ANGLES = 72, np.radians(np.r_[0.0:40.0:0.625, 40.0:181.0:5.0])
#: Tread nearer to the road than this touches it, m: the film of an ink print.
FILM = 1e-4
UNIT = np.eye(3).reshape(3, 3, 1, 1, 1)
RUBBER = ("tread", "sidewall")


@dataclass(frozen=True, eq=False)
class Solution:
    """What both codes say, in SI units, of the whole tyre but for the areas.

    Parameters
    ----------
    load : N. growth : of the radius by inflation, m.
    pressure, areas, gaps : (angles, nodes) of tread nodes; areas of the inflated quarter. places : (2, angles, nodes)
        along and across the road from the middle.
    pressed, inflated : Green's strain (3, 3, e, 9, angles) in (r, z, t).
    """

    load: float
    growth: float
    pressure: Array
    areas: Array
    gaps: Array
    places: Array
    pressed: Array
    inflated: Array

    @property
    def area(self) -> float:
        """Area of the tread nearer than `FILM` to the road, m2: the gap is linear between angles."""
        x, z = self.places
        ends = np.array([_crossing(gap, at) for gap, at in zip(self.gaps.T, x.T, strict=True)])
        # Simpson's rule over the nodes of quadratic elements.
        across = z[0]
        return float(4 * ((ends[:-2:2] + 4 * ends[1::2] + ends[2::2]) * (across[2::2] - across[:-2:2])).sum() / 6)

    @property
    def pressed_area(self) -> float:
        """Area of the tread nodes under pressure, m2."""
        return float(4 * self.areas[self.pressure > 0].sum())

    @property
    def effective_area(self) -> float:
        """(int p dA)^2 / int p^2 dA, m2: it does not jump where a node touches."""
        forces = self.pressure * self.areas
        return float(4 * forces.sum() ** 2 / (self.pressure * forces).sum())

    def spread(self, axis: int) -> float:
        """Root mean square distance of the pressure from the middle, along (0) or across (1) the road, m."""
        forces = self.pressure * self.areas
        return float(np.sqrt((forces * self.places[axis] ** 2).sum() / forces.sum()))


def _crossing(gap: Array, at: Array) -> float:
    """The place where a gap first exceeds `FILM`."""
    beyond = int(np.argmax(gap > FILM))
    if beyond == 0:
        return 0.0
    low, high = gap[beyond - 1], gap[beyond]
    return float(at[beyond - 1] + (FILM - low) / (high - low) * (at[beyond] - at[beyond - 1]))


@dataclass(frozen=True, eq=False)
class PlacedAngles(WheelAngles):
    """Angles of the wheel that are given, rad."""

    angles: Array

    def __init__(self, elements: SectionElements, highest: int, angles: Array) -> None:
        super().__init__(elements, highest)
        object.__setattr__(self, "angles", angles)


def green(deformation: Array) -> Array:
    """Green's strain of F (3, 3, e, q, angles)."""
    return np.asarray((np.einsum("ki...,kj...->ij...", deformation, deformation) - UNIT) / 2)


def by_harmonics(body: Body, harmonics: int, deflection: float, angles: Array) -> Solution:
    """Inflation and footprint of this package; strains at the given angles, rad."""
    inflation = Inflation(body, equilibrium(body, PRESSURE))
    footprint = Balance(Pressing(inflation.state), harmonics).at_deflection(deflection)
    elements, grid, shape = footprint.pressing.harmonics.elements, footprint.grid, footprint.pressure.shape
    gradient = PlacedAngles(elements, footprint.harmonics, angles).gradient(footprint.amplitudes)
    e, _, q, m = gradient.shape
    moved = gradient.transpose(1, 0, 2, 3).reshape(3, 3, e, q, m) + UNIT
    before = inflation.deformation[..., None]
    places = grid.places(footprint.displacement, 0.0)[[0, 2]].reshape(2, *shape)
    # On a half section the footprint's displacement has no axial component.
    waves = np.cos(np.outer(grid.angles, np.arange(footprint.harmonics + 1)))
    places[1] += waves @ footprint.amplitudes[:, COMPONENTS * grid.tread.nodes + 1]
    return Solution(
        load=footprint.load,
        growth=inflation.radius_growth,
        pressure=footprint.pressure,
        areas=grid.areas.reshape(shape) * grid.sides[:, None] / 2,
        gaps=footprint.gaps.reshape(shape),
        places=places,
        pressed=green(np.einsum("ijeqm,jkeqm->ikeqm", moved, np.broadcast_to(before, moved.shape))),
        inflated=green(before),
    )


def by_felupe(solid: SolidTyre, body: Body, deflection: float) -> tuple[Solution, Array]:
    """Inflation and footprint of FElupe, strains at the section points of ``body``; angles of the strains, rad."""
    inflated = solid.inflate(PRESSURE)
    pressed = solid.press(deflection)
    strain, angles, r, z = pressed.green()
    mine = body.rings.points
    distances = np.hypot(r[:, None] - mine[0][:, :, None], z[:, None] - mine[1][:, :, None])
    same = distances.argmin(axis=-1)
    if distances.min(axis=-1).max() > 1e-6 or (same != same[0]).any():
        raise RuntimeError("the integration points of both codes differ")
    solution = Solution(
        load=float(4 * pressed.forces.sum()),
        growth=pressed.reach - float(solid.flat.p[0].max()),
        pressure=pressed.forces / inflated.areas,
        areas=inflated.areas,
        gaps=pressed.gaps,
        places=np.moveaxis(pressed.places[..., [0, 2]], -1, 0),
        pressed=strain[:, :, :, same[0]],
        inflated=inflated.green()[0][:, :, :, same[0]],
    )
    return solution, angles


@dataclass(frozen=True)
class Row:
    """A quantity by both codes, in a unit; ``goal``: largest deviation, None: for information."""

    quantity: str
    unit: str
    harmonics: float
    felupe: float
    goal: float | None = None

    @property
    def deviation(self) -> float:
        """Of the harmonics from FElupe, relative."""
        return self.harmonics / self.felupe - 1

    @property
    def met(self) -> str:
        """Whether the goal is met."""
        return "" if self.goal is None else "yes" if abs(self.deviation) <= self.goal else "no"

    @property
    def cells(self) -> tuple[str, ...]:
        """Text of the row."""
        goal = "" if self.goal is None else f"{100 * self.goal:.0f} %"
        numbers = f"{self.harmonics:.5g}", f"{self.felupe:.5g}", f"{100 * self.deviation:+.2f} %"
        return (f"{self.quantity}, {self.unit}", *numbers, goal, self.met)


def rows(tyre: PlainTyre, body: Body, ours: Solution, theirs: Solution) -> Iterator[Row]:
    """The comparison."""
    regions = body.mesh.subdomains

    def row(quantity: str, unit: str, factor: float, value: Any, goal: float | None = None) -> Row:
        return Row(quantity, unit, factor * value(ours), factor * value(theirs), goal)

    def stretch(solution: Solution, name: str) -> tuple[Array, Array]:
        (layer,) = body.parts[name].cords
        direction = layer.directions[0]
        squares = (
            1 + 2 * np.einsum("ieq,ijeqm,jeq->eqm", direction, strain[:, :, regions[name]], direction)
            for strain in (solution.pressed, solution.inflated)
        )
        pressed, inflated = (np.sqrt(square) for square in squares)
        return pressed - 1, pressed - inflated

    yield row("growth of the radius by inflation", "mm", 1e3, lambda s: s.growth)
    yield row("load", "N", 1, lambda s: s.load, LOAD)
    yield row("contact area", "cm2", 1e4, lambda s: s.area, AREA)
    yield row("area of nodes under pressure", "cm2", 1e4, lambda s: s.pressed_area)
    yield row("effective area, F2/int p2 dA", "cm2", 1e4, lambda s: s.effective_area)
    yield row("length of the pressure, rms", "mm", 1e3, lambda s: s.spread(0))
    yield row("width of the pressure, rms", "mm", 1e3, lambda s: s.spread(1))
    for name in ("ply", "belt"):
        yield row(f"largest cord strain, {name}", "%", 100, lambda s, n=name: stretch(s, n)[0].max(), STRAIN)
        text = f"largest change of cord strain by the load, {name}"
        yield row(text, "%", 100, lambda s, n=name: np.abs(stretch(s, n)[1]).max(), STRAIN)
    for of, part, edge, goal in samples(tyre, body):
        text = f"largest principal strain of rubber, {part}"
        yield row(text, "%", 100, lambda s, of=of: principal(of(s.pressed, "rubber")), goal)
        for name in RUBBER:
            text = f"largest principal change by the load, {name}, {part}"
            yield row(text, "%", 100, lambda s, of=of, n=name: principal(of(s.pressed - s.inflated, n)), goal)
        text = f"largest range of shear {edge}, {part}"
        yield row(text, "%", 100, lambda s, of=of, n=edge: shear(of(s.pressed - s.inflated, n)), goal)


def principal(strain: Array) -> float:
    """Largest principal strain of (3, 3, places, angles)."""
    return float(np.abs(np.linalg.eigvalsh(np.moveaxis(strain, (0, 1), (-2, -1)))).max())


def shear(strain: Array) -> float:
    """Largest range over the angles of a shear strain of (3, 3, places, angles)."""
    return float(max(np.ptp(2 * strain[i, j], axis=-1).max() for i, j in ((0, 1), (0, 2), (1, 2))))


def samples(tyre: PlainTyre, body: Body) -> Iterator[tuple[Sample, str, str, float | None]]:
    """Ways to take a strain (3, 3, e, 9, angles) of a part of the section: (3, 3, places, angles).

    With each its name, its name of the belt's end, and the goal. The belt ends as a sharp corner in the rubber, the
    held rim as another: strains at a point grow there with every finer mesh, in both codes, and have no goal. Nor have
    means over an element, which is of another size on every mesh.
    """
    regions, weights = body.mesh.subdomains, body.rings.weights
    rubber, belt = np.concatenate([regions[name] for name in RUBBER]), regions["belt"]
    axial = body.rings.points[1][belt].mean(axis=1)
    last, end = "in the belt's last element", "at the belt's end"
    members = {**regions, "rubber": rubber, end: rubber, last: belt[axial >= axial.max() - 1e-3]}

    @functools.cache
    def patches(name: str, radius: float) -> Patches:
        return Patches(body.rings, members[name], radius, tyre.belt_edge[:, None] if name == end else None)

    for radius, goal in PATCHES.items():
        yield (
            lambda strain, name, r=radius: patches(name, r).means(strain),
            f"patch of radius {1e3 * radius:g} mm",
            end,
            goal,
        )

    def of_elements(strain: Array, name: str) -> Array:
        shares = weights[members[name]] / weights[members[name]].sum(axis=1)[:, None]
        return np.asarray(np.einsum("ijeqm,eq->ijem", strain[:, :, members[name]], shares))

    yield of_elements, "mean of an element", last, None
    yield lambda strain, name: strain[:, :, members[name]].reshape(3, 3, -1, strain.shape[-1]), "at a point", last, None


def field_difference(body: Body, ours: Solution, theirs: Solution, angles: Array) -> float:
    """Root mean square difference of the change of strain by the load over its root mean square."""
    weights = body.rings.weights[..., None] * np.gradient(angles)
    first, second = (solution.pressed - solution.inflated for solution in (ours, theirs))
    squares = [((field**2).sum(axis=(0, 1)) * weights).sum() for field in (first - second, second)]
    return float(np.sqrt(squares[0] / squares[1]))


def compare(along: int, fine: float, deflection: float = DEFLECTION, **settings: Any) -> tuple[list[Row], str]:
    """The rows of one mesh (``fine`` in degrees) and a line about it; ``settings`` of `SolidTyre`."""
    tyre = PlainTyre()
    body = tyre.body(along, settings.get("through", (1, 1, 1)))
    began = time.process_time()
    solid = SolidTyre(tyre, along, math.radians(fine), **settings)
    theirs, angles = by_felupe(solid, body, deflection)
    middle = time.process_time()
    harmonics = round(360 / fine)  # As many angles as nodes of the hexahedra near the footprint.
    ours = by_harmonics(body, harmonics, deflection, angles)
    ended = time.process_time()
    text = (
        f"{body.mesh.t.shape[1]} elements of the section, {len(solid.ends) - 1} round half the wheel, "
        f"{3 * len(solid.mesh.points)} unknowns, {middle - began:.0f} s; {harmonics} harmonics, "
        f"{ended - middle:.0f} s; "
        f"change of strain by the load differs by {100 * field_difference(body, ours, theirs, angles):.1f} % rms"
    )
    return list(rows(tyre, body, ours, theirs)), text


def over_meshes(tables: dict[str, list[Row]]) -> list[tuple[str, ...]]:
    """Harmonics; FElupe (deviation) of every strain on every mesh, with a head."""
    lines: list[tuple[str, ...]] = [("harmonics; FElupe (deviation), %", *tables)]
    for places in zip(*tables.values(), strict=True):
        if any(part in places[0].quantity for part in OVER_MESHES):
            cells = (f"{row.harmonics:.2f}; {row.felupe:.2f} ({100 * row.deviation:+.1f})" for row in places)
            lines.append((places[0].quantity, *cells))
    return lines


def harmonics_alone(meshes: Sequence[tuple[int, tuple[int, int, int]]] = FINER) -> list[tuple[str, ...]]:
    """Strains of the harmonics alone, %, on finer meshes, with a head: which of them settle."""
    columns: list[list[Row]] = []
    sizes: list[str] = []
    for along, through in meshes:
        tyre = PlainTyre()
        body = tyre.body(along, through)
        solution = by_harmonics(body, FINER_HARMONICS, DEFLECTION, FINER_ANGLES)
        taken = [
            row for row in rows(tyre, body, solution, solution) if any(part in row.quantity for part in OVER_MESHES)
        ]
        columns.append(taken)
        sizes.append(f"{body.mesh.t.shape[1]} elements")
    lines = [(places[0].quantity, *(f"{row.harmonics:.2f}" for row in places)) for places in zip(*columns, strict=True)]
    return [("harmonics alone, %", *sizes), *lines]


def print_table(lines: Sequence[Sequence[str]]) -> None:
    """Print a head and rows."""
    head, *rest = (f"| {' | '.join(cells)} |" for cells in lines)
    print("\n".join([head, "|" + "---|" * len(lines[0]), *rest]), flush=True)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="only the coarsest mesh")
    parser.add_argument("--out", type=Path, help="CSV file of all tables")
    parser.add_argument("--mesh", nargs=2, type=float, metavar=("ALONG", "DEGREES"), help="only this mesh")
    parser.add_argument("--through", type=int, default=1, help="elements through the tread of --mesh (default 1)")
    parser.add_argument("--penalty", type=float, help="contact stiffness of a tread node in FElupe, N/m")
    parser.add_argument("--full", action="store_true", help="FElupe integrates the dilatation in full: it locks")
    chosen = parser.parse_args()
    settings: dict[str, Any] = {"reduced": not chosen.full}
    if chosen.penalty:
        settings["penalty"] = chosen.penalty
    meshes = MESHES[:1] if chosen.quick else MESHES
    if chosen.mesh:
        meshes = ((int(chosen.mesh[0]), chosen.through, chosen.mesh[1]),)
    head = ("quantity", "harmonics", "FElupe", "deviation", "goal", "met")
    lines: list[tuple[str, ...]] = []
    tables: dict[str, list[Row]] = {}
    for along, through, fine in meshes:
        made, text = compare(along, fine, through=(1, 1, through), **settings)
        name = f"{along} x {fine:g}" if through == 1 else f"{along} x {fine:g}, {through} through the tread"
        tables[name] = made
        print(f"\n{along} elements along, {through} through the tread, {fine:g} degrees: {text}\n")
        print_table([head, *(row.cells for row in made)])
        lines += [(name, *row.cells) for row in made]
    if len(tables) > 1:
        print("\nStrains over the meshes:\n")
        print_table(over_meshes(tables))
        print("\nStrains by harmonics on finer meshes:\n")
        print_table(harmonics_alone())
    if chosen.out:
        with atomic_path(chosen.out) as path, path.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows([("mesh: elements along x degrees round", *head), *lines])


if __name__ == "__main__":
    main()
