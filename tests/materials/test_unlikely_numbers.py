"""Numbers of a slipped unit or decimal point are warned of with their range and its source; shipped cards are not."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

import pytest

from tyrefem import library
from tyrefem.api import study
from tyrefem.boundaries import laws
from tyrefem.cards import Card, read_toml
from tyrefem.cards.plausible import (
    AIR_FILM,
    CONDUCTIVITY,
    CONTACT_FILM,
    CORD_MODULUS,
    DENSITY,
    EMISSIVITY,
    LOSS_TANGENT,
    SHEAR_MODULUS,
    SPECIFIC_HEAT,
    Plausible,
)
from tyrefem.effects import Prior, catalogue
from tyrefem.errors import InputError
from tyrefem.materials.card import material
from tyrefem.quantity import Unit, parse
from tyrefem.rig import RigCard
from tyrefem.rig import load as rig

SLIPS: list[tuple[str, dict[str, Any]]] = [
    ("density.value", {"density": {"value": "1.18 kg/m**3"}}),
    ("density.value", {"density": {"value": "1180 g/cm**3"}}),
    ("density.table.1", {"density": {"table": [["0 degC", "1100 kg/m**3"], ["50 degC", "1.1 kg/m**3"]]}}),
    ("conductivity.value", {"conductivity": {"value": "250 W/m/K"}}),
    ("conductivity.across", {"conductivity": {"along": "1 W/m/K", "across": "0.002 W/m/K"}}),
    ("conductivity.table.0", {"conductivity": {"table": [["0 degC", "210 W/m/K"], ["50 degC", "0.2 W/m/K"]]}}),
    ("specific_heat.value", {"specific_heat": {"value": "1.8 J/kg/K"}}),
    ("loss_tangent.value", {"loss_tangent": {"value": 8}}),
    ("loss_tangent.value", {"loss_tangent": {"value": "0.01 %"}}),
    ("loss_tangent.table.1", {"loss_tangent": {"law": "table", "table": [["0 degC", 0.2], ["50 degC", 7]]}}),
    ("shear_modulus.value", {"shear_modulus": {"value": "1.3 GPa"}}),
    ("shear_modulus.value", {"shear_modulus": {"value": "1.3 kPa"}}),
    ("elasticity.shear_modulus", {"elasticity": {"law": "neo-hookean", "shear_modulus": "1.3 kPa", "source": "x"}}),
    ("elasticity.c10", {"elasticity": {"law": "yeoh", "c10": "0.6 GPa", "source": "x"}}),
    ("youngs_modulus.value", {"youngs_modulus": {"value": "15e6 MPa", "source": "x"}}),
    ("cord.ply_shear_modulus", {"cord": {"ply_shear_modulus": "2e4 Pa", "source": "x"}}),
    ("cords.modulus", {"cords": {"modulus": "110 MPa", "diameter": "1 mm", "ends": "500 1/m", "angle": "0 deg",
                                 "lift": False, "source": "x"}}),
    ("expansion.coefficient", {"expansion": {"coefficient": "9e-4 1/delta_degC", "source": "x"}}),
]  # fmt: skip


@pytest.mark.parametrize(("field", "changes"), SLIPS, ids=[field for field, _ in SLIPS])
def test_a_slip_is_warned_of(field: str, changes: dict[str, Any]) -> None:
    (warning,) = material({"base": "nasa-tread", **changes}).warnings()
    assert warning.field == field
    assert "is unlikely; likely are" in warning.message
    assert any(word in warning.message for word in ("from memory", "an estimate")), "the range has a source"


@pytest.mark.parametrize("name", library.names("material"))
def test_no_shipped_material_is_unlikely(name: str) -> None:
    assert material(name).warnings() == ()


@pytest.mark.parametrize("name", library.names("study"))
def test_no_shipped_study_is_unlikely(name: str) -> None:
    assert study(name).warnings == ()


def test_no_shipped_rig_is_unlikely_and_slips_are() -> None:
    card, file = rig("trtlab")
    assert card.warnings() == ()
    data = read_toml(file)
    data["surroundings"]["emissivity"] = "9.5 %"
    data["layers"][0]["conductivity"]["value"] = "250 W/m/K"
    data["layers"][1]["density"]["value"] = "1.18 kg/m**3"
    fields = {"surroundings.emissivity", "layers.0.conductivity.value", "layers.1.density.value"}
    assert {warning.field for warning in RigCard.check(data).warnings()} == fields


def test_nothing_is_no_unlikely_number() -> None:
    """A film of zero is an insulated side, a loss tangent of zero a part that is not to heat."""
    assert material({"base": "nasa-tread", "loss_tangent": {"value": 0}}).warnings() == ()
    assert laws("outside_air")["constant"].check({"law": "constant", "coefficient": "0 W/m**2/K"}).warnings() == ()


@pytest.mark.parametrize("side", ["road", "outside_air", "contained_air", "rim", "sliding"])
def test_the_defaults_of_every_law_are_likely(side: str) -> None:
    assert laws(side)
    for name, law in laws(side).items():
        if not any(field.is_required() for key, field in law.model_fields.items() if key != "law"):
            assert law.check({"law": name}).warnings() == (), name
        for key, field in law.model_fields.items():
            ranges = [item for item in field.metadata if isinstance(item, Plausible)]
            if ranges and not field.is_required() and field.default is not None:
                assert ranges[0].warning(field.default, key) is None, f"{name}: {key}"


FILMS = [
    ("boundaries.outside_air.coefficient", {"law": "constant", "coefficient": "2e4 W/m**2/K"}),
    (
        "boundaries.outside_air.table.1",
        {"law": "table", "table": [["0 mph", "5 W/m**2/K"], ["9 mph", "5 cal/cm**2/s/K"]]},
    ),
    ("boundaries.contained_air.film", {"law": "gas", "film": "1 cal/cm**2/s/K"}),
    ("boundaries.road.coefficient", {"law": "constant", "coefficient": "1 W/m**2/K"}),
    ("boundaries.rim.mass", {"law": "lumped", "mass": "8 g", "cooling": "10 W/K"}),
]


@pytest.mark.parametrize(("field", "law"), FILMS, ids=[field for field, _ in FILMS])
def test_films_of_a_study(field: str, law: dict[str, Any]) -> None:
    side = field.split(".")[1]
    (warning,) = study("nasa-22x5.5-8pr", {f"boundaries.{side}": law}).warnings
    assert warning.field == field
    assert str(warning).startswith(str(study("nasa-22x5.5-8pr").file))


def test_emissivity_of_an_effect() -> None:
    radiating = {"effects": [{"name": "radiation", "emissivity": "9 %"}]}
    (warning,) = study("nasa-22x5.5-8pr", radiating).warnings
    assert warning.field == "effects.0.emissivity"
    assert catalogue()["radiation"].check({"emissivity": 0.9}).warnings() == ()


def test_a_card_in_several_regions_is_warned_of_once() -> None:
    slip = {"base": "nasa-tread", "density": {"value": "1.18 kg/m**3"}}
    (warning,) = study("nasa-22x5.5-8pr", {"materials.tread": slip, "materials.sidewall": slip}).warnings
    assert warning.field == "materials.tread.density.value"
    assert "(so in sidewall)" in warning.message


def _all_cards(card: type[Card]) -> Iterator[type[Card]]:
    for below in card.__subclasses__():
        yield below
        yield from _all_cards(below)


def test_every_range_is_in_the_unit_of_its_field() -> None:
    """Values are held against it in SI: a range in another unit would be wrong by its factor."""
    checked = 0
    for card in set(_all_cards(Card)):
        for name, field in card.model_fields.items():
            metadata = [*field.metadata, *(item for part in get_args(field.annotation) for item in get_args(part)[1:])]
            for likely in (item for item in metadata if isinstance(item, Plausible)):
                (unit,) = [item.unit for item in metadata if isinstance(item, Unit | Prior)]
                assert parse("1" if likely.unit == "1" else f"1 {likely.unit}", unit) == 1.0, f"{card.__name__}.{name}"
                assert likely.low < likely.high
                checked += 1
    assert checked > 20


def test_the_documentation_has_the_same_ranges() -> None:
    text = (Path(__file__).parents[2] / "docs/studies.md").read_text(encoding="utf-8")
    for likely in (DENSITY, CONDUCTIVITY, SPECIFIC_HEAT, LOSS_TANGENT, AIR_FILM, CONTACT_FILM, EMISSIVITY):
        assert f"outside {likely.low:g} to {likely.high:g}" in text
    for likely, unit in ((SHEAR_MODULUS, 1e6), (CORD_MODULUS, 1e9)):
        assert f"{likely.low / unit:g} to {likely.high / unit:g}" in text


STUDY_SLIPS: list[tuple[str, dict[str, Any]]] = [
    ("materials.tread.loss_tangent.rate", {"materials.tread.loss_tangent.at": "1000 degC"}),
    ("materials.tread.loss_tangent.rate", {"materials.tread.loss_tangent.rate": "0.148 1/delta_degC"}),
    (
        "materials.tread.softening.rate",
        {"materials.tread.softening": {"rate": "0.1 1/delta_degC", "at": "500 degC", "source": "x"}},
    ),
    (
        "materials.tread.softening.table.1",
        {"materials.tread.softening": {"law": "table", "table": [["20 degC", 1], ["80 degC", 5e3]], "source": "x"}},
    ),
    ("drive.ambient", {"drive.ambient": "298 degC"}),
    ("sensors.shoulder-inner.lag", {"sensors.shoulder-inner.lag": "2000 s"}),
    ("sensors.shoulder-inner.position_sd", {"sensors.shoulder-inner.position_sd": "2 m"}),
    ("boundaries.outside_air.per_speed", {"boundaries.outside_air.per_speed": "1.7 kW*s/m**3/K"}),
    ("boundaries.contained_air.gas_constant", {"boundaries.contained_air.gas_constant": "8.3 J/kg/K"}),
    ("boundaries.rim.contact_resistance", {"boundaries.rim.contact_resistance": "2 m**2*K/W"}),
    ("boundaries.sliding.decomposition_temperature", {"boundaries.sliding.decomposition_temperature": "20 degC"}),
    ("boundaries.sliding.pressure", {"boundaries.sliding.pressure": "300 Pa"}),
    ("section.parameters.inner_volume", {"section.inner_volume": "13 m**3"}),
    ("section.rating.load", {"section.rating.load": "4350 MN"}),
    ("section.rating.pressure", {"section.rating.pressure": "156 MPa"}),
    ("section.rating.bead_wire_area", {"section.rating.bead_wire_area": "0.06 m**2"}),
    (
        "mechanics.load_law.stiffness",
        {"mechanics.load_law": {"law": "vertical-stiffness", "stiffness": "3 N/mm", "source": "x"}},
    ),
    ("mechanics.footprint.length", {"mechanics.footprint": {"law": "given", "length": "0.15 mm"}}),
    ("mesh", {"mesh.unit": "mm"}),
]


@pytest.mark.parametrize(("field", "changes"), STUDY_SLIPS, ids=[field for field, _ in STUDY_SLIPS])
def test_a_slip_in_a_study_is_warned_of(field: str, changes: dict[str, Any]) -> None:
    """These passed unseen: a tread was computed at 1024 degC after 20 s of slow rolling."""
    (warning,) = study("nasa-22x5.5-8pr", changes).warnings
    assert warning.field == field


def test_a_given_energy_that_tears_rubber() -> None:
    energies = {"tread": "10 kJ/m**3", "sidewall": "3 kJ/m**3", "bead": "0 J/m**3"}
    energy = {"load": "12 kN", "pressure": "83 psi", "source": "x", "regions": {**energies, "carcass": "12 GJ/m**3"}}
    (warning,) = study("nasa-22x5.5-8pr", {"mechanics.energy": energy}).warnings
    assert warning.field == "mechanics.energy.regions.carcass"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"table": [["20 degC", 0.2], ["80 degC", 50]], "law": "table"}, r"table\.1: 50 is out of range"),
        ({"table": [["20 degC", 0.2], ["8000 degC", 0.1]], "law": "table"}, r"table\.1: '8000 degC' is out of range"),
    ],
)
def test_a_table_has_the_limits_of_a_number(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        material({"base": "nasa-tread", "loss_tangent": changes})
