"""What its README says must come out of the study of yawed rolling, braking and a skid."""

from __future__ import annotations

import functools

import numpy as np
import pytest

import tyrefem as tf


@functools.cache
def result():
    return tf.study("nasa-brake-yaw-skid").run()


def test_sliding_phases_and_only_they_make_friction_heat():
    skid, budget = result(), result().heat_budget
    assert [phase.name for phase in skid.sliding.phases] == ["yawed turn", "braking", "locked skid"]
    heat = budget.energies["sliding", "friction on the road"]
    slides = [phase.name for phase in skid.sliding.phases]
    for state in skid.phases:
        first, last = np.searchsorted(skid.times, [state.start - 1e-6, state.end - 1e-6])
        assert (heat[last] > heat[first]) == (state.name in slides)
    assert budget.total("generated") + budget.total("sliding") == pytest.approx(
        budget.total("stored") + budget.total("lost"), rel=1e-9
    )


def test_every_contact_is_hotter_than_the_tread_and_the_skid_by_more_than_200_K():
    turn, braking, skid = result().sliding.phases
    for phase in (turn, braking, skid):
        assert phase.exit_edge_highest > phase.mean_highest > phase.tread_start
    assert turn.exit_edge_highest < braking.exit_edge_highest < skid.exit_edge_highest
    assert skid.mean_highest - 25.0 > 200
    assert skid.tread_highest - 25.0 > 200


def test_decomposition_limits_the_friction_of_the_skid_alone():
    turn, braking, skid = result().sliding.phases
    assert [phase.capped for phase in (turn, braking, skid)] == [False, False, True]
    assert 340 < skid.exit_edge_highest <= 350
    # In the brush law the slip of turn and braking do not use all of the friction.
    assert turn.friction < 0.8
    assert braking.friction < 0.8
    assert skid.friction == 0.8


def test_the_skid_is_resolved_and_its_heat_goes_in_after_it():
    skid = result()
    series = skid.sliding.series
    late = series[(series.phase == "locked skid") & (series.time_s > 339.2)]
    rise = late.half_space_degC - 25.0
    assert (abs(late.tread_mean_degC - late.half_space_degC) < 0.02 * rise).all()
    readings = skid.readings
    outer = readings["crown-outer"].to_numpy()
    # The thermocouple 4 mm below the surface warms only after the wheel stands.
    stop = np.searchsorted(readings["time_s"], 340.0)
    assert outer[stop:].max() - outer[stop] > 5
    assert skid.rolling_resistance.phase == "roll"
