"""One passage through a sliding contact against Roberts' equations, and a skid's half-space against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import erfcx

from tyrefem.boundaries import friction_names as sliding
from tyrefem.boundaries.averaging import TreadPoint
from tyrefem.boundaries.friction_names import ASPHALT, RUBBER, LockedWheel
from tyrefem.boundaries.skid import Passage, half_space_surface
from tyrefem.conduction import Conduction, Film, Flux, Material
from tyrefem.errors import InputError

pytestmark = pytest.mark.fast

LENGTH, SPEED = 0.15, 20.0


def passage(rolling: float = SPEED) -> Passage:
    return Passage(RUBBER.effusivity, ASPHALT.effusivity, LENGTH, rolling, SPEED)


def test_small_slip_is_equation_5():
    flux, time = 1e6, LENGTH / SPEED
    assert passage().exit_rise(flux) == pytest.approx(sliding.shared_rise(flux, time, RUBBER, ASPHALT), rel=1e-12)
    assert passage().tread_share == pytest.approx(sliding.share_into(RUBBER, ASPHALT), rel=1e-12)
    # The tread's own share warms it as much as the whole heat warms the two.
    rise = sliding.surface_rise(passage().tread_share * flux, time, RUBBER)
    assert rise == pytest.approx(passage().exit_rise(flux), rel=1e-12)


def test_any_slip_warms_both_surfaces_alike():
    for rolling in (1.0, 12.0, 35.0):
        there, flux = passage(rolling), 1e6
        tread = sliding.surface_rise(there.tread_share * flux, LENGTH / rolling, RUBBER)
        road = sliding.surface_rise((1 - there.tread_share) * flux, LENGTH / SPEED, ASPHALT)
        assert tread == pytest.approx(road, rel=1e-12)
        assert tread == pytest.approx(there.exit_rise(flux), rel=1e-12)


def test_a_locked_wheel_is_equations_12_and_13():
    car = LockedWheel(length=LENGTH)
    locked, stress = passage(0.0), car.friction * car.pressure
    assert locked.exit_rise(stress * SPEED) == pytest.approx(car.uncapped_exit_rise(SPEED), rel=1e-12)
    most = locked.largest_flux(20.0 + car.decomposition_rise, 90.0, 20.0)
    assert most / (car.pressure * SPEED) == pytest.approx(car.friction_at(SPEED), rel=1e-12)
    # In the long run all heat goes into the road, at its mean rise.
    mean = car.uncapped_exit_rise(SPEED) * sliding.MEAN_OF_EXIT
    assert stress * SPEED / locked.skid_film(10.0) == pytest.approx(mean, rel=1e-12)


def test_meeting_is_between_tread_and_road():
    assert passage().frictionless_temperature(80.0, 80.0) == pytest.approx(80.0)
    b_t, b_r = RUBBER.effusivity, ASPHALT.effusivity
    assert passage().frictionless_temperature(80.0, 20.0) == pytest.approx((b_t * 80 + b_r * 20) / (b_t + b_r))


def test_a_skid_starts_as_equation_5_and_ends_at_the_road_s_mean_rise():
    locked, flux = passage(0.0), 1e5
    crossing = LENGTH / SPEED
    times = np.array([0.02, 0.05, 1000.0]) * crossing
    rise = half_space_surface(times, lambda t: flux, locked.skid_film, lambda t: 0.0, 0.0, RUBBER.effusivity)
    early = [sliding.shared_rise(flux, float(t), RUBBER, ASPHALT) for t in times[:2]]
    # The mean over the contact, where the front edge has had less time: at most v t/(3 l) below.
    assert rise[:2] == pytest.approx(early, rel=0.02)
    final = sliding.MEAN_OF_EXIT * sliding.surface_rise(flux, crossing, ASPHALT)
    assert rise[2] == pytest.approx(final, rel=0.02)
    assert rise[2] < final


def test_a_half_space_under_a_film_is_the_closed_form():
    """Carslaw & Jaeger 2.7: (F/H) (1 - exp(x^2) erfc(x)), x = H sqrt(t)/b."""
    flux, film, b = 2e6, 9000.0, 660.0
    times = np.array([1e-3, 0.1, 2.0])
    surface = half_space_surface(times, lambda t: flux, lambda t: film, lambda t: 25.0, 25.0, b)
    expected = 25.0 + flux / film * (1.0 - erfcx(film * np.sqrt(times) / b))
    assert surface == pytest.approx(expected, rel=1e-4)


def test_passages_that_cannot_be():
    for wrong in ({"length": 0.0}, {"road_speed": 0.0}, {"rolling_speed": -1.0}, {"tread": math.nan}):
        given = {"tread": 660.0, "road": 1200.0, "length": 0.15, "rolling_speed": 1.0, "road_speed": 1.0, **wrong}
        with pytest.raises(InputError, match=next(iter(wrong))):
            Passage(**given)
    with pytest.raises(InputError, match="at least 0 s"):
        passage(0.0).road_age(-1.0)


def test_a_flux_of_temperature_is_the_film_it_stands_for():
    point = TreadPoint(speed=10.0, footprint_length=0.15)
    film = point.conduction(Film(300.0, 20.0))
    flux = point.conduction(Flux(lambda x, t, T: 300.0 * (20.0 - T), of_temperature=True))
    times = np.linspace(0.0, 60.0, 5)
    fields = [problem.transient(times, 90.0, 1e-3) for problem in (film, flux)]
    assert np.ptp(fields[0].values[-1]) > 10
    assert fields[1].values == pytest.approx(fields[0].values, abs=5e-3)
    assert fields[1].budget.imbalance < 1e-9
    held = [problem.steady(50.0).values for problem in (film, flux)]
    assert held[1] == pytest.approx(held[0], abs=1e-6)
    with pytest.raises(InputError, match=r"f\(x, t, T\)"):
        Flux(3.0, of_temperature=True)
    wrong = Flux(lambda x, t, T: np.append(T, 1.0), of_temperature=True)
    rubber = {"tread": Material(0.25, 2e6)}
    with pytest.raises(InputError, match="shape"):
        Conduction(point.mesh, rubber, {"surface": wrong}, axisymmetric=False).transient([0.0, 1.0], 20.0)
