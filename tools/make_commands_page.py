"""Write the tables of docs/commands.md: every command with its options' purpose, and the keys of its answer."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer.main

from tyrefem.cli import app
from tyrefem.schemas.answer_schema import parts_of, unit_of
from tyrefem.schemas.answers import ANSWERS

PAGE = Path(__file__).resolve().parents[1] / "docs" / "commands.md"
BEGIN, END = "<!-- written by tools/make_commands_page.py -->", "<!-- end -->"


def commands(words: tuple[str, ...] = (), command: Any = None) -> Iterator[tuple[str, str]]:
    """Name and first line of help of every command."""
    command = command or typer.main.get_command(app)
    if hasattr(command, "commands"):
        for name, below in sorted(command.commands.items()):
            yield from commands((*words, name), below)
    else:
        yield " ".join(words), (command.help or "").strip().split("\n\n")[0].replace("\n", " ")


def tables() -> str:
    """The generated part of the page."""
    lines = ["| command | what it does |", "|---|---|"]
    lines += [f"| [`{name}`](#{name.replace(' ', '-')}) | {help_text} |" for name, help_text in commands()]
    for name, _ in commands():
        lines += ["", f"### {name}", ""]
        for answer, keys in ANSWERS.items():
            if answer.partition(" (")[0].partition(" --")[0] != name:
                continue
            if answer != name:
                lines += ["", f"`{answer}`:", ""]
            lines += ["| key | kind | meaning |", "|---|---|---|"]
            lines += [_row(key, line) for key, line in keys.items() if key != "*"]
    return "\n".join(lines)


def _row(key: str, line: str) -> str:
    kind, nullable, words = parts_of(line)
    name = key.removesuffix("*")
    unit = f", {unit_of(name)}" if unit_of(name) and kind in ("number", "list") else ""
    may = " or null" if nullable else ""
    missing = " (may be missing)" if key.endswith("*") else ""
    return f"| `{name}` | {kind}{unit}{may}{missing} | {words} |"


def page(text: str) -> str:
    """The page with its generated part anew."""
    before, _, rest = text.partition(BEGIN)
    return f"{before}{BEGIN}\n\n{tables()}\n\n{END}{rest.partition(END)[2]}"


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    print(f"{PAGE} written")
