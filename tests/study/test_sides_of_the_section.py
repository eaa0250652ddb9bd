"""A study's surroundings need the parts of a section's outside by their names."""

from __future__ import annotations

from pathlib import Path

import pytest

import tyrefem as tf
from tyrefem import library
from tyrefem.errors import InputError

pytestmark = pytest.mark.fast


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            '[[boundaries]]\nname = "road"\nto = "shoulder"\n',
            "",
            "'road' is missing; a study wants road, outside_air, rim",
        ),
        ('name = "outside_air"', 'name = "outside-air"', "unknown 'outside-air'; did you mean 'outside_air'"),
        ('to = "rim_start"\n', 'to = "3.2 in"\n[[boundaries]]\nname = "vent"\nto = "rim_start"\n', "unknown 'vent'"),
    ],
)
def test_a_part_that_no_surrounding_knows(old: str, new: str, message: str, tmp_path: Path) -> None:
    """A part of an unknown name was insulated, without a word; a missing one failed without a file's name."""
    text = library.find("section", "nasa-22x5.5-8pr").read_text(encoding="utf-8")
    assert old in text
    (tmp_path / "mine.toml").write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputError, match=rf"study\.toml: section: section 'mine', \[\[boundaries\]\]: {message}"):
        tf.study("nasa-22x5.5-8pr", {"section": str(tmp_path / "mine.toml")})
