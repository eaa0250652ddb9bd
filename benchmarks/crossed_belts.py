"""Belts as two single plies that cross: what the shear of the rubber between them makes of slip.

    python benchmarks/crossed_belts.py [--closed-form] [--compliance] [--slopes]

The finite elements lay half of each belt's cords at +angle and half at -angle. Here belt-1 lies at +angle and belt-2 at
-angle, in small motion about the inflated tyre, mean of the tyre and its mirror image: K_n = A is coupled with the
antisymmetric motions a quarter wave on, A - C A^-1 C'. Writes docs/evidence/tables/rolling-crossed-closed-form.csv,
rolling-crossed-compliance.csv and rolling-crossed-belts.csv. Nothing is fitted.
"""

from __future__ import annotations

import argparse
import csv
import functools
import itertools
import math
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import scipy.sparse as sp
import skfem
from numpy.typing import NDArray
from scipy.sparse.linalg import splu, spsolve

import tyrefem as tf
from tyrefem.mechanics.footprint.compliance import TreadCompliance
from tyrefem.mechanics.footprint.elements import COMPONENTS, SectionElements
from tyrefem.mechanics.footprint.harmonics import SYMMETRIC, Harmonics
from tyrefem.mechanics.rolling.pressed_shape import PressedShape
from tyrefem.mechanics.rolling.slip_curve import slip_stiffness
from tyrefem.mechanics.rolling.tread_influence import TreadInfluence
from tyrefem.mechanics.rolling.wheel_on_road import WheelOnRoad, wheel_on_road
from tyrefem.mechanics.solid.body import Body, Prestressed
from tyrefem.mechanics.solid.body_law import BodyLaw
from tyrefem.mechanics.solid.compounds import determinant, neo_hookean
from tyrefem.mechanics.solid.cords import CordLayer
from tyrefem.mechanics.solid.parts import RegionMaterial
from tyrefem.mechanics.solid.six_components import components, outer

Array = NDArray[np.float64]
ROOT = Path(__file__).resolve().parents[1]
TABLES = ROOT / "docs" / "evidence" / "tables"
STUDY = ROOT / "studies" / "measured-205-60r15" / "study.toml"
#: Region -> hand of its cords.
HANDS = {"belt-1": 1.0, "belt-2": -1.0}
MESH, HARMONICS, LOADS = "10 mm", 80, (2000.0, 4000.0, 6000.0)
#: Harmonics of the compliance.
WAVES = (0, 1, 2, 3, 5, 8, 12, 20)


def odd_tangent(state: Prestressed, hands: Mapping[str, float]) -> Array:
    """(6, 6, e, q) by how much the cords' tangent at one hand differs from the mean of both, Pa."""
    law = state.law
    assert isinstance(law, BodyLaw)
    odd = np.zeros_like(state.tangent)
    for name, hand in hands.items():
        members = law.members[name]
        f = law.inflated[:, :, members]
        for layer in law.parts[name].cords:
            for sign, direction in zip((hand, -hand), layer.directions, strict=True):
                carried = np.einsum("ij...,j...->i...", f, direction)
                x = np.linalg.norm(carried, axis=0)
                slope, curvature = layer.slopes(x)
                dyad = components(carried[:, None] * carried[None])
                odd[..., members, :] += sign / 2 * (curvature - slope / x) / x**2 * outer(dyad, dyad) / determinant(f)
    return odd


def coupling(elements: SectionElements, odd: Array) -> tuple[Any, Any, Any]:
    """C_n = C_0 + n C_1 + n^2 C_2, antisymmetric, sparse: e_b(v) : c_ba : e_a(u) less its transpose.

    a: strains with cos n t, b: the shears with sin n t, of which the odd tangent couples one with the other.
    """
    c = np.moveaxis(odd, (0, 1), (-2, -1))[..., 4:, :4] * elements.weights[..., None, None]
    e0, e1 = elements.strains

    def between(left: Array, right: Array) -> Array:
        made = np.einsum("eqbi,eqba,eqaj->eij", left[..., 4:, :], c, right[..., :4, :], optimize=True)
        return np.asarray(made - made.transpose(0, 2, 1))

    dofs, n = elements.dofs, elements.n_dofs
    place = (np.repeat(dofs, dofs.shape[1], axis=1).ravel(), np.tile(dofs, (1, dofs.shape[1])).ravel())
    parts = (between(e0, e0), between(e0, e1) + between(e1, e0), between(e1, e1))
    made = [sp.coo_matrix((part.ravel(), place), shape=(n, n)).tocsc() for part in parts]
    return made[0], made[1], made[2]


@dataclass(frozen=True, eq=False)
class CrossedBelts(TreadInfluence):
    """Points of a half section's tread whose belts are single plies.

    ``inflated``: the state with its law. ``hands``: region -> hand of its cords.
    """

    inflated: Prestressed | None = None
    hands: Mapping[str, float] = field(default_factory=lambda: HANDS)

    @functools.cached_property
    def _coupling(self) -> tuple[Any, Any, Any]:
        assert self.inflated is not None
        return coupling(self.tread.harmonics.elements, odd_tangent(self.inflated, self.hands))

    def _families(self, n: int) -> tuple[Array, Array]:
        """As `TreadInfluence`, of both families coupled in one factorisation."""
        harmonics = self.tread.harmonics
        stiffness, (c0, c1, c2) = harmonics.stiffness(n), self._coupling
        crossing = c0 + n * c1 + n * n * c2
        size = harmonics.elements.n_dofs
        free = [np.setdiff1d(np.arange(size), family.held) for family in (harmonics, self.antisymmetric)]
        across = crossing[free[0]][:, free[1]]
        blocks = [[stiffness[free[0]][:, free[0]], across], [across.T, stiffness[free[1]][:, free[1]]]]
        factor = splu(sp.bmat(blocks).tocsc(), permc_spec="MMD_AT_PLUS_A", **SYMMETRIC)
        wanted = (COMPONENTS * self.tread.nodes + np.arange(COMPONENTS)[:, None]).ravel()
        shape = (COMPONENTS, len(self.tread.nodes))
        made = []
        for dofs, start in zip(free, (0, len(free[0])), strict=True):
            place = np.full(size, -1)
            place[dofs] = start + np.arange(len(dofs))
            there = np.flatnonzero(place[wanted] >= 0)
            loads = np.zeros((len(free[0]) + len(free[1]), len(there)))
            loads[place[wanted[there]], np.arange(len(there))] = 1.0
            moved = factor.solve(loads)[place[wanted[there]]]
            compliance = np.zeros((len(wanted), len(wanted)))
            compliance[np.ix_(there, there)] = (moved + moved.T) / 2
            made.append(compliance.reshape(*shape, *shape))
        return made[0], made[1]


def two_plies(rubber: float, cords: float, angle: float, half: float, gauge: float, along: int) -> tuple[float, float]:
    """Part of the cords' hoop force that is lost at the free edges, computed and exact, of two plies on a large ring.

    The ring grows by e and does not get narrower. A ply's cords have the strain c^2 e + c s v', v the way along the
    circumference, v = 0 between the plies, free at their faces and edges: Q v_zz + G v_yy = 0, Q = k c^2 s^2 + G, so

    lost = k c^2 s^2/Q sum over odd m of 2 tanh(x)/(x (m pi/2)^2),  x = m pi b/(2 t) sqrt(G/Q).
    """
    radius = 1e3 * half
    mesh = skfem.MeshQuad.init_tensor(
        np.concatenate([np.linspace(-gauge, 0, 5), np.linspace(0, gauge, 5)[1:]]) + radius,
        half * np.sin(np.linspace(0, np.pi / 2, along + 1)),
    )
    inside = mesh.p[0, mesh.t].mean(axis=0) < radius
    mesh = mesh.with_subdomains({"belt-1": np.flatnonzero(inside), "belt-2": np.flatnonzero(~inside)})
    mesh = mesh.with_boundaries({"symmetry": lambda x: x[1] < 1e-9, "contained_air": lambda x: x[0] < radius - gauge})
    parts = {}
    for name, members in mesh.subdomains.items():
        shape = (len(members), 9)
        meridian = np.stack([np.zeros(shape), np.ones(shape)])
        layer = CordLayer(np.full(shape, angle), meridian, np.full(shape, cords))
        parts[name] = RegionMaterial(neo_hookean(rubber), (layer,))
    body = Body(mesh, parts, {"symmetry": "z"})
    state = body.state(np.zeros((2, body.rings.n_nodes)), 0.0)
    harmonics = Harmonics(state)
    elements = harmonics.elements
    crossing, _, _ = coupling(elements, odd_tangent(state, HANDS))
    grown = np.zeros((elements.n_nodes, COMPONENTS))
    grown[:, 0] = elements.nodes[0]
    # The other motions: along the circumference alone, none on the mid plane.
    free = np.setdiff1d(
        COMPONENTS * np.arange(elements.n_nodes) + 2, COMPONENTS * elements.boundary_nodes("symmetry") + 2
    )
    load = (crossing.T @ grown.ravel())[free]
    given = float(load @ spsolve(harmonics.stiffness(0)[free][:, free].tocsc(), load))
    cosine, sine = math.cos(angle), math.sin(angle)
    whole = float((elements.weights * cords * cosine**4).sum())
    q = cords * cosine**2 * sine**2 + rubber
    m = np.arange(1, 4001, 2) * np.pi / 2
    x = m * half / gauge * math.sqrt(rubber / q)
    exact = (q - rubber) / q * float((2 * np.tanh(x) / (x * m**2)).sum())
    return given / whole, exact


def closed_form() -> None:
    """Two plies against the series."""
    rows = []
    for angle, half, rubber in itertools.product((20, 26), (0.04, 0.08), (2.5e6, 5e6)):
        computed, exact = two_plies(rubber, 24e9, math.radians(angle), half, 1.25e-3, 40)
        rows.append({
            "angle [deg]": angle, "half width [mm]": f"{1e3 * half:g}", "rubber [MPa]": f"{rubber / 1e6:g}",
            "lost hoop force, computed": f"{computed:.4f}", "exact": f"{exact:.4f}",
            "deviation [%]": f"{100 * (computed / exact - 1):+.2f}",
        })  # fmt: skip
    write("rolling-crossed-closed-form", rows)


def compliance() -> None:
    """Compliance of the inflated tyre under loads that are even across its tread, over that of averaged belts."""
    rows = []
    for angle in (20, 26):
        pressed = study_at(angle).press(motion="linear")
        tread = pressed.pressing.tread
        averaged, crossed = TreadInfluence(tread), CrossedBelts(tread, inflated=pressed.tyre.state)
        share = averaged.lengths / averaged.lengths.sum()
        for n in WAVES:
            before, after = (np.einsum("anam,n,m->a", points.solved(n), share, share) for points in (averaged, crossed))
            words = (f"{name} over averaged" for name in ("radial", "sideways", "along"))
            ratios = dict(zip(words, (f"{ratio:.3f}" for ratio in after / before), strict=True))
            rows.append({
                "belt angle [deg]": angle, "harmonic": n, **ratios,
            })  # fmt: skip
    write("rolling-crossed-compliance", rows)


def study_at(angle: float) -> Any:
    """The measured tyre with an angle of the belts' cords, deg."""
    cords = {f"materials.belt-{ply}.cords.angle": f"{angle} deg" for ply in (1, 2)}
    return tf.study(STUDY).replace({"mesh.size": MESH, **cords})


def with_single_plies(wheel: WheelOnRoad) -> WheelOnRoad:
    """A wheel without loss, on the same footprint, whose belts are single plies for friction."""
    tread = TreadCompliance(wheel.pressed.pressing.tread.harmonics)
    points = CrossedBelts(tread, inflated=wheel.pressed.tyre.state)
    shape = None if wheel.rolling.shape is None else PressedShape(wheel.pressed.footprint, points)
    return replace(wheel, rolling=replace(wheel.rolling, influence=points, shape=shape))


def slopes() -> None:
    """Slopes of slip with both kinds of belts; in large motion friction moves the tread as the inflated tyre's."""
    rows = []
    for motion, angle, load in itertools.product(("linear", "large"), (20,), LOADS):
        wheel = wheel_on_road(study_at(angle), load=load, friction=1.0, motion=motion)
        if wheel.rolling.shape is not None:
            inflated = replace(wheel.rolling.shape, loaded=None)
            wheel = replace(wheel, rolling=replace(wheel.rolling, shape=inflated))
        for belts, rolling in (("averaged", wheel), ("crossed", with_single_plies(wheel))):
            made = slip_stiffness(rolling, HARMONICS)
            rows.append({
                "motion": motion, "belt angle [deg]": angle, "load [N]": f"{load:g}", "belts": belts,
                "cornering stiffness [kN/rad]": f"{made.cornering / 1e3:.1f}",
                "slip stiffness [kN]": f"{made.slip / 1e3:.1f}", "trail [mm]": f"{1e3 * made.trail:.1f}",
            })  # fmt: skip
            write("rolling-crossed-belts", rows)


def write(name: str, rows: list[dict[str, Any]]) -> None:
    """Write a table, print its last row."""
    with (TABLES / f"{name}.csv").open("w", encoding="utf-8", newline="") as stream:
        table = csv.DictWriter(stream, rows[0], lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    print(*rows[-1].values(), flush=True)


def main(arguments: Iterable[str] | None = None) -> None:
    """Run the parts that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parts = {"closed-form": closed_form, "compliance": compliance, "slopes": slopes}
    for name in parts:
        parser.add_argument(f"--{name}", action="store_true")
    chosen = vars(parser.parse_args(None if arguments is None else list(arguments)))
    for part in [part for name, part in parts.items() if chosen[name.replace("-", "_")]] or list(parts.values()):
        part()


if __name__ == "__main__":
    main()
