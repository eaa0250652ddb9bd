"""Critical speeds of rings in closed form: bending, tension, elastic bed, string; mass of steady motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
import skfem

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.example_tyre import stress_free
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.footprint.vibration import Vibration
from tyrefem.mechanics.rolling.standing_waves import SteadyWaves, steady_mass
from tyrefem.mechanics.solid.body import Prestressed
from tyrefem.mechanics.solid.spin import rolled

pytestmark = pytest.mark.fast
SHEAR, BULK, DENSITY = 1e8, 1e11, 1200.0
YOUNG = 9 * BULK * SHEAR / (3 * BULK + SHEAR)
RADIUS, WIDTH = 1.0, 0.02


def ring(h: float, *, tension: float = 0.0, bed: float = 0.0) -> Prestressed:
    """A ring of section h x WIDTH under a hoop force, N, on a radial elastic bed, N/m2 per length of the hoop."""
    mesh = skfem.MeshQuad.init_tensor(
        np.linspace(RADIUS - h / 2, RADIUS + h / 2, 3), np.linspace(-WIDTH / 2, WIDTH / 2, 3)
    )
    state = stress_free(mesh, SHEAR, BULK, fixed=())
    stress = np.zeros_like(state.stress)
    stress[2] = tension / (h * WIDTH)
    state = replace(state, stress=stress)
    elements = Harmonics(state).elements
    springs = np.zeros(elements.n_dofs)
    if bed:
        middle = np.flatnonzero(np.abs(elements.nodes[0] - RADIUS) < 1e-9)
        # Simpson's rule over the width: 1 4 2 4 1; per radian the hoop's length is R.
        order = middle[np.argsort(elements.nodes[1, middle])]
        springs[3 * order] = bed * RADIUS * np.array([1, 4, 2, 4, 1]) / 12
    # A weak support holds rigid motions.
    return replace(state, support=sp.diags(springs + 1e-3))


def slowest(state: Prestressed, n: int) -> float:
    vibration = Vibration(Harmonics(state), np.full(state.bulk.shape, DENSITY))
    waves = SteadyWaves(vibration).waves(n, 4)
    return next(w.angular_speed for w in waves if np.abs(w.shape).argmax() % 3 == 0)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_bending_of_a_free_ring(n: int) -> None:
    """W^2 = n^2 E I/(rho A R^4): K = E I n^2 (n^2 - 1)^2/R^4 over M = rho A (n^2 - 1)^2, u_t = - u_r/n.

    The ring's frequency (Hoppe) over n lacks the Coriolis term: w_n/n is smaller by (n^2 - 1)/sqrt(n^2 (n^2 + 1)) here.
    """
    h = 0.02
    exact = n * np.sqrt(YOUNG * h**2 / 12 / (DENSITY * RADIUS**4))
    assert slowest(ring(h), n) == pytest.approx(exact, rel=5e-4 + 1.5 * (n * h / RADIUS) ** 2)


@pytest.mark.parametrize("n", [2, 3, 6])
def test_tension_of_a_string(n: int) -> None:
    """A loop without bending stiffness, hoop force N: W = sqrt(N/(rho A))/R at every n, the speed of its waves."""
    h = 0.002
    tension = 20.0 * YOUNG * WIDTH * h**3 / 12 * n**2 / RADIUS**2 * 40
    bending = n**2 * YOUNG * WIDTH * h**3 / 12 / RADIUS**2
    exact = np.sqrt((tension + bending) / (DENSITY * h * WIDTH)) / RADIUS
    assert slowest(ring(h, tension=tension), n) == pytest.approx(exact, rel=3e-3)


def test_ring_under_tension_on_an_elastic_bed() -> None:
    """W_n^2 rho A R^2 (n^2 - 1)^2 = (E I n^2/R^2 + N)(n^2 - 1)^2 + k n^2 R^2: least where bending meets the bed."""
    h = 0.01
    area, inertia = h * WIDTH, WIDTH * h**3 / 12
    tension, bed = 20.0, 500.0
    state = ring(h, tension=tension, bed=bed)
    orders = np.arange(2, 11)
    stiffness = (YOUNG * inertia * orders**2 / RADIUS**2 + tension) * (orders**2 - 1) ** 2
    stiffness += bed * (orders * RADIUS) ** 2
    exact = np.sqrt(stiffness / (DENSITY * area)) / (orders**2 - 1) / RADIUS
    computed = np.array([slowest(state, int(n)) for n in orders])
    assert computed == pytest.approx(exact, rel=1e-2)
    least = int(orders[computed.argmin()])
    assert least == int(orders[exact.argmin()])
    assert 2 < least < 10
    assert computed.min() == pytest.approx(exact.min(), rel=3e-3)
    # The usual estimate, w_n/n of the ring that does not turn, lacks the Coriolis term.
    still = Vibration(Harmonics(state), np.full(state.bulk.shape, DENSITY))
    for n, speed in zip(orders[2:], computed[2:], strict=True):
        bending = next(m for m in still.modes(int(n), 6) if np.abs(m.shape).argmax() % 3 == 0)
        usual = 2 * np.pi * bending.frequency / n
        assert usual / speed == pytest.approx((n**2 - 1) / (n * np.sqrt(n**2 + 1)), rel=5e-3)


def test_centrifugal_tension_of_a_free_loop_leaves_no_critical_speed() -> None:
    """N = N_0 + rho A (W R)^2 in the loop: waves on it always run faster than the loop turns."""
    h, speed = 0.002, 100.0
    flux = DENSITY * h * WIDTH * (speed * RADIUS) ** 2
    dynamic = Harmonics(rolled(ring(h, tension=flux + 10.0), np.full((4, 9), DENSITY), speed))
    slack = Harmonics(rolled(ring(h, tension=flux - 10.0), np.full((4, 9), DENSITY), speed))
    for n in (3, 8):
        least = [np.linalg.eigvalsh(loop.stiffness(n).toarray())[0] for loop in (dynamic, slack)]
        assert least[0] > 0
        # Without the tension N_0 > 0 the bending stiffness alone is left, which is less than 10 N at three crests.
        assert (least[1] > 0) == (n**2 * YOUNG * WIDTH * h**3 / 12 / RADIUS**2 > 10.0)


def test_one_crest_is_no_wave() -> None:
    with pytest.raises(InputError, match="two or more crests"):
        SteadyWaves(Vibration(Harmonics(ring(0.02)), np.full((4, 9), DENSITY))).waves(1)


def test_steady_mass_is_definite_from_two_crests() -> None:
    for n in (2, 3, 7):
        values = np.linalg.eigvalsh(steady_mass(sp.identity(3), n).toarray())
        assert values == pytest.approx([(n - 1) ** 2, n**2, (n + 1) ** 2])
