"""docs/commands.md has every command and key."""

from __future__ import annotations

import make_commands_page
import pytest
from jsonschema import Draft7Validator

from tyrefem.schemas.answer_schema import TYPES, answer_schema, parts_of, steps_of, unknown_keys
from tyrefem.schemas.answers import ANSWERS
from tyrefem.schemas.inner_rows import COMMON, INNER
from tyrefem.schemas.rows import ROWS, rows_of

pytestmark = pytest.mark.fast


def test_the_page_is_up_to_date() -> None:
    """After a change of commands or keys: python tools/make_commands_page.py."""
    text = make_commands_page.PAGE.read_text(encoding="utf-8")
    assert make_commands_page.page(text) == text


def test_every_line_has_a_kind_and_words() -> None:
    common = [row for rows in COMMON.values() for row in rows.items()]
    for command, keys in [*ANSWERS.items(), *ROWS.items(), *INNER.items(), *common]:
        for key, line in keys.items():
            kind, _, words = parts_of(line)
            assert kind in (*TYPES, "any"), (command, key)
            assert words.endswith((".", "?")), (command, key)


def test_every_row_belongs_to_a_key_of_a_command() -> None:
    assert not set(ROWS) & set(INNER)
    for place in [*ROWS, *INNER]:
        command, _, inside = place.partition(".")
        assert command in ANSWERS, place
        name, ending = steps_of(inside)[0]
        line = ANSWERS[command].get(name) or ANSWERS[command][f"{name}*"]
        assert (parts_of(line)[0] == "list") == (ending == "[]"), place


def test_a_row_without_a_key_or_of_another_kind_is_refused() -> None:
    schema = Draft7Validator(answer_schema("rig layers"))
    row = dict.fromkeys(rows_of("rig layers")["rows[]"], 1) | {"names": "tread"}
    assert schema.is_valid({"rows": [row]})
    assert schema.is_valid({"rows": [{**row, "of_tomorrow": 3}]})
    assert not schema.is_valid({"rows": [{key: value for key, value in row.items() if key != "rms_K"}]})
    assert not schema.is_valid({"rows": [{**row, "rms_K": "little"}]})


def test_rows_behind_names_are_checked_too() -> None:
    schema = Draft7Validator({**answer_schema("run"), "required": []})
    assert schema.is_valid({"sensors": {"crown": {"end_degC": 70.0, "max_degC": 70.0}}})
    assert not schema.is_valid({"sensors": {"crown": {"end_degC": 70.0}}})


def test_a_key_without_words_is_seen_at_any_depth() -> None:
    schema = answer_schema("wear")
    phase = {"name": "a", "distance_m": 1.0, "friction_work_J": 2.0, "mean_wear_mm_per_1000_km": 0.1}
    assert list(unknown_keys({"phases": [phase], "versions": {"numpy": "2.0"}}, schema)) == []
    assert list(unknown_keys({"phases": [{**phase, "mood": 1}]}, schema)) == [".phases[].mood"]
    # Names with a value each: no tables behind them.
    assert list(unknown_keys({"versions": {"numpy": {"major": 2}}}, schema)) == [".versions{} ['major']"]
    # A file of the user's stands as it was written.
    assert list(unknown_keys({"card": {"depth": {"any": 1}}}, schema)) == []


def test_keys_of_one_kind_of_answer_are_known() -> None:
    """Of a wear by the drive, a rotating tyre, a card with areas, and a data's model of another kind."""
    for command, key, places in (
        ("wear", "distance_m", ()), ("modes", "direction", ("modes",)), ("modes", "axle_frequency_Hz", ("modes",)),
        ("thermal-card", "per_area_sd", ("numbers",)), ("blind", "identifiable_alone", ("cases",)),
        ("blind", "stated", ("reliability",)), ("blind", "fault", ("failures",)),
    ):  # fmt: skip
        schema = answer_schema(command)
        for place in places:
            schema = schema["properties"][place]["items"]
        assert key in schema["properties"], (command, key)


def test_deep_keys_of_a_diagnosis_are_in_the_schema() -> None:
    schema = answer_schema("diagnose")
    law = schema["properties"]["missing_heat"]["properties"]["law"]["properties"]
    assert law["exponents"]["items"]["properties"]["mean"]["description"] == "Exponent."
    assert law["switch_probabilities"]["additionalProperties"] == {"not": {"type": "object"}}


def test_the_page_of_the_diagnosis_names_every_key_of_its_record() -> None:
    page = make_commands_page.PAGE.with_name("diagnosis.md").read_text(encoding="utf-8")
    assert [key for key in ANSWERS["diagnose"] if f"`{key.rstrip('*')}`" not in page] == []
