"""A card file is parsed once for as long as it stays as it is."""

from __future__ import annotations

from tyrefem.cards import read_toml


def test_a_file_is_read_again_when_it_has_changed(tmp_path):
    file = tmp_path / "card.toml"
    file.write_text("[k]\nvalue = 1\n", encoding="utf-8")
    assert read_toml(file) == {"k": {"value": 1}}
    file.write_text("[k]\nvalue = 22\n", encoding="utf-8")
    assert read_toml(file) == {"k": {"value": 22}}


def test_what_a_reader_does_to_the_data_stays_with_the_reader(tmp_path):
    file = tmp_path / "card.toml"
    file.write_text("[k]\nvalue = 1\n", encoding="utf-8")
    read_toml(file)["k"]["value"] = 5
    assert read_toml(file) == {"k": {"value": 1}}
