"""Commands that write one picture write it as PNG, PDF or SVG, by the name that they are given."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tyrefem.cli import main

#: Commands that write one picture, without ``--out``.
COMMANDS = (
    ["show", "section", "nasa-22x5.5-8pr"],
    ["show", "mesh", "nasa-22x5.5-8pr", "--set", "mesh.size=12 mm"],
    ["show", "strain", "nasa-22x5.5-8pr"],
    ["slide", "tables"],
    ["slide", "locked-wheel"],
)
BEGINS = {".pdf": b"%PDF", ".svg": b"<?xml", ".PNG": b"\x89PNG"}


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_the_ending_decides(command: list[str], here: Path) -> None:
    for suffix, begins in BEGINS.items():
        for _ in range(2):  # the second time over its own file
            assert main([*command, "--out", f"picture{suffix}"]) == 0
        assert (here / f"picture{suffix}").read_bytes().startswith(begins)


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_another_ending_is_one_error_that_names_these(command: list[str], refused: Callable[..., str]) -> None:
    error = refused(*command, "--out", "picture.jpg")
    assert ".png" in error
    assert ".pdf" in error
    assert ".svg" in error


def test_what_is_printed_takes_no_file(refused: Callable[..., str]) -> None:
    assert "is printed, not drawn" in refused("show", "material", "nasa-tread", "--out", "x.pdf")
