"""The schemas accept what tyrefem reads, refuse typical mistakes, and explain every key."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft7Validator
from jsonschema.exceptions import best_match

from tyrefem import library
from tyrefem.cards import merged, read_toml
from tyrefem.errors import InputError
from tyrefem.materials.card import MaterialCard
from tyrefem.output.folder import checksum
from tyrefem.quantity import parse
from tyrefem.quantity.pattern import EXAMPLES, FORMS, NAMES, pattern
from tyrefem.schemas.files import FILES
from tyrefem.schemas.line import BEGINS
from tyrefem.schemas.written import settings, texts

pytestmark = pytest.mark.fast

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = {
    "study": "studies/*/study.toml", "section": "geometry/*.toml", "material": "materials/*.toml",
    "sweep": "studies/*/sweep.toml", "rig": "studies/*/rig.toml", "thermal": "studies/*/thermal.toml",
}  # fmt: skip
FILES_SHIPPED = [(kind, file) for kind, pattern in SHIPPED.items() for file in sorted(ROOT.glob(pattern))]
#: A unit of each kind of quantity, in which `parse` reads its names.
UNIT_OF_KIND = {
    "length": "m", "time": "s", "mass": "kg", "force": "N", "pressure": "Pa", "energy": "J", "power": "W",
    "temperature": "degC", "difference": "delta_degC", "angle": "rad", "speed": "m/s", "volume": "m**3",
    "frequency": "Hz", "ratio": "1",
}  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def of_the_repository(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Only shipped cards and effects: none of the working folder, none of the environment."""
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("empty"))
        patch.delenv("TYREFEM_EFFECTS", raising=False)
        patch.delenv(library.SEARCH_PATH, raising=False)
        yield


@pytest.fixture(scope="module")
def made() -> dict[str, str]:
    return texts()


@pytest.fixture(scope="module")
def schemas(made: dict[str, str]) -> dict[str, Any]:
    return {kind: json.loads(made[f"{kind}.json"]) for kind in FILES}


def problem(schema: Any, data: Any) -> Any:
    return best_match(Draft7Validator(schema).iter_errors(data))


def test_the_shipped_schemas_are_those_of_the_cards(made: dict[str, str]) -> None:
    """After a change of cards, effects, laws or answers: tyrefem schema."""
    assert {file.name for file in (ROOT / "schemas").glob("*.json")} == {*made, "summary.json"}
    for name, text in made.items():
        assert (ROOT / "schemas" / name).read_text(encoding="utf-8") == text, f"run 'tyrefem schema': {name} is old"
    # Else the command takes them for files of somebody else, and refuses to replace them in a fresh clone.
    written = json.loads((ROOT / "schemas/summary.json").read_text(encoding="utf-8"))["checksums"]
    assert {name: checksum(ROOT / "schemas" / name) for name in made} == written, "run 'tyrefem schema --force'"
    assert (ROOT / ".taplo.toml").read_text(encoding="utf-8") == settings("schemas")


def test_the_schemas_are_of_draft_7(schemas: dict[str, Any]) -> None:
    for schema in schemas.values():
        Draft7Validator.check_schema(schema)
        assert schema["$schema"] == "http://json-schema.org/draft-07/schema#"


@pytest.mark.parametrize(("kind", "file"), FILES_SHIPPED, ids=lambda value: getattr(value, "stem", value))
def test_a_shipped_file_names_its_schema_and_obeys_it(kind: str, file: Path, schemas: dict[str, Any]) -> None:
    text = file.read_text(encoding="utf-8")
    first, _, _ = text.partition("\n")
    assert first.startswith(BEGINS)
    assert (file.parent / first.removeprefix(BEGINS)).resolve() == ROOT / "schemas" / f"{kind}.json"
    wrong = problem(schemas[kind], tomllib.loads(text))
    assert wrong is None, f"{list(wrong.absolute_path)}: {wrong.message}"


#: Kind and name of a shipped file, a change that is a mistake, the place that the schema names.
MISTAKES = {
    "misspelt key": ("material", "nasa-tread", {"conductivity": {"relativ_sd": "5 %"}}, "conductivity"),
    "misspelt table": ("study", "nasa-22x5.5-8pr", {"boundarys": {}}, ""),
    "wrong unit": ("material", "nasa-tread", {"conductivity": {"value": "0.25 W/m"}}, "conductivity.value"),
    "no unit": ("material", "nasa-tread", {"density": {"value": 1100}}, "density.value"),
    "no unit in text": ("study", "nasa-22x5.5-8pr", {"mesh": {"size": "3"}}, "mesh.size"),
    "a temperature in place of a difference": (
        "study", "nasa-22x5.5-8pr", {"numerics": {"tolerance": "1 degC"}}, "numerics.tolerance",
    ),
    "negative": ("study", "nasa-22x5.5-8pr", {"drive": {"speed": "-5 m/s"}}, "drive.speed"),
    "unknown boundary law": (
        "study", "nasa-22x5.5-8pr", {"boundaries": {"road": {"law": "conduct"}}}, "boundaries.road",
    ),
    "key of another law": (
        "study", "nasa-22x5.5-8pr", {"boundaries": {"rim": {"law": "fixed", "mass": "8 kg"}}}, "boundaries.rim",
    ),
    "unknown strain law": ("study", "nasa-22x5.5-8pr", {"mechanics": {"strain": "arc"}}, "mechanics.strain"),
    "unknown loss law": ("material", "nasa-tread", {"loss_tangent": {"law": "expo"}}, "loss_tangent.law"),
    "unknown elastic law": ("material", "rubber-liner", {"elasticity": {"law": "mooney"}}, "elasticity"),
    "unknown effect": ("study", "nasa-22x5.5-8pr", {"effects": [{"name": "sunn"}]}, "effects.0"),
    "key of another effect": (
        "study", "nasa-22x5.5-8pr", {"effects": [{"name": "sun", "rate": "1 delta_degC/s"}]}, "effects.0",
    ),
    "effect without its sensor": ("study", "nasa-22x5.5-8pr", {"effects": [{"name": "sensor-lag"}]}, "effects.0"),
    "misspelt key of a changed material": (
        "study", "nasa-22x5.5-8pr", {"materials": {"tread": {"base": "nasa-tread", "densty": {}}}}, "materials.tread",
    ),
    "misspelt key of a changed section": (
        "study", "nasa-22x5.5-8pr", {"section": {"base": "nasa-22x5.5-8pr", "rateing": {}}}, "section",
    ),
    "unknown mark": (
        "section", "nasa-22x5.5-8pr", {"boundaries": [{"name": "road", "to": "sholder"}]}, "boundaries.0.to",
    ),
    "unknown excluded effect": ("study", "hidden-effect", {"diagnosis": {"exclude": ["sunn"]}}, "diagnosis.exclude.0"),
    "quantity that no plan limits": (
        "study", "hidden-effect", {"plan": {"limits": {"drive.sped": ["1 m/s", "2 m/s"]}}}, "plan.limits",
    ),
    "misspelt key of a varied number": (
        "sweep", "crown-angle", {"vary": {"section.cord_angle": {"from": "3 deg", "too": "4 deg"}}}, "vary",
    ),
    "unknown sample": ("sweep", "crown-angle", {"sample": "halton"}, "sample"),
    "power in volts": ("rig", "rig-layers", {"runs": {"low": {"power": "5 V"}}}, "runs.low.power"),
}  # fmt: skip


def shipped(kind: str, name: str) -> dict[str, Any]:
    file = ROOT / f"studies/{name}/rig.toml" if kind == "rig" else library.find(kind, name)
    return read_toml(file)


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_typical_mistake_is_refused_where_it_is(mistake: str, schemas: dict[str, Any]) -> None:
    kind, name, change, place = MISTAKES[mistake]
    data = shipped(kind, name)
    assert problem(schemas[kind], data) is None
    errors = [*Draft7Validator(schemas[kind]).iter_errors(merged(data, change))]
    places = {".".join(map(str, error.absolute_path)) for error in errors}
    assert [name for name in places if name.startswith(place)], places


#: What tyrefem reads in more than one form.
FORMS_READ = {
    "law by its name": ("study", {"boundaries": {"road": "constant"}}),
    "table of the default law": ("study", {"boundaries": {"road": {"coefficient": "900 W/m**2/K"}}}),
    "size as section": ("study", {"section": "205/60R15"}),
    "size with numbers": ("study", {"section": {"size": "205/60R15", "rim_width": "6 in", "parameters": {"plies": 2}}}),
    "changed material": ("study", {"materials": {"tread": {"base": "nasa-tread", "density": {"value": "1 g/cm**3"}}}}),
    "changed elastic constant": (
        "study", {"materials": {"tread": {"base": "rubber-liner", "elasticity": {"shear_modulus": "2 MPa"}}}},
    ),
    "layer by number": (
        "study", {"section": {"base": "nasa-22x5.5-8pr", "layers": {"0": {"regions": {"0": {"to": "2 in"}}}}}},
    ),
    "ramp": ("study", {"drive": {"speed": {"from": "0 mph", "to": "20 mph"}}}),
    "phases with defaults": ("study", {"drive": {"phases": [{"name": "a"}, {"speed": "0 m/s", "duration": "60 s"}]}}),
    "energies by rows": (
        "study",
        {"mechanics": {"strain": "given", "energy": {
            "load": "2 kN", "pressure": "2 bar", "source": "x", "regions": {"tread": [["0 mm", "1 kJ/m**3"]]}}}},
    ),
    "percent": ("material", {"conductivity": {"relative_sd": "5 %"}}),
    "plain ratio": ("material", {"conductivity": {"relative_sd": 0.05}}),
    "table over temperature": (
        "material", {"specific_heat": {"table": [["20 degC", "1500 J/kg/K"], ["100 degC", "1700 J/kg/K"]]}},
    ),
    "conductivity across": ("material", {"conductivity": {"along": "1 W/m/K", "across": "0.3 W/(m K)"}}),
    "fahrenheit": ("material", {"loss_tangent": {"at": "77 degF"}}),
    "varied by nested keys": ("sweep", {"vary": {"drive": {"speed": {"from": "10 mph", "to": "20 mph"}}}}),
    "varied by a list": ("sweep", {"vary": {"drive.speed": ["10 mph", "20 mph"]}}),
    "tornado": ("sweep", {"tornado": {"tolerances": {"drive": {"load": "5 %"}}}}),
}  # fmt: skip
OF_KIND = {"study": "nasa-22x5.5-8pr", "material": "nasa-tread", "sweep": "crown-angle"}


@pytest.mark.parametrize("form", FORMS_READ)
def test_every_form_that_is_read_is_accepted(form: str, schemas: dict[str, Any]) -> None:
    kind, change = FORMS_READ[form]
    wrong = problem(schemas[kind], merged(shipped(kind, OF_KIND[kind]), change))
    assert wrong is None, f"{list(wrong.absolute_path)}: {wrong.message}"


@pytest.mark.parametrize("text", ["0.25 W/m/K", "0.25 W/m/degC", "0.25 W/(m K)", "250 mW/m/K", "0.25 W/K/m", "0.25"])
def test_card_and_schema_agree_about_units(text: str, schemas: dict[str, Any]) -> None:
    data = merged(shipped("material", "nasa-tread"), {"conductivity": {"value": text}})
    try:
        MaterialCard.check(data)
        read = True
    except InputError:
        read = False
    assert (problem(schemas["material"], data) is None) == read


def keys_of(schema: Any, place: str = "") -> Iterator[tuple[str, Any]]:
    """Every key of every table, with its schema."""
    if isinstance(schema, list):
        for entry in schema:
            yield from keys_of(entry, place)
    elif isinstance(schema, dict):
        for name, below in schema.items():
            if name == "properties":
                for key, value in below.items():
                    yield f"{place}.{key}", value
                    yield from keys_of(value, f"{place}.{key}")
            else:
                yield from keys_of(below, place if name != "definitions" else "")


def test_every_key_has_a_title_and_words(schemas: dict[str, Any]) -> None:
    for kind, schema in schemas.items():
        tables = [(kind, {key: value for key, value in schema.items() if key != "definitions"})]
        tables += [*schema["definitions"].items()]
        for name, table in tables:
            for place, key in keys_of(table, name):
                # The names of laws and effects stand again in front of their tables.
                if place.endswith((".law", ".name")) and "enum" in key:
                    continue
                words = key.get("description") or _referred(schema, key).get("description")
                assert words, f"{kind}: {place} is not explained: in its class's docstring, or in schemas/keys.py"
                assert key.get("title") or _referred(schema, key).get("title"), place


def _referred(schema: Any, key: Any) -> Any:
    reference = key.get("$ref") or next((part["$ref"] for part in key.get("allOf", []) if "$ref" in part), "")
    return schema["definitions"].get(reference.rpartition("/")[2], {})


def test_a_key_with_a_unit_says_unit_range_and_example(schemas: dict[str, Any]) -> None:
    modulus = schemas["material"]["definitions"]["ShearModulus"]["properties"]["value"]
    assert modulus["title"] == "Value [Pa]"
    assert "More than 0 Pa" in modulus["description"]
    assert "Likely: 50000 to 2e+08 Pa (gum 0.2 MPa to hard apex" in modulus["description"]
    assert "210 kPa" in modulus["examples"]
    size = schemas["study"]["definitions"]["MeshChoice"]["properties"]["size"]
    assert size["default"] == "3 mm"
    drift = schemas["study"]["definitions"]["Sun"]["properties"]["absorbed"]
    assert drift["title"] == "Absorbed [W/m2]"
    assert "at most 600 W/m2" in drift["description"]


def test_editors_are_offered_the_shipped_names(schemas: dict[str, Any]) -> None:
    offered = schemas["study"]["properties"]["section"]["anyOf"][0]["enum"]
    assert offered == sorted(library.names("section"))


@pytest.mark.parametrize("kind", UNIT_OF_KIND)
def test_the_patterns_hold_units_that_are_read(kind: str) -> None:
    for name in NAMES[kind].split():
        parse(f"1 {name}", UNIT_OF_KIND[kind])


@pytest.mark.parametrize("unit", FORMS)
def test_every_form_of_a_unit_is_read_and_matched(unit: str) -> None:
    matches = re.compile(pattern(unit))
    for above, below in FORMS[unit]:
        for kind in {part.rstrip("23") for part in (above + " " + below).split()} - {"1"}:
            for name in NAMES[kind].split():

                def written(part: str, kind: str = kind, name: str = name) -> str:
                    of_part = part.rstrip("23")
                    unit = "1" if of_part == "1" else name if of_part == kind else NAMES[of_part].split()[0]
                    return unit + (f"**{part[-1]}" if part[-1] in "23" else "")

                text = "2 " + "*".join(map(written, above.split())) + "".join(f"/{written(p)}" for p in below.split())
                assert matches.search(text), text
                parse(text, unit)


@pytest.mark.parametrize("unit", EXAMPLES)
def test_every_example_is_read_and_matched(unit: str) -> None:
    assert unit == "1" or unit in FORMS
    for text in EXAMPLES[unit]:
        assert re.search(pattern(unit), text), text
        parse(text, unit)
