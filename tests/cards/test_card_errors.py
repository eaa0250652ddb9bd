"""A card that is wrong says where, what is allowed, and the nearest spelling."""

from __future__ import annotations

import copy

import pytest

from tyrefem import library, study
from tyrefem.cards import merged, read_toml
from tyrefem.errors import InputError
from tyrefem.materials.card import MaterialCard, material
from tyrefem.variants.card import VaryCard

pytestmark = pytest.mark.fast


@pytest.fixture
def tread():
    return copy.deepcopy(library.load("material", "nasa-tread")[0])


def test_an_unknown_key_gets_the_nearest_spelling(tread):
    tread["conductivty"] = tread.pop("conductivity")
    with pytest.raises(InputError, match="did you mean 'conductivity'"):
        MaterialCard.check(tread)


@pytest.mark.parametrize("name", ["conductivity", "density", "specific_heat", "loss_tangent", "shear_modulus"])
def test_a_number_without_source_is_refused(tread, name):
    del tread[name]["source"]
    with pytest.raises(InputError, match=f"{name}.source: missing"):
        MaterialCard.check(tread)


def test_a_number_without_unit_is_refused(tread):
    tread["density"]["value"] = 1000.0
    with pytest.raises(InputError, match=r"density\.value: 1000\.0 has no unit"):
        MaterialCard.check(tread)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ([["20 degC", "0.2 W/m/K"]], "at least two rows"),
        ([["20 degC", "0.2 W/m/K"], ["20 degC", "0.3 W/m/K"]], "must rise"),
        ([["20 degC", "0.2 W/m/K"], ["30 degC"]], r"table.1: row must have 2 entries"),
        ([["20 degC", "0.2 W/m/K"], ["30 degC", "-0.3 W/m/K"]], r"table.1: '-0.3 W/m/K' is out of range"),
        ([["20 degC", "0.2 W/m/K"], ["30 degC", "0.3 W/m"]], r"table.1"),
    ],
)
def test_a_bad_table_row_is_named(tread, table, message):
    tread["conductivity"] = {"table": table, "source": "test"}
    with pytest.raises(InputError, match=message):
        MaterialCard.check(tread)


@pytest.mark.parametrize(("value", "shown"), [("sun", "'sun'"), ({"sun": {}}, "{'sun': {}}")])
def test_a_value_in_place_of_a_list_is_refused(value, shown):
    with pytest.raises(InputError, match=f"effects: must be a list in square brackets, not {shown}$"):
        study("nasa-22x5.5-8pr", {"effects": value})


def test_two_forms_of_one_property_are_refused(tread):
    tread["conductivity"]["along"] = "0.3 W/m/K"
    with pytest.raises(InputError, match="exactly one of"):
        MaterialCard.check(tread)


def test_the_error_names_file_and_field(tmp_path):
    file = tmp_path / "soft.toml"
    file.write_text(library.find("material", "nasa-tread").read_text().replace("0.5 cal/g/K", "0.5 cal/g"))
    with pytest.raises(InputError) as caught:
        material(str(file))
    assert str(file) in str(caught.value)
    assert "specific_heat.value" in str(caught.value)


def test_a_file_that_is_not_toml_names_the_line(tmp_path):
    file = tmp_path / "bad.toml"
    file.write_text("title = 'x'\n= 3\n")
    with pytest.raises(InputError, match="line 2"):
        read_toml(file)


def test_an_unknown_card_gets_the_nearest_name():
    with pytest.raises(InputError, match="did you mean 'nasa-tread'"):
        material("nasa-tred")


def test_cards_are_immutable():
    with pytest.raises(ValueError, match="frozen"):
        material("nasa-tread").title = "another"


def test_laying_changes_over_a_card_leaves_the_rest():
    base = {"a": {"b": 1, "c": 2}, "d": 3}
    assert merged(base, {"a": {"b": 9}}) == {"a": {"b": 9, "c": 2}, "d": 3}
    assert base["a"]["b"] == 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"sensors": []}, r"sensors: must be a table of keys, not \[\]$"),
        ({"title": ""}, "title: must not be empty$"),
        ({"mechanics.energy": {"load": "1 N", "pressure": "1 Pa", "source": "me", "regions": {}}}, "at least 1 entry"),
    ],
)
def test_a_table_where_a_table_is_wanted(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        study("nasa-22x5.5-8pr", change)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"cords": {"lift": "maybe"}}, "cords.lift: must be true or false, not 'maybe'$"),
        ({"cords": {"plies": "two"}}, "cords.plies: must be a whole number, not 'two'$"),
        ({"cords": {"plies": 1.5}}, "cords.plies: must be a whole number, not 1.5$"),
        ({"softening": {"law": "table", "table": "x", "source": "t"}}, "^softening.table: must be a list"),
        ({"elasticity": {"c40": "1 MPa"}}, "^elasticity: unknown key 'c40'"),
    ],
)
def test_errors_name_the_keys_of_the_file_and_what_is_allowed(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        MaterialCard.check(merged(library.load("material", "passenger-belt")[0], change))


@pytest.mark.parametrize("value", ["9" * 5000, "[" * 3000 + "]" * 3000], ids=["digits", "lists"])
def test_a_file_that_the_parser_gives_up_is_an_error_of_the_file(tmp_path, value):
    file = tmp_path / "odd.toml"
    file.write_text(f"a = {value}\n")
    with pytest.raises(InputError, match=r"odd\.toml: not valid TOML"):
        read_toml(file)


def test_a_raised_digit_is_no_number_of_an_entry():
    with pytest.raises(InputError, match="layers: no entry '²'; allowed: liner"):
        merged({"layers": [{"name": "liner"}]}, {"layers": {"²": {"name": "ply"}}})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mesh.through": True}, r"mesh\.through: must be a number, not True$"),
        ({"plan.drives": False}, r"plan\.drives: must be a number, not False$"),
        ({"materials.tread.elasticity": "yeoh"}, r"materials\.tread\.elasticity: must be a table of keys, not 'yeoh'$"),
        (
            {"materials.tread.conductivity": "0.3 W/m/K"},
            r"conductivity: .* not '0.3 W/m/K'; its number has the key 'value'$",
        ),
        (
            {"materials.tread.loss_tangent": 0.2},
            r"materials\.tread\.loss_tangent: .* not 0.2; its number has the key 'value'$",
        ),
    ],
)
def test_a_value_of_another_kind(change: dict[str, object], message: str) -> None:
    """True was taken for 1, and a word for a table was refused in words of a library."""
    with pytest.raises(InputError, match=message):
        study("nasa-22x5.5-8pr", change)


def test_true_is_no_number_of_a_sweep() -> None:
    with pytest.raises(InputError, match=r"^factor\.0: must be a number, not True$"):
        VaryCard.check({"factor": [True, 2]})
    assert VaryCard.check({"values": [True, False]}).values == [True, False]


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"materials.tread.density.value": "-1 kg/m**3"}, "materials.tread.density.value"),
        ({"materials.tread.densty.value": "1 kg/m**3"}, "materials.tread"),
        ({"section.crown_radius": "0 in"}, "section.parameters.crown_radius"),
        ({"section.crown_radius": "1 in"}, "section.parameters.crown_radius"),
    ],
)
def test_a_wrong_change_of_a_card_is_the_studys(change: dict[str, object], field: str) -> None:
    """The message named the file of the card, in which the wrong value is not."""
    known = study("nasa-22x5.5-8pr")
    for changed in (lambda: study("nasa-22x5.5-8pr", change), lambda: known.replace(change)):
        with pytest.raises(InputError) as caught:
            changed()
        assert (caught.value.file, caught.value.field) == (known.file, field)


def test_a_wrong_card_with_changes_is_the_cards(tmp_path) -> None:
    wrong = library.find("material", "nasa-tread").read_text().replace("0.5 cal/g/K", "0.5 cal/g")
    (tmp_path / "soft.toml").write_text(wrong)
    with pytest.raises(InputError) as caught:
        study("nasa-22x5.5-8pr", {"materials.tread": {"base": str(tmp_path / "soft.toml"), "notes": "mine"}})
    assert (caught.value.file, caught.value.field) == (tmp_path / "soft.toml", "specific_heat.value")
