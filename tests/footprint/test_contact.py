"""Contact: complementarity, Hertz, convergence, drum, camber, impossible loads."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
import skfem
from footprint_bodies import block
from hypothesis import given, settings
from hypothesis import strategies as st

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.complementarity import contact_forces
from tyrefem.mechanics.footprint.compliance import interpolation, solved_harmonics
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre, stress_free
from tyrefem.mechanics.footprint.road import Road

pytestmark = pytest.mark.fast


@pytest.fixture(scope="module")
def tyre() -> Pressing:
    return Pressing(PlainTyre().state(along=14))


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 25))
def test_forces_never_pull_and_nothing_penetrates(seed: int, size: int) -> None:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(size, size))
    compliance = root @ root.T + 0.05 * np.eye(size)
    gaps = rng.normal(size=size)
    forces, closed = contact_forces(compliance, gaps)
    left = gaps + compliance @ forces
    assert forces.min() >= 0
    assert left.min() > -1e-8
    assert np.abs(forces * left).max() < 1e-8 * max(forces.max(), 1.0)
    assert not forces[~closed].any()


@pytest.mark.parametrize("harmonics", [24, 54])
def test_footprint_is_complementary_and_carries_its_load(tyre: Pressing, harmonics: int) -> None:
    footprint = tyre.at_deflection(0.02, harmonics)
    assert footprint.pressure.min() >= 0
    assert footprint.gaps.min() > -1e-12
    assert np.abs(footprint.forces * footprint.gaps).max() < 1e-9 * footprint.forces.max() * 0.02
    assert footprint.pressure_integral == pytest.approx(footprint.load, rel=1e-12)
    # The whole contact lies within the angles that were allowed to touch.
    assert not footprint.pressure[-1].any()


def test_work_of_the_forces_is_the_elastic_energy_of_all_harmonics(tyre: Pressing) -> None:
    """1/2 sum of forces times displacements = sum of pi/2 u_n K_n u_n (pi for n = 0), both halves."""
    footprint = tyre.at_deflection(0.015, 24)  # every harmonic is solved, none interpolated
    energy = sum(
        (np.pi if n == 0 else np.pi / 2) * u @ (tyre.harmonics.stiffness(n) @ u)
        for n, u in enumerate(footprint.amplitudes)
    )
    assert 2 * energy == pytest.approx(footprint.work, rel=1e-9)


def test_the_displacement_field_meets_the_road(tyre: Pressing) -> None:
    """Summed from the amplitudes, the tread in contact lies at the loaded radius, within a harmonic's resolution."""
    footprint = tyre.at_deflection(0.02, 80)
    nodes, n = tyre.tread.nodes, np.arange(81)[:, None]
    t = footprint.grid.angles[1]
    u = footprint.amplitudes.reshape(81, -1, 3)[:, nodes]
    u_r, u_t = (np.cos(n * t) * u[:, :, 0]).sum(axis=0), (np.sin(n * t) * u[:, :, 2]).sum(axis=0)
    down = (tyre.tread.places[0] + u_r) * math.cos(t) - u_t * math.sin(t)
    assert down == pytest.approx(np.full_like(down, footprint.loaded_radius), abs=2.5e-4)


def test_stiffness_is_the_slope_of_the_load(tyre: Pressing) -> None:
    h = 2e-6
    loads = [tyre.at_deflection(0.0201 + s * h, 36).load for s in (-1, 1)]
    assert tyre.at_deflection(0.0201, 36).stiffness == pytest.approx((loads[1] - loads[0]) / (2 * h), rel=1e-6)


def test_deflection_of_a_load_and_load_of_a_deflection_agree(tyre: Pressing) -> None:
    loaded = tyre.at_load(3000.0, 36)
    assert loaded.load == pytest.approx(3000.0, rel=1e-8)
    assert tyre.at_deflection(loaded.deflection, 36).load == pytest.approx(3000.0, rel=1e-7)


def test_load_grows_faster_than_the_deflection_and_the_footprint_with_it(tyre: Pressing) -> None:
    footprints = [tyre.at_deflection(d, 54) for d in (0.004, 0.01, 0.02, 0.03)]
    loads, areas = [f.load for f in footprints], [f.area for f in footprints]
    assert all(b > a for a, b in itertools.pairwise(areas))
    assert loads[1] / 0.01 > loads[0] / 0.004
    assert footprints[2].rolling_radius > footprints[2].loaded_radius
    assert footprints[2].rolling_radius < tyre.reach


@pytest.mark.parametrize("deflection", [0.016, 0.018, 0.0195, 0.022, 0.026])
def test_length_and_area_are_known_to_a_part_of_the_step_between_angles(tyre: Pressing, deflection: float) -> None:
    """With 100 and 120 harmonics both are those of 400 within 2 %; a step is 7 to 10 % of the length."""
    fine = tyre.at_deflection(deflection, 400)
    for harmonics in (100, 120):
        footprint = tyre.at_deflection(deflection, harmonics)
        assert footprint.length == pytest.approx(fine.length, rel=0.02)
        assert footprint.area == pytest.approx(fine.area, rel=0.02)


def test_length_grows_without_jumps(tyre: Pressing) -> None:
    """While each end passes an angle, 0.2 mm of deflection add 2 to 8 % of the step between angles to it."""
    lengths = np.array([tyre.at_deflection(d, 120).length for d in np.arange(0.015, 0.0205, 0.0002)])
    step = np.pi * tyre.reach / 120
    grown = np.diff(lengths) / 2 / step
    assert grown.sum() > 1
    assert grown.min() > 0.02
    assert grown.max() < 0.08


def test_hertz_line_contact_of_a_solid_roller() -> None:
    """Plane strain, incompressible: a = sqrt(4 F' R/(pi E*)), p0 = 2 F'/(pi a), E* = 4 G (Johnson 1985)."""
    shear, width = 1e6, 0.02
    r = np.concatenate([np.linspace(0.25, 0.7, 7), 1 - 0.3 * np.linspace(1, 0, 15)[1:] ** 1.8])
    mesh = block(
        r,
        [0.0, width],
        rim=lambda r, z: r < 0.251,
        road=lambda r, z: r > 0.9999,
        symmetry=lambda r, z: np.isin(z, (0, width)),
    )
    roller = Pressing(stress_free(mesh, shear, 1e4 * shear))
    footprint = roller.at_deflection(0.008, 400)
    per_width = footprint.load / (2 * width)
    half = math.sqrt(4 * per_width / (math.pi * 4 * shear))
    middle = footprint.pressure[:, 1]
    assert footprint.length / 2 == pytest.approx(half, rel=0.03)
    assert middle[0] == pytest.approx(2 * per_width / (math.pi * half), rel=0.015)
    x = footprint.grid.angles
    inside = x < 0.8 * half
    ellipse = middle[0] * np.sqrt(1 - (x[inside] / half) ** 2)
    assert middle[inside] == pytest.approx(ellipse, rel=0.02)


def test_more_harmonics_converge(tyre: Pressing) -> None:
    works = [tyre.at_deflection(0.02, n).work for n in (12, 24, 48, 96)]
    changes = np.abs(np.diff(works)) / works[-1]
    assert changes[-1] < 1e-3
    assert changes[0] > 3 * changes[2]


def test_finer_meshes_converge() -> None:
    loads = [Pressing(PlainTyre().state(along=n)).at_deflection(0.02, 24).load for n in (8, 16, 32)]
    assert abs(loads[2] - loads[1]) < 0.02 * loads[2]
    assert abs(loads[1] - loads[0]) > abs(loads[2] - loads[1])


def test_error_measure_is_met_and_reported(tyre: Pressing) -> None:
    footprint = tyre.solve(load=3000.0, tolerance=0.01)
    assert footprint.error <= 0.01
    finest = tyre.at_load(3000.0, 120, footprint)
    assert footprint.deflection == pytest.approx(finest.deflection, rel=0.01)
    assert footprint.work == pytest.approx(finest.work, rel=0.01)


def test_interpolated_harmonics_are_nearly_the_solved_ones(tyre: Pressing) -> None:
    weights = interpolation(60)
    assert weights.sum(axis=1) == pytest.approx(1.0)
    assert set(range(25)) < set(solved_harmonics(60))
    guess = tyre.tread.up_to(60)[40]
    exact = tyre.tread.solved(40)
    assert 40 not in solved_harmonics(60)
    assert np.abs(guess - exact).max() < 2e-4 * np.abs(exact).max()


def test_a_large_drum_is_a_flat_road_and_a_small_one_is_softer(tyre: Pressing) -> None:
    state, flat = tyre.state, tyre.at_deflection(0.02, 36)
    assert Pressing(state, Road(1e4)).at_deflection(0.02, 36).load == pytest.approx(flat.load, rel=1e-4)
    drum = Pressing(state, Road(1.7)).at_deflection(0.02, 54)
    assert drum.load < 0.98 * flat.load
    assert drum.length < flat.length
    assert drum.gaps.min() > -1e-9


def test_the_gap_of_a_huge_drum_is_that_of_a_flat_road_to_rounding() -> None:
    """Rounded to the drum's radius, 1e-9 m here, it kept forces with friction from settling."""
    points = np.array([[0.0, 0.05, -0.1], [0.29, 0.288, 0.3], [0.0, 0.05, -0.05]])
    flat, _ = Road(camber=0.02).gaps(points, 0.3)
    drum, _ = Road(1e8, 0.02).gaps(points, 0.3)
    assert drum == pytest.approx(flat + points[0] ** 2 / 1e8, abs=1e-15)


def test_pressure_stiffens() -> None:
    soft, hard = (Pressing(PlainTyre().state(pressure=p, along=10)).at_deflection(0.015, 24).load for p in (1.2e5, 2e5))
    assert 1.15 * soft < hard < 2e5 / 1.2e5 * soft


def test_camber_loads_one_shoulder_and_the_full_section_repeats_the_half() -> None:
    body = PlainTyre(half=False).state(along=10)
    half = Pressing(PlainTyre().state(along=10)).at_deflection(0.015, 24)
    upright = Pressing(body).at_deflection(0.015, 24)
    assert upright.load == pytest.approx(half.load, rel=1e-9)
    tilted = Pressing(body, Road(camber=math.radians(2))).at_deflection(0.015, 24)
    z = tilted.grid.tread.places[1]
    moment = (tilted.pressure.sum(axis=0) * tilted.grid.tread.widths[0] * z).sum()
    assert moment > 0.1 * (tilted.pressure.sum(axis=0) * tilted.grid.tread.widths[0] * abs(z)).sum()
    mirrored = Pressing(body, Road(camber=math.radians(-2))).at_deflection(0.015, 24)
    assert mirrored.pressure[:, ::-1] == pytest.approx(tilted.pressure, abs=1e-6 * tilted.pressure.max())


def test_a_hollow_tread_is_as_wide_on_a_half_section_as_on_the_full() -> None:
    """Only its shoulders touch: the half had their widths alone, 77 mm of 105 mm."""
    widths = []
    for half in (True, False):
        state = PlainTyre(half=half).state(along=10)
        mesh, places = state.mesh, state.mesh.p.copy()
        outside = np.unique(mesh.facets[:, mesh.boundaries["road"]])
        places[0, outside] -= 5e-3 * np.clip(1 - np.abs(places[1, outside]) / 0.05, 0, None)
        hollow = skfem.MeshQuad(places, mesh.t, sort_t=False).with_subdomains(mesh.subdomains)
        pressed = Pressing(replace(state, mesh=hollow.with_boundaries(mesh.boundaries))).at_deflection(6e-3, 54)
        middle = int(np.abs(pressed.grid.tread.places[1]).argmin())
        assert pressed.load > 0
        assert not pressed.pressure[:, middle].any()
        widths.append(pressed.width)
    assert widths[0] == pytest.approx(widths[1], rel=1e-9)


def test_impossible_requests_get_one_clear_error(tyre: Pressing) -> None:
    with pytest.raises(InputError, match=r"cannot carry .* N: the crown meets the rim"):
        tyre.at_load(1e6, 24)
    with pytest.raises(InputError, match=r"less than .* where the crown meets the rim"):
        tyre.at_deflection(0.2, 24)
    with pytest.raises(InputError, match="at least 0"):
        tyre.at_deflection(-0.01, 24)
    with pytest.raises(InputError, match="must be positive"):
        tyre.at_load(-5.0, 24)
    with pytest.raises(InputError, match="exactly one"):
        tyre.solve()
    with pytest.raises(InputError, match="camber needs a full section"):
        Pressing(tyre.state, Road(camber=0.1))
    with pytest.raises(InputError, match="drum"):
        Road(drum_diameter=-1.0)
    assert tyre.at_deflection(0.0, 24).load == 0


def test_a_slight_deflection_is_not_without_load(tyre: Pressing) -> None:
    """Few harmonics average its contact away; more of them, or an error, not 0 N."""
    assert tyre.at_deflection(1e-4, 24).load == tyre.at_deflection(1e-4, 36).load == 0.0
    assert tyre.solve(deflection=1e-4, tolerance=0.5).load > 0
    with pytest.raises(InputError, match=r"0\.001 mm is too little: 270 harmonics find no contact") as caught:
        tyre.solve(deflection=1e-6)
    assert caught.value.field == "deflection"
    assert tyre.solve(deflection=0.0).load == 0.0


@pytest.mark.parametrize(("name", "given", "words"), [("load", 1e-3, "0.001 N"), ("deflection", 1e-4, "0.1 mm")])
def test_a_slight_contact_without_convergence_names_the_load(
    tyre: Pressing, name: str, given: float, words: str
) -> None:
    """A drive has no key 'tolerance'."""
    with pytest.raises(InputError, match=f"{words}: 270 harmonics leave an error of") as caught:
        tyre.solve(**{name: given}, tolerance=1e-4)
    assert caught.value.field == name


def test_a_load_too_slight_to_resolve_is_not_called_too_heavy(tyre: Pressing) -> None:
    with pytest.raises(InputError, match="does not settle under 1e-06 N with 24 harmonics") as caught:
        tyre.at_load(1e-6, 24)
    assert caught.value.field == "load"


def test_a_tyre_is_not_pressed_past_the_axis_of_its_drum(tyre: Pressing) -> None:
    """Beyond it the drum's far side would push the tyre out: loads fall, and change their sign."""
    small = Pressing(tyre.state, Road(drum_diameter=0.06))
    assert small.bottoming == 0.03 < tyre.bottoming
    loads = [small.at_deflection(deflection, 24).load for deflection in (0.01, 0.02, 0.029)]
    assert 0 < loads[0] < loads[1] < loads[2]
    with pytest.raises(InputError, match=r"less than 30 mm, where the tyre meets the drum's axis"):
        small.at_deflection(0.032, 24)
    with pytest.raises(InputError, match=r"cannot carry .* N: the tyre meets the drum's axis at"):
        small.at_load(1e6, 24)
