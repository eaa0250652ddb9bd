"""Free vibration in closed form: rings, rigid motions, membrane under tension, order of convergence, mass."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from footprint_bodies import block, half_torus

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.elements import SectionElements
from tyrefem.mechanics.footprint.example_tyre import PlainTyre, pressurised, stress_free
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.footprint.vibration import Mode, Vibration, mass_matrix
from tyrefem.mechanics.solid.stiffened import stiffened

pytestmark = pytest.mark.fast
SHEAR, BULK, DENSITY = 1e8, 1e11, 1200.0
YOUNG = 9 * BULK * SHEAR / (3 * BULK + SHEAR)


def vibration(state: object, density: float = DENSITY) -> Vibration:
    harmonics = Harmonics(state)  # type: ignore[arg-type]
    return Vibration(harmonics, np.full(harmonics.elements.radii.shape, density))


def ring(radius: float, h: float, b: float, elements: int = 2) -> Vibration:
    r = np.linspace(radius - h / 2, radius + h / 2, elements + 1)
    return vibration(stress_free(block(r, np.linspace(-b / 2, b / 2, elements + 1)), SHEAR, BULK, fixed=()))


def lowest(body: Vibration, harmonic: int, component: int, count: int = 6) -> Mode:
    """Lowest mode above rounding whose largest displacement is this component."""
    for mode in body.modes(harmonic, count):
        if mode.frequency > 0.5 and np.abs(mode.shape).argmax() % 3 == component:
            return mode
    raise AssertionError("no such mode")


@pytest.mark.parametrize("n", [2, 3, 4])
def test_bending_of_a_free_ring_in_its_plane(n: int) -> None:
    """w^2 = n^2 (n^2 - 1)^2/(n^2 + 1) E I/(rho A R^4) (Hoppe 1871)."""
    radius, h = 1.0, 0.02
    body = ring(radius, h, 0.03)
    exact = np.sqrt(n**2 * (n**2 - 1) ** 2 / (n**2 + 1) * YOUNG * h**2 / 12 / (DENSITY * radius**4)) / (2 * np.pi)
    # Shear and rotary inertia lower it by the order of (n h/R)^2.
    assert lowest(body, n, 0).frequency == pytest.approx(exact, rel=5e-4 + 1.5 * (n * h / radius) ** 2)


def test_breathing_of_a_ring() -> None:
    """w = sqrt(E/rho)/R; the section is slender, so the stress is along the hoop only."""
    radius, h = 1.0, 0.02
    exact = np.sqrt(YOUNG / DENSITY) / radius / (2 * np.pi)
    assert lowest(ring(radius, h, h), 0, 0).frequency == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("n", [2, 3])
def test_tension_of_a_membrane_raises_its_frequency(n: int) -> None:
    """A long thin tube under pressure p: tension N = p R per length, which follows the wall.

    Inextensible ring with follower pressure: w^2 = n^2 (n^2 - 1)/(n^2 + 1) [(n^2 - 1) E* I + N R^2]/(rho h R^4), with
    E* = E/(1 - nu^2) in plane strain. The ends of the tube are held along the axis.
    """
    radius, h, pressure = 1.0, 0.004, 2e4
    mesh = block(
        [radius - h / 2, radius, radius + h / 2], [0.0, 0.05, 0.1],
        contained_air=lambda r, z: r < radius - 0.49 * h, ends=lambda r, z: (z < 1e-9) | (z > 0.1 - 1e-9),
    )  # fmt: skip
    frequencies = []
    for p in (0.0, pressure):
        plain = stress_free(mesh, SHEAR, BULK, fixed=())
        # Plane strain: the axial displacement is held everywhere.
        state = pressurised_tube(plain, p, radius, h)
        body = vibration(state)
        ends = np.arange(1, body.harmonics.elements.n_dofs, 3)
        free = np.setdiff1d(np.arange(body.harmonics.elements.n_dofs), ends)
        frequencies.append(min(mode.frequency for mode in body._family(n, 3, None, free) if mode.frequency > 0.2))
    poisson = (3 * BULK - 2 * SHEAR) / (2 * (3 * BULK + SHEAR))
    bending = YOUNG / (1 - poisson**2) * h**3 / 12
    squares = [
        n**2 * (n**2 - 1) / (n**2 + 1) * ((n**2 - 1) * bending + p * radius**3) / (DENSITY * h * radius**4)
        for p in (0.0, pressure)
    ]
    assert squares[1] > 2 * squares[0]
    for frequency, square in zip(frequencies, squares, strict=True):
        assert frequency == pytest.approx(np.sqrt(square) / (2 * np.pi), rel=5e-3)


def pressurised_tube(state: object, pressure: float, radius: float, h: float) -> object:
    """The tube with its exact hoop and radial stress (Lame)."""
    from dataclasses import replace

    if not pressure:
        return state
    r = SectionElements(state.mesh).radii  # type: ignore[attr-defined]
    inner, outer = radius - h / 2, radius + h / 2
    factor = pressure * inner**2 / (outer**2 - inner**2)
    stress = np.zeros((6, *r.shape))
    stress[0], stress[2] = factor * (1 - outer**2 / r**2), factor * (1 + outer**2 / r**2)
    return replace(state, stress=stress, pressure=pressure)  # type: ignore[type-var]


@pytest.mark.parametrize("half", [False, True])
def test_nothing_held_leaves_rigid_motions_without_frequency(half: bool) -> None:
    """Axial motion and spin for n = 0, translation and rotation for n = 1; then a gap to the first elastic mode."""
    if half:
        body = vibration(pressurised(stress_free(half_torus(), 1e6, 1e8, fixed=()), 2e5))
    else:
        body = ring(0.3, 0.02, 0.03)
    for n, free_motions in ((0, 2), (1, 2), (2, 0)):
        frequencies = [mode.frequency for mode in body.modes(n, 4)]
        assert sum(f < 0.05 for f in frequencies) == free_motions, (n, frequencies)
        assert sum(f < 1.0 for f in frequencies) == free_motions


def test_frequency_of_a_torsional_wave_converges_with_fourth_order() -> None:
    """A tube with held ends: u_t ~ sin(pi z/L), f = sqrt(G/rho)/(2 L) up to (h/R)^2; quadratic elements: order 4."""
    length, errors = 0.04, []
    for count in (2, 4, 8):
        mesh = block(
            [1.0, 1.0001], np.linspace(0.0, length, count + 1), rim=lambda r, z: (z < 1e-9) | (z > length - 1e-9)
        )
        body = vibration(stress_free(mesh, SHEAR, BULK))
        errors.append(lowest(body, 0, 2, 12).frequency / (np.sqrt(SHEAR / DENSITY) / (2 * length)) - 1)
    assert min(errors) > 0
    assert errors[-1] < 2e-5
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx([4.0, 4.0], abs=0.15)


def test_mass_is_volume_times_density_in_every_direction() -> None:
    elements = SectionElements(half_torus())
    density = np.full(elements.radii.shape, DENSITY)
    mass = mass_matrix(elements, density)
    half = 2 * np.pi**2 * 0.3 * (0.06**2 - 0.05**2) / 2
    for component in range(3):
        unit = np.zeros(elements.n_dofs)
        unit[component::3] = 1.0
        assert 2 * np.pi * unit @ mass @ unit == pytest.approx(DENSITY * half, rel=1e-2)
        assert 2 * np.pi * unit @ mass @ unit == pytest.approx(2 * np.pi * DENSITY * elements.weights.sum(), rel=1e-12)


def test_half_and_full_section_agree_and_pressure_stiffens() -> None:
    """Both families of the half are all modes of the full section; inflation raises lateral and vertical modes."""
    half = vibration(PlainTyre().state(2e5, along=12))
    full = vibration(PlainTyre(half=False).state(2e5, along=12))
    soft = vibration(PlainTyre().state(1e5, along=12))
    for n in (0, 1, 2):
        from_half = [mode.frequency for mode in half.modes(n, 4)]
        assert from_half == pytest.approx([mode.frequency for mode in full.modes(n, 4)], rel=1e-5)
        assert half.modes(n, 1)[0].frequency > 1.05 * soft.modes(n, 1)[0].frequency
    for mode in half.modes(1, 3):
        residual = half.harmonics.stiffness(1) @ mode.shape
        residual -= (2 * np.pi * mode.frequency) ** 2 * (half.mass @ mode.shape)
        free = half.families[mode.symmetric]
        assert np.abs(residual[free]).max() < 1e-6 * np.abs(half.harmonics.stiffness(1) @ mode.shape).max()
        assert mode.shape @ half.mass @ mode.shape == pytest.approx(1.0, rel=1e-9)


def test_rigid_belt_motions_are_recognised() -> None:
    body = vibration(PlainTyre().state(2e5, along=12))
    belt = np.asarray(body.harmonics.state.mesh.subdomains["belt"])
    best = {}
    for n in (0, 1):
        for mode in body.modes(n, 2):
            rigidity = body.rigidity(mode, belt)
            best[max(rigidity, key=rigidity.__getitem__)] = max(rigidity.values())
            shares = body.shares(mode, belt)
            assert sum(shares[name] for name in ("radial", "lateral", "circumferential")) == pytest.approx(1.0)
    assert set(best) == {"lateral", "wind-up", "fore-aft and vertical", "yaw and camber"}
    assert min(best.values()) > 0.9


def test_an_unstable_state_is_refused() -> None:
    """A thin ring under outer pressure beyond 3 E I/R^3 buckles in two waves."""
    from dataclasses import replace

    body = ring(1.0, 0.02, 0.02)
    stress = np.zeros((6, *body.harmonics.elements.radii.shape))
    stress[2] = -0.2 * YOUNG
    with pytest.raises(InputError, match="not stable: harmonic 2 has negative stiffness"):
        vibration(replace(body.harmonics.state, stress=stress)).modes(2, 2)


def test_twice_the_modulus_of_an_unstressed_body_is_the_root_of_two_in_frequency() -> None:
    state = PlainTyre().state(along=12)
    unstressed = replace(state, pressure=0.0, stress=np.zeros_like(state.stress), storage=state.tangent, rubber=None)
    harder = stiffened(unstressed, np.full(state.bulk.shape, 2.0))
    density = np.full(state.bulk.shape, 1100.0)
    soft, hard = (Vibration(Harmonics(each), density).modes(1, 2) for each in (unstressed, harder))
    for before, after in zip(soft, hard, strict=True):
        assert after.frequency == pytest.approx(np.sqrt(2) * before.frequency, rel=1e-8)


def test_stiffer_compounds_leave_cords_and_stresses() -> None:
    state = PlainTyre().state(along=12)
    harder = stiffened(replace(state, rubber=0.5 * state.storage), np.full(state.bulk.shape, 3.0))
    assert harder.tangent - state.tangent == pytest.approx(state.storage)
    assert harder.storage - state.storage == pytest.approx(state.storage)
    assert np.array_equal(harder.stress, state.stress)
    assert harder.bulk == pytest.approx(3.0 * state.bulk)
    same = stiffened(state, np.ones(state.bulk.shape))
    assert np.array_equal(same.tangent, state.tangent)
