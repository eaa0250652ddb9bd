"""The strain law "fem" as a study uses it: the same loss as the footprint's own account, and a radial that runs."""

from __future__ import annotations

import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.materials.loss_tangent import OfTemperature
from tyrefem.mechanics.cycle_schedule import cycle_schedule
from tyrefem.mechanics.finite_elements import FiniteElements
from tyrefem.mechanics.footprint.loss import RevolutionLoss

LINEAR = {"mechanics.motion": "linear"}
FEM = {"mechanics.strain": "fem", "mesh.size": "8 mm", **LINEAR}
BRIEF = {"drive.duration": "60 s"}


def bias(**changes: str) -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", {**FEM, **BRIEF, **changes})


def test_the_heat_of_a_run_is_the_loss_of_all_harmonics() -> None:
    study = bias()
    schedule = cycle_schedule(study)
    cycle = schedule.cycles[0][0]
    assert isinstance(cycle, FiniteElements)
    from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics

    laws = {region: OfTemperature(study.materials[region].loss_tangent) for region in cycle.tyre.body.parts}
    initial, speed = study.card.drive.initial, study.card.drive.phases[0].speed.start
    reference = RevolutionLoss(StrainHarmonics(cycle.footprint), laws, speed, initial)
    cold = study.run().rolling_resistance.cold_force
    # Other quadrature: nearest Gauss points at the nodes of the thermal mesh.
    assert cold == pytest.approx(reference.rolling_resistance, rel=0.05)


def test_the_loss_convention_does_not_change_what_harmonics_lose() -> None:
    first, second = (bias(**{"mechanics.loss_convention": value}).run() for value in ("nasa", "sinusoid"))
    assert first.rolling_resistance.cold_force == pytest.approx(second.rolling_resistance.cold_force, rel=1e-9)


def test_rolling_resistance_rises_about_in_proportion_to_the_load() -> None:
    light, heavy = (
        bias(**{"drive.load": value}).run().rolling_resistance.cold_force for value in ("2000 lbf", "2700 lbf")
    )
    # That its coefficient hardly depends on the load is why it is stated as a coefficient.
    assert heavy / light == pytest.approx(2.7 / 2.0, rel=0.1)


def test_a_passenger_radial_loses_what_such_tyres_do_and_is_hottest_at_the_belt_edge() -> None:
    study = tf.study("passenger-205-55r16", {"mesh.size": "8 mm", "mesh.element": "P1", **LINEAR})
    assert study.card.mechanics.strain == "fem"
    result = study.run()
    # Usual passenger tyres: 0.006 to 0.014.
    assert 0.006 < result.rolling_resistance.coefficient < 0.014
    hottest = result.extremes.iloc[1:].sort_values("temperature_degC").iloc[-1]
    # The inner belt ends 74 mm from the crown, the tread at 81 mm: belt edge and shoulder are known to be hottest.
    assert 0.07 < hottest["s_m"] < 0.09
    assert hottest["region"] in ("shoulder-cushion", "body-ply", "undertread")
    peaks = result.extremes.set_index("region")["temperature_degC"]
    assert peaks["apex"] < peaks["shoulder-cushion"] - 0.5
    assert result.heat_budget.imbalance < 1e-6


def test_a_truck_radial_is_hottest_between_the_edge_of_its_working_belts_and_its_shoulder() -> None:
    """Not under the middle of the tread, where the contact pressure is highest: there the rubber is thinnest."""
    changes = {"mesh.size": "18 mm", "mesh.element": "P1", "numerics.tolerance": "0.2 delta_degC", **LINEAR}
    result = tf.study("truck-295-80r22.5", changes).run()
    # Label classes A to E of truck tyres: 0.004 to 0.008.
    assert 0.004 < result.rolling_resistance.coefficient < 0.008
    hottest = result.extremes.iloc[1:].sort_values("temperature_degC").iloc[-1]
    # The working belts end 90 and 99 mm from the crown, the tread at 99 mm.
    assert 0.09 <= hottest["s_m"] < 0.115
    peaks = result.extremes.set_index("region")["temperature_degC"]
    assert peaks["shoulder-cushion"] > peaks["apex"] + 20
    # The protector belt is hottest at the crown: what was the hottest place under a tread without grooves.
    assert peaks["shoulder-cushion"] > peaks["belt-4"] + 15


def test_an_aircraft_radial_is_stable_and_its_bodys_plies_stay_tight() -> None:
    study = tf.study("aircraft-radial", {"mesh.size": "6 mm", **BRIEF, **LINEAR})
    result = study.run()
    cycle = result.tyre.schedule.cycles[0][0]
    assert isinstance(cycle, FiniteElements)
    # No compressed cords that would buckle: the linearised footprint may be trusted.
    assert not cycle.footprint.unstable
    # The plies stay tight but where the bead bends them about the flange.
    least, mean, _ = cycle.tyre.cord_tensions["body-plies"].strain
    assert mean > 5e-3
    assert least > -0.1 * mean
    assert cycle.tyre.cord_tensions["inner-belts"].strain[0] > 0
    # A membrane alone carries load / pressure on its footprint; the section's stiffness takes some of it.
    assert 0.5 < cycle.footprint.area * cycle.case.pressure / cycle.case.load < 1.2
    assert 0.005 < result.rolling_resistance.coefficient < 0.02


def test_a_tyre_without_pressure_carries_nothing() -> None:
    with pytest.raises(InputError, match=r"drive.pressure: .* inflated"):
        bias(**{"drive.pressure": "0 kPa"}).run()


def test_a_footprint_in_large_motion_deflects_more_and_loses_about_as_much() -> None:
    drive = {"mesh.size": "12 mm", "drive.load": "1000 lbf"}
    cycles = [
        cycle_schedule(bias(**drive, **{"mechanics.motion": value})).cycles[0][0] for value in ("linear", "large")
    ]
    linear, large = cycles
    assert isinstance(linear, FiniteElements)
    assert isinstance(large, FiniteElements)
    small, great = (value.solved_case.deflection for value in (linear, large))
    assert 1.05 * small < great < 1.4 * small
    weights = linear.tyre.body.rings.weights
    before, after = ((value.density * weights).sum() for value in (linear, large))
    # Under a given load: larger motions of smaller strain.
    assert after != before
    assert after == pytest.approx(before, rel=0.2)
