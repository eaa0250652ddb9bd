"""With strain = "fem" there is one contact: what `press` finds is what a run, its road film and its report use."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.boundaries.road_film import propagation_depth, triangular_film
from tyrefem.mechanics.cycle_schedule import cycle_schedule
from tyrefem.mechanics.footprint import pressed_tyre
from tyrefem.mechanics.footprint.press import Pressed, press
from tyrefem.mechanics.solved_cases import rated_case
from tyrefem.reports.inputs import mechanics_rows
from tyrefem.reports.run_files import loaded_cycle
from tyrefem.reports.run_headline import headline
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.variants.answers import answers

COARSE = {
    "mechanics.strain": "fem",
    "mechanics.motion": "linear",
    "mesh.size": "10 mm",
    "mesh.element": "P1",
    "drive.duration": "60 s",
    "boundaries.road": {"law": "cattani"},
}
TYRES = ("passenger-205-55r16", "nasa-22x5.5-8pr")


@functools.cache
def study(name: str) -> tf.Study:
    return tf.study(name, COARSE)


@functools.cache
def run(name: str) -> Any:
    return study(name).run()


@functools.cache
def pressed(name: str) -> Pressed:
    return press(study(name))


@pytest.mark.parametrize("name", TYRES)
def test_run_summary_report_and_press_tell_one_contact(name: str) -> None:
    footprint, phase = pressed(name).footprint, run(name).summary()["phases"][0]
    # At the same load, pressure, road and mesh: nothing but rounding is between them.
    for key, value in {
        "deflection": footprint.deflection,
        "footprint_length": footprint.length,
        "footprint_area": footprint.area,
        "rolling_radius": footprint.rolling_radius,
        "load": footprint.load,
        "road_fraction": footprint.length / (2 * math.pi * footprint.rolling_radius),
    }.items():
        assert phase[key] == pytest.approx(value, rel=1e-8), key
    (card,) = [entry for entry in headline(run(name)) if entry["label"] == "Deflection"]
    assert card["value"] == f"{footprint.deflection * 1e3:.1f} mm"
    assert f"footprint {footprint.length * 1e3:.0f} mm, {footprint.area * 1e4:.0f} cm²" in card["note"]
    summary = run(name).summary()["footprint"]
    assert (summary["motion"], summary["deflection_m"]) == ("linear", pytest.approx(footprint.deflection, rel=1e-8))
    left_out = summary["left_out_by_linear_strains"]
    assert left_out["mean"] == pytest.approx(pressed(name).linearisation_error.mean, rel=1e-6)
    stated = f"leave out {pressed(name).linearisation_error.mean:.0%} of themselves"
    assert any(stated in value for label, value in mechanics_rows(study(name), loaded_cycle(run(name))))
    assert answers(run(name))["deflection_m"] == pytest.approx(footprint.deflection, rel=1e-8)


@pytest.mark.parametrize("name", TYRES)
def test_the_road_film_is_that_of_the_footprint(name: str) -> None:
    footprint, tyre = pressed(name).footprint, run(name).tyre
    speed, tread = tyre.speed(1.0), tyre.tread
    assert tyre.road_film(1.0) == pytest.approx(triangular_film(speed, footprint.length, *tread), rel=1e-8)
    assert tyre.propagation_depth(1.0) == pytest.approx(propagation_depth(footprint.length / speed, *tread), rel=1e-8)
    revolutions = tyre.schedule.revolutions_per_second(1.0)
    assert revolutions == pytest.approx(speed / (2 * math.pi * footprint.rolling_radius), rel=1e-8)


def test_a_drive_by_deflection_has_that_deflection_and_the_footprints_load() -> None:
    case = cycle_schedule(study(TYRES[1]).replace({"drive.deflection": "15 mm"})).cases[0][0]
    footprint = press(study(TYRES[1]), deflection=0.015).footprint
    assert case.deflection == pytest.approx(0.015, rel=1e-12)
    assert case.load == pytest.approx(footprint.load, rel=1e-8)


def test_a_tyre_without_load_has_no_footprint_and_rolls_on_its_inflated_radius() -> None:
    schedule = cycle_schedule(study(TYRES[1]).replace({"drive.load": "0 N"}))
    case, cycle = schedule.cases[0][0], schedule.cycles[0][0]
    assert (case.deflection, case.footprint_length, case.footprint_area, case.road_fraction) == (0.0, 0.0, 0.0, 0.0)
    assert case.rolling_radius == pytest.approx(study(TYRES[1]).section.outer_diameter / 2 + cycle.tyre.radius_growth)


def test_laws_of_load_and_footprint_are_not_read() -> None:
    """Not even to refuse a load: of 2 kN/m the law would deflect the tyre by metres."""
    law = {"law": "vertical-stiffness", "stiffness": "2 kN/m", "source": "test"}
    laws = {"mechanics.load_law": law, "mechanics.footprint": {"law": "given", "length": "5 cm"}}
    other, case = cycle_schedule(study(TYRES[1]).replace(laws)).cases[0][0], run(TYRES[1]).tyre.schedule.cases[0][0]
    assert other.contact == case.contact
    assert other.deflection == case.deflection


def test_the_rated_deflection_is_the_footprints_too() -> None:
    chosen = study(TYRES[1])
    rating = chosen.section.rating
    footprint = press(chosen, load=rating.load, pressure=rating.pressure).footprint
    assert rated_case(chosen).deflection == pytest.approx(footprint.deflection, rel=1e-8)
    arcs = chosen.replace({"mechanics.strain": "arcs"})
    law = arcs.card.mechanics.load_law
    assert rated_case(arcs).deflection == law.deflection(rating.load, rating.pressure, rating)


def test_all_of_the_load_rubs_on_the_footprints_area() -> None:
    """Friction power in the budget and the report: mu F v_s, whatever the area is."""
    skid = {"drive.slip_ratio": "10 %", "boundaries.sliding": {"law": "constant", "coefficient": 0.5}}
    tyre = RollingTyre(study(TYRES[1]).replace({**skid, "drive.duration": "1 s"}))
    sliding, case = tyre.sliding, tyre.schedule.cases[0][0]
    assert sliding.contact_area(0.5) == pytest.approx(case.footprint_area, rel=1e-12)
    assert sliding.pressure(0.5) * case.footprint_area == pytest.approx(case.load, rel=1e-12)
    passage = sliding.passage(0.5)
    power = 0.5 * case.load * tyre.motion(0.5).sliding_speed * passage.tread_share
    heat = sliding.mean_heat(None, 0.5, np.full(3, 25.0)) * sliding.surface.area * 2
    assert heat == pytest.approx(power, rel=1e-9)


def test_a_run_with_the_same_tyre_solves_nothing_again(monkeypatch: pytest.MonkeyPatch) -> None:
    from tyrefem.mechanics.solid import inflation

    solved: list[float] = []
    inflate = inflation.inflate

    def counted(*given: Any, **options: Any) -> Any:
        solved.append(given[1])
        return inflate(*given, **options)

    monkeypatch.setattr(inflation, "inflate", counted)
    pressed_tyre.REMEMBERED_TYRES.clear()
    chosen = study(TYRES[1]).replace({"mesh.size": "14 mm"})
    first = cycle_schedule(chosen).cycles[0][0]
    warmer = chosen.replace({"materials.tread.conductivity.value": "0.3 W/m/K", "drive.speed": "10 mph"})
    assert cycle_schedule(warmer).cycles[0][0].footprint is first.footprint
    assert len(solved) == 1
    stiffer = chosen.replace({"materials.tread.shear_modulus.value": "700 psi"})
    assert cycle_schedule(stiffer).cycles[0][0].footprint is not first.footprint
    assert len(solved) == 2
    # Not by name: the number back as it was, in another unit, is the same tyre.
    kept = chosen.materials["tread"].shear_modulus.value
    same = stiffer.replace({"materials.tread.shear_modulus.value": f"{kept!r} Pa"})
    assert cycle_schedule(same).cycles[0][0].footprint is first.footprint


def test_a_finer_mesh_is_not_given_the_cycles_of_a_coarser_one() -> None:
    coarse = RollingTyre(study(TYRES[1]).replace({"mesh.size": "14 mm"}))
    fine = RollingTyre(study(TYRES[1]), coarse)
    assert fine.schedule is not coarse.schedule
    assert fine.schedule.cases[0][0].contact == run(TYRES[1]).tyre.schedule.cases[0][0].contact


def test_losing_cords_follow_the_compounds_tan_delta() -> None:
    """The cords' own loss is stated over the compound's: another compound's tan delta leaves it as it is."""
    radial = study(TYRES[0])
    first = RollingTyre(radial)
    ply = radial.materials["body-ply"]
    assert ply.cords.loss_tangent
    twice = radial.scaled("materials.body-ply.loss_tangent.value", 2.0)
    assert RollingTyre(twice, first).schedule is not first.schedule
    tread = radial.scaled("materials.tread.loss_tangent.value", 2.0)
    assert RollingTyre(tread, first).schedule is first.schedule
