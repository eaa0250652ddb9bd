"""The strain law "barrel": means what the arcs do, exact where a closed form is known, refusing the impossible."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest
import skfem

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.inputs.loading import LoadCase
from tyrefem.mechanics.barrel import Barrel, provider
from tyrefem.mechanics.cycle_schedule import cycle_schedule
from tyrefem.mechanics.point_energies import GaussPoints
from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.compounds import neo_hookean
from tyrefem.mechanics.solid.cords import CordLayer
from tyrefem.mechanics.solid.flattening import flatten
from tyrefem.mechanics.solid.inflation import Inflation
from tyrefem.mechanics.solid.newton import equilibrium
from tyrefem.mechanics.solid.parts import RegionMaterial
from tyrefem.mechanics.strain_cycle import StrainCycle

COARSE = {"mechanics.strain": "barrel", "mesh.size": "10 mm", "drive.duration": "60 s"}
NAME = "nasa-22x5.5-8pr"


@functools.cache
def study() -> tf.Study:
    return tf.study(NAME, COARSE)


@functools.cache
def cycle() -> StrainCycle:
    """At the shipped drive's load."""
    return cycle_schedule(study()).cycles[0][0]


def ring(cords: bool = False) -> Inflation:
    """1 m inside, 2 m outside, plane strain; rubber of G = 1 MPa."""
    mesh = skfem.MeshQuad.init_tensor(np.linspace(1, 2, 7), [0.0, 0.5])
    mesh = mesh.with_boundaries(
        {"contained_air": lambda x: x[0] < 1 + 1e-9, "road": lambda x: x[0] > 2 - 1e-9, "ends": lambda x: x[0] > 0}
    ).with_subdomains({"rubber": np.arange(6)})
    shape = (6, 9)
    layer = CordLayer(np.zeros(shape), np.stack([np.ones(shape), np.zeros(shape)]), np.full(shape, 1e8))
    body = Body(mesh, {"rubber": RegionMaterial(neo_hookean(1e6, 1e8), (layer,) if cords else ())}, {"ends": "z"})
    return Inflation(body, equilibrium(body, 0.0), half=False)


def case(deflection: float) -> LoadCase:
    return LoadCase(1.0, deflection, 1.0, 2.0)


def test_energy_of_a_ring_is_that_of_its_strains() -> None:
    """U = G e' : e' of Lame's strains A -+ B/r^2; for plane strain with u(2) = -D and nothing at r = 1."""
    d, shear, bulk = 1e-4, 1e6, 1e8
    tyre = ring()
    barrel = Barrel(tyre, flatten(tyre, d), case(d))
    ratio = (bulk + shear / 3) / shear
    A = -d / (2 + ratio / 2)
    r = tyre.body.rings.points[0]
    e = np.stack([A - A * ratio / r**2, 0 * r, A + A * ratio / r**2])
    deviator = e - e.mean(axis=0)
    exact = shear * (deviator**2).sum(axis=0)
    weights = tyre.body.rings.weights
    # Element by element: at single Gauss points the radial strain is of second order only.
    sums = [(density * weights).sum(axis=1) for density in (barrel.density, exact)]
    np.testing.assert_allclose(sums[0], sums[1], rtol=2e-3)


def test_cords_that_lose_nothing_count_nothing() -> None:
    """The energy of a ring whose hoop cords are a hundred times stiffer is still that of the rubber's strain."""
    d = 1e-3
    plain, corded = ring(), ring(cords=True)
    energies = [Barrel(tyre, flatten(tyre, d), case(d)).density for tyre in (plain, corded)]
    flat = flatten(corded, d)
    assert flat.force > 10 * flatten(plain, d).force
    strain = flat.strain
    deviator = strain[:3] - strain[:3].mean(axis=0)
    np.testing.assert_allclose(energies[1], 1e6 * ((deviator**2).sum(axis=0) + strain[3] ** 2 / 2), rtol=5e-3)


def test_the_crown_is_shortened_by_the_deflection_of_the_load_law() -> None:
    """The tread under the cylinder lies on the radius R - D, D that of TR R-64 as for the arcs."""
    barrel = cycle()
    assert isinstance(barrel, Barrel)
    arcs = cycle_schedule(study().replace({"mechanics.strain": "arcs"})).cases[0][0]
    assert barrel.case.deflection == arcs.deflection > 0.029
    flat = barrel.flat
    assert flat is not None
    inflated = barrel.tyre.places[0, flat.nodes]
    touched = flat.forces > 0
    np.testing.assert_allclose(flat.places[0, flat.nodes][touched], inflated.max() - arcs.deflection, rtol=1e-9)
    # A thin tyre would press with the gas; bending at the edges carries the rest.
    assert flat.force / (2 * np.pi * flat.radius * flat.width) == pytest.approx(barrel.case.pressure, rel=0.25)


def test_every_region_is_strained_and_none_of_it_negatively() -> None:
    barrel = cycle()
    assert isinstance(barrel, Barrel)
    assert barrel.density.min() >= 0
    for zone in barrel.zones:
        assert barrel.density[barrel.tyre.body.mesh.subdomains[zone.region]].max() > 1e3


def test_energy_falls_with_the_square_of_small_deflections_to_zero() -> None:
    made = provider(study())
    start = replace(study_case(), deflection=0.0)
    crown = study().section.place([0.0], [4e-3]).T
    assert made(start).energy_density("carcass", crown).tolist() == [0.0]
    small, double = (made(replace(start, deflection=d)).energy_density("carcass", crown)[0] for d in (0.25e-3, 0.5e-3))
    # Contact widens with the deflection, so a little more than four times at one place.
    assert 3.5 < double / small < 7


def study_case() -> LoadCase:
    solved = cycle()
    assert isinstance(solved, Barrel)
    return solved.case


def test_a_run_makes_the_heat_of_its_energy() -> None:
    """Cold drag times the way of a revolution: sum of pi U tan d over the regions (eq 26)."""
    barrel = cycle()
    assert isinstance(barrel, Barrel)
    result = study().run()
    weights = barrel.tyre.body.rings.weights
    lost = 0.0
    for region in barrel.tyre.body.parts:
        members = barrel.tyre.body.mesh.subdomains[region]
        tangent = float(study().materials[region].loss_tangent(25.0))
        lost += 4 * np.pi * tangent * float((barrel.density * weights)[members].sum())
    force = lost / (2 * barrel.case.rolling_radius)
    # Other quadrature: nearest Gauss points at the nodes of the thermal mesh.
    assert result.rolling_resistance.cold_force == pytest.approx(force, rel=0.04)
    assert result.heat_budget.imbalance < 1e-6


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"drive.pressure": "0 kPa", "drive.load": "1 kN"},
            "drive.pressure: 1000 N at 0 kPa: the strain laws 'fem' and 'barrel' need",
        ),
        ({"drive.load": "12000 lbf"}, r"drive.deflection: .* mm is impossible; .* where the crown meets the rim"),
    ],
)
def test_what_is_impossible_is_one_error(changes: dict[str, str], words: str) -> None:
    with pytest.raises(InputError, match=words):
        cycle_schedule(tf.study(NAME, COARSE | changes))


def test_interpolation_keeps_to_the_region() -> None:
    """A step between two regions stays a step; constants stay constants; further axes are carried along."""
    mesh = skfem.MeshQuad.init_tensor([1.0, 1.1, 1.2], [0.0, 0.1]).with_subdomains({"a": [0], "b": [1]})
    body = Body(mesh, {name: RegionMaterial(neo_hookean(1e6)) for name in "ab"}, {"top": "z"})
    points = GaussPoints.of(body.rings)
    left = int(np.argmin(body.rings.points[0].mean(axis=1)))
    values = np.zeros((3, 2, 9))
    values[:, left] = np.array([[1.0], [2.0], [3.0]])
    names = {left: "a" if left == 0 else "b"}
    border = np.array([[1.1, 1.1], [0.03, 0.08]])
    np.testing.assert_allclose(points.interpolate(values, names[left], border).T, [[1.0, 2.0, 3.0]] * 2)
    np.testing.assert_allclose(points.interpolate(values, "b" if names[left] == "a" else "a", border), 0.0)


def test_a_full_section_is_pressed_as_its_half() -> None:
    """Both sides meshed: the same force of the whole tyre and, by symmetry, the same energy."""
    halves = []
    for section in ("half", "full"):
        study = tf.study(NAME, COARSE | {"mesh.size": "12 mm", "mesh.section": section})
        made = provider(study)(replace(study_case(), deflection=6e-3))
        assert isinstance(made, Barrel)
        assert made.flat is not None
        sides = 2 if section == "half" else 1
        halves.append((made.flat.force, sides * float((made.density * made.tyre.body.rings.weights).sum())))
    assert halves[0] == pytest.approx(halves[1], rel=1e-6)
