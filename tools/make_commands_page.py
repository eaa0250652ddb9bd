"""Write the tables of docs/commands.md: every command with its options, and the keys of its answer."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer.main

from tyrefem.cli import app
from tyrefem.output.key_units import unit_of
from tyrefem.schemas.answer_schema import parts_of
from tyrefem.schemas.answers import ANSWERS, Keys
from tyrefem.schemas.rows import rows_of

PAGE = Path(__file__).resolve().parents[1] / "docs" / "commands.md"
#: Options of every command: the table at the top of the page.
EVERYWHERE = ("as_json", "quiet")
BEGIN, END = "<!-- written by tools/make_commands_page.py -->", "<!-- end -->"


def commands(words: tuple[str, ...] = (), command: Any = None) -> Iterator[tuple[str, Any]]:
    """Name and definition of every command."""
    command = command or typer.main.get_command(app)
    if hasattr(command, "commands"):
        for name, below in sorted(command.commands.items()):
            yield from commands((*words, name), below)
    else:
        yield " ".join(words), command


def first_line(command: Any) -> str:
    """What a command does, in a line."""
    return (command.help or "").strip().split("\n\n")[0].replace("\n", " ")


def tables() -> str:
    """The generated part of the page."""
    lines = ["| command | what it does |", "|---|---|"]
    lines += [f"| [`{name}`](#{name.replace(' ', '-')}) | {first_line(command)} |" for name, command in commands()]
    for name, command in commands():
        lines += ["", f"### {name}", "", *options(name, command)]
        for answer, keys in ANSWERS.items():
            if answer.partition(" (")[0].partition(" --")[0] == name:
                lines += ["", f"Answer of `{answer}`:", "", "| key | kind | meaning |", "|---|---|---|"]
                lines += [_row(key, line) for key, line in keys.items() if key != "*"]
                lines += [text for place, row in rows_of(answer).items() if place != "plugins[]"
                          for text in ("", inside(place, row))]  # fmt: skip
    return "\n".join(lines)


def options(name: str, command: Any) -> list[str]:
    """The rest of a command's help, its usage line and its options."""
    shown, rows = [], []
    for each in command.params:
        if each.param_type_name == "argument":
            label = (each.metavar or each.name.upper()).strip("[]")
            shown.append(label if each.required else f"[{label}]")
        elif each.name not in (*EVERYWHERE, "help") and not each.hidden:
            names = ", ".join(f"`{flag}`" for flag in (*each.opts, *each.secondary_opts))
            rows.append(f"| {names} | {plain(each.help)}{without_it(each)} |")
    paragraphs = [plain(part) for part in re.split(r"\n\s*\n", command.help or "")[1:] if part.strip()]
    usage = " ".join(["tyrefem", name, *shown, *(["[OPTIONS]"] if rows else [])])
    lines = [f"{first_line(command)}", "", *(text for part in paragraphs for text in (part, "")), f"`{usage}`"]
    return lines + (["", "| option | meaning |", "|---|---|", *rows] if rows else [])


def without_it(option: Any) -> str:
    """What holds without an option, where its help does not say so."""
    if option.required:
        return " Required."
    default = option.default
    stated = isinstance(default, bool) or default in (None, (), []) or "default" in (option.help or "").lower()
    return "" if stated else f" Default: {plain(str(default))}."


def plain(text: str | None) -> str:
    """A help text as Markdown: typer's escapes gone, what Markdown would read as markup escaped."""
    text = re.sub(r"\\([\[\]])", r"\1", " ".join((text or "").split()))
    return re.sub(r"([\\*_<>\[\]|$`])", r"\\\1", text)


def inside(place: str, keys: Keys) -> str:
    """The keys of rows or tables inside an answer, in a line."""
    of = {"[]": "a row of", "{}": "each in"}.get(place[-2:], "in")
    words = []
    for key, line in keys.items():
        if key != "*":
            _, nullable, meaning = parts_of(line)
            unit = unit_of(key.removesuffix("*"))
            more = ", ".join([unit] * bool(unit) + ["or null"] * nullable + ["may be missing"] * key.endswith("*"))
            words.append(f"`{key.removesuffix('*')}` {meaning.removesuffix('.')}{f' ({more})' if more else ''}")
        else:
            words.append(parts_of(line)[2].removesuffix("."))
    return f"{of[0].upper()}{of[1:]} `{place.rstrip('[]{}')}`: {'; '.join(words)}."


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
