"""Keys with letters that TOML takes in quotes only: the error says so."""

from __future__ import annotations

from pathlib import Path

import pytest

from tyrefem.cards import read_toml
from tyrefem.errors import InputError

pytestmark = pytest.mark.fast


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ('title = "x"\n[sensors]\ngürtel = { s = "1 in" }\n', "gürtel"),
        ("[materials.flügel]\n", "flügel"),
        ("drive.phases.straße.speed = 1\n", "straße"),
    ],
)
def test_a_name_with_other_letters_is_to_be_quoted(text: str, name: str, tmp_path: Path) -> None:
    file = tmp_path / "study.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=f"write '{name}' in double quotes"):
        read_toml(file)
    file.write_text(text.replace(name, f'"{name}"'), encoding="utf-8")
    assert read_toml(file)


@pytest.mark.parametrize("text", ['title = "ü\n', "speed = \n", "a b = 1\n"])
def test_other_mistakes_have_no_such_advice(text: str, tmp_path: Path) -> None:
    file = tmp_path / "study.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match="not valid TOML") as caught:
        read_toml(file)
    assert "double quotes" not in str(caught.value)
