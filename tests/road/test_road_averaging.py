"""Every contact resolved against the film averaged over the revolution."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from tyrefem.boundaries.averaging import TreadPoint, averaging_error, averaging_sweep, periodic_state
from tyrefem.conduction import Film
from tyrefem.errors import InputError
from tyrefem.reports.figures.road import averaging_figure, holds_above

CITY = TreadPoint(speed=50 / 3.6, footprint_length=0.14)


def test_one_revolution_brings_the_periodic_state_back():
    """The adaptive transient solver, given the same revolution with jumps, ends where it started."""
    point = CITY
    state = periodic_state(point)
    film = Film(
        lambda _x, t: point.phases[0][1] if t < point.contact_time else point.phases[1][1],
        lambda _x, t: point.phases[0][2] if t < point.contact_time else point.phases[1][2],
    )
    problem = point.conduction(film)
    start = np.interp(problem.operators.points[0], state.x, state.before_contact)
    times = [0.0, point.contact_time, point.revolution]
    # Data are seen from the left before a breakpoint: the film there is that of the contact.
    history = problem.transient(times, start, 1e-3, breakpoints=[point.contact_time])
    touched = history.values[1] - np.interp(problem.operators.points[0], state.x, state.after_contact)
    returned = history.values[2] - start
    assert np.abs(start - history.values[1]).max() > 1.0
    assert np.abs(touched).max() < 0.01
    assert np.abs(returned).max() < 0.01


def test_heat_in_is_heat_out_over_a_revolution():
    """k dT/dx at the inside = to the road + to the air, with the mean temperatures."""
    point = replace(CITY, heat_source=2e5)
    state = periodic_state(point)
    inwards = -point.conductivity * (state.mean[1] - state.mean[0]) / (state.x[1] - state.x[0])
    inwards -= point.heat_source * (state.x[1] - state.x[0]) / 2
    # Mean surface temperature off the road, from the means of the whole revolution and of the contact.
    contact = point.road_temperature + state.heat_to_road / point.fraction / point.phases[0][1]
    off_road = float(state.mean[-1]) - point.fraction * contact
    to_air = point.air * (off_road - (1 - point.fraction) * point.air_temperature)
    assert inwards + point.heat_source * point.thickness == pytest.approx(state.heat_to_road + to_air, rel=1e-6)


def test_insulated_inside_gives_all_its_heat_away():
    point = replace(CITY, inner_temperature=None, heat_source=1e5, air_film=0.0)
    error = averaging_error(point)
    assert error.heat_to_road == pytest.approx(1e5 * point.thickness, rel=1e-6)
    assert error.averaged_heat_to_road == pytest.approx(1e5 * point.thickness, rel=1e-6)
    # Same heat through the same rubber: the profiles are apart by one number at every depth.
    assert np.ptp(error.difference) < 0.01 * abs(error.surface_difference)


def test_nothing_differs_where_all_is_at_one_temperature():
    error = averaging_error(replace(CITY, inner_temperature=25.0))
    assert error.mean_temperature == pytest.approx([25.0] * 5, abs=1e-6)
    assert error.difference == pytest.approx([0.0] * 5, abs=1e-6)


def test_the_swing_is_that_of_a_contact_and_the_difference_fades_with_depth():
    error = averaging_error(CITY, depths=(0.0, 2e-3, 5e-3, 0.01))
    # The surface is held at the road's temperature to 1/PERFECT, and stands at the road's when it leaves.
    state = periodic_state(CITY)
    assert state.after_contact[-1] == pytest.approx(CITY.road_temperature, abs=0.01)
    assert error.swing == pytest.approx(state.before_contact[-1] - CITY.road_temperature, abs=0.01)
    assert error.difference[0] == pytest.approx(error.surface_difference)
    # Beyond the reach of a contact conduction is steady: the difference falls linearly to the held side.
    assert error.difference[1:] == pytest.approx([error.surface_difference * s for s in (0.8, 0.5, 0.0)], abs=5e-3)


def test_averaging_is_worst_slow_and_long():
    """The difference falls as 1/sqrt(v), as the film rises, once the film is large against the rubber's k/d."""
    errors = averaging_sweep(CITY, (1.0, 25.0, 50.0), (0.10, 0.20))
    short, long = errors[:3], errors[3:]
    for row in (short, long):
        assert row[0].surface_difference > row[1].surface_difference > row[2].surface_difference > 0
    assert short[1].surface_difference / short[2].surface_difference == pytest.approx(math.sqrt(2), rel=0.03)
    assert all(b.surface_difference > a.surface_difference for a, b in zip(short, long, strict=True))
    assert holds_above(short) == 25.0
    assert holds_above(errors[:1]) is None
    labels = [line.get_label() for line in averaging_figure(errors).axes[0].get_lines()]
    assert labels[:2] == ["footprint 100 mm", "footprint 200 mm"]


def test_equation_12_averages_to_a_warmer_surface_than_the_exact_mean():
    exact = averaging_error(CITY)
    triangular = averaging_error(CITY, film=CITY.mean_film * math.sqrt(math.pi) / 2)
    rise, rise_12 = exact.averaged_surface - 25.0, triangular.averaged_surface - 25.0
    assert rise_12 / rise == pytest.approx(2 / math.sqrt(math.pi), rel=0.02)


@pytest.mark.parametrize(
    "given",
    [{"speed": 0.0}, {"footprint_length": 2.0}, {"thickness": -1.0}, {"conductivity": math.nan}, {"air_film": -1.0}],
)
def test_bad_tread_points_are_refused(given):
    with pytest.raises(InputError) as refused:
        replace(CITY, **given)
    assert refused.value.field == next(iter(given))


def test_a_depth_outside_the_tread_is_refused():
    with pytest.raises(InputError, match=r"from 0 to 0\.01 m"):
        averaging_error(CITY, depths=(0.02,))
