"""docs/commands.md has every command and key."""

from __future__ import annotations

import make_commands_page
import pytest

from tyrefem.schemas.answer_schema import TYPES, parts_of
from tyrefem.schemas.answers import ANSWERS

pytestmark = pytest.mark.fast


def test_the_page_is_up_to_date() -> None:
    """After a change of commands or keys: python tools/make_commands_page.py."""
    text = make_commands_page.PAGE.read_text(encoding="utf-8")
    assert make_commands_page.page(text) == text


def test_every_line_has_a_kind_and_words() -> None:
    for command, keys in ANSWERS.items():
        for key, line in keys.items():
            kind, _, words = parts_of(line)
            assert kind in (*TYPES, "any"), (command, key)
            assert words.endswith("."), (command, key)
