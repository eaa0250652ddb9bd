"""What cards say of their uncertainty is used: every number once, and only where a run can feel it."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.compare.study_check import check_study
from tyrefem.diagnose.unknowns.unknown import Unknown, with_values
from tyrefem.errors import InputError
from tyrefem.inputs.changes import check_factor, scaled
from tyrefem.inputs.uncertain_numbers import UncertainNumber, left_out, stated_deviations, uncertain_number
from tyrefem.materials.reads import STIFFNESS, tables_read
from tyrefem.mechanics.cycle_schedule import cycle_schedule
from tyrefem.mechanics.footprint.pressed_tyre import mechanical_mesh
from tyrefem.mechanics.solid.tyre_body import tyre_body
from tyrefem.mechanics.strain_laws import strain_laws
from tyrefem.variants.varied import uncertain

RADIAL, BIAS = "passenger-205-55r16", "nasa-22x5.5-8pr"
SHIPPED = (RADIAL, "truck-295-80r22.5", "aircraft-radial", BIAS, "example-validation")
LAWS = tuple(strain_laws())


@functools.cache
def radial(law: str = "fem") -> tf.Study:
    return tf.study(RADIAL, {"mechanics.strain": law, "mesh.size": "12 mm", "mesh.element": "P1"})


def by_key(study: tf.Study) -> dict[str, UncertainNumber]:
    return {number.key: number for number in study.uncertain_numbers}


@pytest.mark.parametrize("name", SHIPPED)
def test_every_deviation_that_a_card_states_is_somebodys(name: str) -> None:
    """What a report prints as +- 20 % is a number that counts, or says why it cannot."""
    study = tf.study(name)
    held = {table for number in study.uncertain_numbers for table in number.tables}
    stated = {
        f"materials.{region}.{where}"
        for region, card in study.materials.items()
        for where, _ in stated_deviations(card)
    }
    assert stated <= held
    assert set(study.uncertainty) == {number.key for number in study.uncertain_numbers if not number.idle}


@pytest.mark.parametrize("name", ["section.layers.belt-1.angle", "materials. belt-1 .cords.angle"])
def test_every_name_of_a_number_of_a_card_moves_it_in_all_regions(name: str) -> None:
    """The angle of a layer is that of the cords on its card, which both belts have."""
    number = uncertain_number(radial(), name)
    assert number.keys == ("materials.belt-1.cords.angle", "materials.belt-2.cords.angle")
    two = {f"uncertainty.{name}": "2 %", "uncertainty.materials.belt-2.cords.angle": "3 %"}
    with pytest.raises(InputError, match="is the same number as"):
        _ = radial().replace(two).uncertain_numbers


def test_one_card_in_several_regions_is_one_number() -> None:
    study = radial()
    number = by_key(study)["materials.body-ply.cords.modulus"]
    assert set(number.regions) == {"body-ply", "turn-up", "bead-wrap"}
    assert number.card == "passenger-body-ply"
    assert not {"materials.turn-up.cords.modulus", "materials.bead-wrap.cords.modulus"} & set(study.uncertainty)
    stiffer = study.scaled("materials.turn-up.cords.modulus", 1.2)
    for region in number.regions:
        before, after = (item.materials[region].cords for item in (study, stiffer))
        assert after.modulus == pytest.approx(1.2 * before.modulus)
        assert after.in_compression == pytest.approx(1.2 * before.in_compression)
    # Moved together it stays one number; a region with a value of its own is another.
    assert set(by_key(stiffer)["materials.body-ply.cords.modulus"].regions) == set(number.regions)
    apart = study.replace({"materials.turn-up.cords.modulus": "5 GPa"})
    assert "turn-up" not in by_key(apart)["materials.body-ply.cords.modulus"].regions
    assert by_key(apart)["materials.turn-up.cords.modulus"].regions == ("turn-up",)
    assert "turn-up" in by_key(apart)["materials.body-ply.elasticity.shear_modulus"].regions


def test_constants_of_one_law_have_one_factor_and_tables_keep_their_first_column() -> None:
    rubber = {"law": "mooney-rivlin", "c10": "0.6 MPa", "c01": "0.2 MPa", "source": "test", "relative_sd": 0.2}
    rows = [["20 degC", "0.2 W/m/K"], ["80 degC", "0.3 W/m/K"]]
    card = {"base": "rubber-sidewall", "elasticity": rubber, "conductivity": {"table": rows}}
    study = radial().replace({"materials.sidewall": card})
    number = by_key(study)["materials.sidewall.elasticity.c10"]
    assert number.keys == ("materials.sidewall.elasticity.c10", "materials.sidewall.elasticity.c01")
    stiffer = study.scaled(number.key, 1.5).materials["sidewall"]
    assert (stiffer.elasticity.c10, stiffer.elasticity.c01) == pytest.approx((0.9e6, 0.3e6))
    better = study.scaled("materials.sidewall.conductivity.table", 2.0).materials["sidewall"].conductivity
    assert better.table == [["20 degC", "0.4 W/m/K"], ["80 degC", "0.6 W/m/K"]]


def test_what_cannot_matter_says_why() -> None:
    numbers = by_key(radial())
    assert "fem" in numbers["materials.tread.shear_modulus.value"].idle
    assert not numbers["materials.tread.elasticity.shear_modulus"].idle
    given = by_key(radial("given"))
    assert all(number.idle for key, number in given.items() if key.split(".")[2] in STIFFNESS)
    (line,) = left_out(radial().uncertain_numbers)
    assert "'fem' does not read" in line
    assert "and 8 more" in line
    series = {"law": "prony", "equilibrium": "1 MPa", "series": [["0.4 MPa", "1 ms"]], "source": "test"}
    loss = {"law": "frequency", "frequency": series, "source": "test", "relative_sd": 0.2}
    prony = by_key(radial().replace({"materials.tread": {"base": "rubber-tread-passenger", "loss_tangent": loss}}))
    assert "no single number" in prony["materials.tread.loss_tangent"].idle


def test_softening_counts_where_temperatures_act_back() -> None:
    soft = {"materials.tread.softening": {"rate": "0.006 1/delta_degC", "source": "test", "relative_sd": 0.3}}
    key = "materials.tread.softening.rate"
    assert "feedback" in by_key(radial().replace(soft))[key].idle
    assert not by_key(radial().replace({**soft, "mechanics.feedback": {}}))[key].idle
    assert by_key(radial().replace({**soft, "mechanics.feedback": {"modulus": False}}))[key].idle


def test_the_studys_own_table_speaks_of_the_same_numbers() -> None:
    turn_up, ply = "materials.turn-up.cords.modulus", "materials.body-ply.cords.modulus"
    study = radial().replace(
        {"uncertainty": {turn_up: "5 %", "drive.load": "2 %", "materials.tread.density.value": 0.03}}
    )
    assert study.uncertainty[ply] == pytest.approx(0.05)
    assert turn_up not in study.uncertainty
    assert study.uncertainty["drive.load"] == pytest.approx(0.02)
    assert study.uncertainty["materials.tread.density.value"] == pytest.approx(0.03)
    twice = radial().replace({"uncertainty": {turn_up: "5 %", ply: "6 %"}})
    with pytest.raises(
        tf.InputError, match=r"uncertainty\.materials\.body-ply.*is the same number as 'materials\.turn-up"
    ):
        _ = twice.uncertainty


# -- what a strain law reads -------------------------------------------------------------------------------------------


def body_of(study: tf.Study) -> list[Any]:
    """All numbers of the body that finite elements take."""
    parts = tyre_body(study, mechanical_mesh(study)).parts
    arrays: list[Any] = []
    for part in parts.values():
        arrays += [part.compound.c10, part.compound.bulk_modulus, part.cord_loss]
        for layer in part.cords:
            arrays += [layer.stiffness.copy(), layer.limit, layer.compression]
    return [np.asarray(item, dtype=float) for item in arrays]


def same(item: list[Any], other: list[Any]) -> bool:
    return all(np.array_equal(a, b) for a, b in zip(item, other, strict=True))


@pytest.mark.parametrize("name", [RADIAL, BIAS])
def test_finite_elements_read_what_they_say(name: str) -> None:
    """Each stiffness moved: the body changes if, and only if, the law says that it reads the table."""
    study = tf.study(name, {"mechanics.strain": "fem", "mesh.size": "12 mm"})
    before, reads = body_of(study), tables_read("fem", study.materials)
    tried = 0
    for region, card in study.materials.items():
        for table, field in (
            ("shear_modulus", "value"), ("youngs_modulus", "value"), ("cord", "ply_shear_modulus"),
            ("elasticity", "shear_modulus"), ("cords", "modulus"), ("loss_tangent", "value"),
        ):  # fmt: skip
            if getattr(card, table) is None:
                continue
            number = uncertain_number(study, f"materials.{region}.{table}.{field}")
            changed = body_of(study.replace(number.changes(1.1)))
            assert same(changed, before) == (not any(table in reads[item] for item in number.regions)), number.label
            tried += 1
    assert tried > 8


@pytest.mark.parametrize("law", ["arcs", "given"])
def test_the_other_laws_read_what_they_say(law: str) -> None:
    elasticity = {"materials.tread.elasticity": {"law": "neo-hookean", "shear_modulus": "1 MPa", "source": "test"}}
    study = tf.study(BIAS, {"mesh.size": "8 mm", **elasticity})
    if law == "given":
        energies = dict.fromkeys(study.materials, "10 kJ/m**3")
        table = {"load": "12 kN", "pressure": "500 kPa", "regions": energies, "source": "test"}
        study = study.replace({"mechanics.strain": "given", "mechanics.energy": table})

    def energy(of: tf.Study) -> list[Any]:
        (cycle,) = cycle_schedule(of).cycles[0]
        points = {
            "tread": ([0.0], [0.015]), "carcass": ([0.01, 0.1], [0.004, 0.003]), "sidewall": ([0.1], [0.008]),
            "bead": ([0.135], [0.005]),
        }  # fmt: skip
        return [cycle.energy_density(zone.name, of.section.place(*points[zone.region]).T) for zone in cycle.zones]

    before, reads = energy(study), tables_read(law, study.materials)
    for region, card in study.materials.items():
        for table, field in (
            ("shear_modulus", "value"), ("youngs_modulus", "value"), ("cord", "ply_shear_modulus"),
            ("elasticity", "shear_modulus"), ("loss_tangent", "value"),
        ):  # fmt: skip
            if getattr(card, table) is None:
                continue
            changed = energy(study.scaled(f"materials.{region}.{table}.{field}", 1.1))
            assert same(changed, before) == (table not in reads.get(region, ())), (region, table)


@pytest.mark.parametrize("ambient", ["25 degC", "77 degF"])
def test_a_share_of_a_temperature_is_refused(ambient: str) -> None:
    """10 % of 25 degC were 2.5 K, of the same 77 degF 4.3 K."""
    with pytest.raises(InputError, match="is a temperature"):
        _ = tf.study(BIAS, {"drive.ambient": ambient, "uncertainty": {"drive.ambient": "10 %"}}).uncertain_numbers
    with pytest.raises(InputError, match="is a temperature"):
        tf.study(BIAS, {"drive.ambient": ambient}).scaled("drive.ambient", 1.1)
    with pytest.raises(InputError, match="is a temperature"):
        check_factor({"unit": ambient.split()[1], "values": [20.0, 30.0]})
    # Fits multiply kelvins.
    first, last = scaled({"unit": "degF", "values": [77.0, 86.0]}, 1.01)["values"]
    assert (first, last) == (pytest.approx(298.15 * 1.01 - 273.15), pytest.approx(303.15 * 1.01 - 273.15))


@pytest.mark.parametrize("ambient", ["25 degC", "77 degF", "298.15 K"])
def test_a_standard_deviation_may_be_a_quantity(ambient: str) -> None:
    study = tf.study(BIAS, {"drive.ambient": ambient, "uncertainty": {"drive.ambient": "2 K", "drive.load": "100 N"}})
    by_key = {number.key: number for number in study.uncertain_numbers}
    assert by_key["drive.ambient"].sd == pytest.approx(2 / 298.15)
    load = study.card.drive.phases[0].load.start
    assert by_key["drive.load"].sd == pytest.approx(100 / load)
    warmer = study.scaled("drive.ambient", 1 + by_key["drive.ambient"].sd)
    assert warmer.card.drive.phases[0].ambient.start == pytest.approx(27.0)
    assert check_study(study) == len(study.measured)
    unknown = Unknown("drive.ambient", by_key["drive.ambient"].sd)
    fitted = with_values(study, {unknown: math.log1p(unknown.sd)})
    assert fitted.card.drive.phases[0].ambient.start == pytest.approx(27.0)
    (varied,) = [number for number in uncertain(study, 1.0) if number.key == "drive.ambient"]
    assert varied.of(varied.at(1.0)) == pytest.approx(27.0 if varied.unit == "degC" else 300.15)
    assert varied.unit == ("K" if ambient.endswith("K") else "degC")


@pytest.mark.parametrize(
    ("key", "deviation", "words"),
    [
        ("drive.ambient", "2 kg", "is not a unit of this quantity"),
        ("drive.load", "0 N", "is out of range"),
        ("drive.load", "3 MN", "is out of range"),
        ("drive.load", "120 %", "must be less than 1"),
        ("materials.carcass.conductivity.table", "0.1 W/m/K", "is a table: its standard deviation is a share"),
    ],
)
def test_another_quantity_is_refused(key: str, deviation: str, words: str) -> None:
    table = [["20 degC", "0.2 W/m/K"], ["80 degC", "0.3 W/m/K"]]
    conductivity = {"materials.carcass.conductivity": {"table": table, "source": "test"}}
    with pytest.raises(InputError, match=words) as error:
        _ = tf.study(BIAS, {**conductivity, "uncertainty": {key: deviation}}).uncertain_numbers
    assert error.value.field == f"uncertainty.{key}"


def test_a_deviation_is_set_by_its_dotted_name() -> None:
    study = tf.study(BIAS, {"uncertainty": {"drive.load": "3 %", "drive.ambient": "1 K"}})
    other = study.replace({"uncertainty.drive.load": "5 %", "uncertainty.drive.pressure": "2 psi"})
    assert dict(other.card.uncertainty) == {"drive.load": 0.05, "drive.ambient": "1 K", "drive.pressure": "2 psi"}
    with pytest.raises(InputError, match="did you mean 'load'"):
        tf.study(BIAS, {"uncertainty.drive.lod": "5 %"})


def test_dotted_names_without_quotes_are_refused_in_plain_words() -> None:
    with pytest.raises(InputError, match=r'write dotted names in quotes, e\.g\. "drive\.load" = "2 %"') as error:
        tf.study(BIAS, {"uncertainty": {"drive": {"load": "3 %"}}})
    assert error.value.field == "uncertainty.drive"


def test_a_comparison_has_the_ambient_s_deviation() -> None:
    study = tf.study(BIAS, {"mesh.size": "8 mm", "drive.duration": "60 s", "uncertainty": {"drive.ambient": "2 K"}})
    result = study.run()
    comparison = study.compare(result.readings, result=result)
    rows = comparison.inputs[comparison.inputs["key"] == "drive.ambient"]
    assert rows["relative_sd"].iloc[0] == pytest.approx(2 / (study.card.drive.phases[0].ambient.start + 273.15))
    assert 0 < rows["change_K"].max() <= 2.0


def test_a_study_with_a_deviation_of_no_number_is_refused_as_it_is_read() -> None:
    """A run does not use the table; without this a wrong name there would only show in a comparison."""
    message = r"uncertainty\.drive\.laod: .*did you mean 'load'\?"
    with pytest.raises(InputError, match=message):
        tf.study(BIAS, {"uncertainty": {"drive.laod": "5 %"}})
    with pytest.raises(InputError, match=message):
        tf.study("nasa-campaign", {"uncertainty": {"drive.laod": "5 %"}}).campaign()
