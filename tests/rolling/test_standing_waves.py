"""Critical speeds of rings in closed form: bending, tension, elastic bed, string; mass of steady motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.rolling.critical_speed import critical_speed
from tyrefem.mechanics.rolling.example_rings import ElasticRing
from tyrefem.mechanics.rolling.standing_waves import SteadyWaves, steady_mass
from tyrefem.mechanics.solid.spin import rolled

pytestmark = pytest.mark.fast
RADIUS = 1.0


@pytest.mark.parametrize("n", [2, 3, 4])
def test_bending_of_a_free_ring(n: int) -> None:
    """W^2 = n^2 E I/(rho A R^4): K = E I n^2 (n^2 - 1)^2/R^4 over M = rho A (n^2 - 1)^2, u_t = - u_r/n.

    The ring's frequency (Hoppe) over n lacks the Coriolis term: w_n/n is smaller by (n^2 - 1)/sqrt(n^2 (n^2 + 1)) here.
    """
    ring = ElasticRing(0.02)
    assert ring.slowest(n) == pytest.approx(ring.critical(n), rel=5e-4 + 1.5 * (n * ring.thickness / RADIUS) ** 2)


@pytest.mark.parametrize("n", [2, 3, 6])
def test_tension_of_a_string(n: int) -> None:
    """A loop without bending stiffness, hoop force N: W = sqrt(N/(rho A))/R at every n, the speed of its waves."""
    ring = ElasticRing(0.002)
    ring = replace(ring, tension=800.0 * ring.bending * n**2 / RADIUS**2)
    exact = np.sqrt((ring.tension + n**2 * ring.bending / RADIUS**2) / ring.line_density) / RADIUS
    assert ring.critical(n) == pytest.approx(exact)
    assert ring.slowest(n) == pytest.approx(exact, rel=3e-3)


def test_ring_under_tension_on_an_elastic_bed() -> None:
    """W_n^2 rho A R^2 (n^2 - 1)^2 = (E I n^2/R^2 + N)(n^2 - 1)^2 + k n^2 R^2: least where bending meets the bed."""
    ring = ElasticRing(0.01, tension=20.0, bed=500.0)
    orders = np.arange(2, 11)
    exact, computed = (np.array([speed(int(n)) for n in orders]) for speed in (ring.critical, ring.slowest))
    assert computed == pytest.approx(exact, rel=1e-2)
    least = int(orders[computed.argmin()])
    assert least == int(orders[exact.argmin()])
    assert 2 < least < 10
    assert computed.min() == pytest.approx(exact.min(), rel=3e-3)
    # The usual estimate, w_n/n of the ring that does not turn, lacks the Coriolis term.
    for n, speed in zip(orders[2:], computed[2:], strict=True):
        bending = next(m for m in ring.vibration.modes(int(n), 6) if np.abs(m.shape).argmax() % 3 == 0)
        usual = 2 * np.pi * bending.frequency / n
        assert usual / speed == pytest.approx((n**2 - 1) / (n * np.sqrt(n**2 + 1)), rel=5e-3)


def test_centrifugal_tension_of_a_free_loop_leaves_no_critical_speed() -> None:
    """N = N_0 + rho A (W R)^2 in the loop: waves on it always run faster than the loop turns."""
    speed, ring = 100.0, ElasticRing(0.002)
    flux = ring.line_density * (speed * RADIUS) ** 2
    density = np.full((4, 9), ring.density)
    dynamic, slack = (
        Harmonics(rolled(replace(ring, tension=flux + more).state, density, speed)) for more in (10.0, -10.0)
    )
    for n in (3, 8):
        least = [np.linalg.eigvalsh(loop.stiffness(n).toarray())[0] for loop in (dynamic, slack)]
        assert least[0] > 0
        # Without the tension N_0 > 0 the bending stiffness alone is left, which is less than 10 N at three crests.
        assert (least[1] > 0) == (n**2 * ring.bending / RADIUS**2 > 10.0)


def test_one_crest_is_no_wave() -> None:
    with pytest.raises(InputError, match="two or more crests"):
        SteadyWaves(ElasticRing(0.02).vibration).waves(1)


def test_steady_mass_is_definite_from_two_crests() -> None:
    for n in (2, 3, 7):
        values = np.linalg.eigvalsh(steady_mass(sp.identity(3), n).toarray())
        assert values == pytest.approx([(n - 1) ** 2, n**2, (n + 1) ** 2])


def test_a_highest_harmonic_that_is_no_whole_number_is_refused() -> None:
    with pytest.raises(InputError, match=r"must be a whole number from 2 to 60, not 7\.5"):
        critical_speed(tf.study("nasa-22x5.5-8pr"), highest=7.5)  # type: ignore[arg-type]
