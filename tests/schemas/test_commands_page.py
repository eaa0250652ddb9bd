"""docs/commands.md has every command and key."""

from __future__ import annotations

import make_commands_page
import pytest
from jsonschema import Draft7Validator

from tyrefem.schemas.answer_schema import TYPES, answer_schema, parts_of, steps_of
from tyrefem.schemas.answers import ANSWERS
from tyrefem.schemas.rows import ROWS, rows_of

pytestmark = pytest.mark.fast


def test_the_page_is_up_to_date() -> None:
    """After a change of commands or keys: python tools/make_commands_page.py."""
    text = make_commands_page.PAGE.read_text(encoding="utf-8")
    assert make_commands_page.page(text) == text


def test_every_line_has_a_kind_and_words() -> None:
    for command, keys in [*ANSWERS.items(), *ROWS.items()]:
        for key, line in keys.items():
            kind, _, words = parts_of(line)
            assert kind in (*TYPES, "any"), (command, key)
            assert words.endswith((".", "?")), (command, key)


def test_every_row_belongs_to_a_key_of_a_command() -> None:
    for place in ROWS:
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
