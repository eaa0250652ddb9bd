"""The page of all commands, from what `tyrefem COMMAND --help` says."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer.main
from sphinx.application import Sphinx


def walk(words: tuple[str, ...], command: Any) -> Iterator[tuple[str, Any]]:
    """Every command with its words, groups opened, in the order of the help."""
    if hasattr(command, "commands"):
        for name, each in command.commands.items():
            yield from walk((*words, name), each)
    elif not command.hidden:
        yield " ".join(words), command


def plain(text: str | None) -> str:
    """A help text as Markdown: typer's escapes gone, what Markdown would read as markup escaped."""
    text = re.sub(r"\\([\[\]])", r"\1", " ".join((text or "").split()))
    return re.sub(r"([\\*_<>\[\]|$`])", r"\\\1", text)


def paragraphs(text: str | None) -> list[str]:
    """The paragraphs of a command's help."""
    return [plain(part) for part in re.split(r"\n\s*\n", text or "") if part.strip()]


def section(words: str, command: Any) -> str:
    """A heading, what the command does, its usage line and its options."""
    shown, rows = [], []
    for each in command.params:
        if each.param_type_name == "argument":
            label = (each.metavar or each.name.upper()).strip("[]")
            shown.append(label if each.required else f"[{label}]")
        elif not getattr(each, "hidden", False):
            names = ", ".join(f"`{name}`" for name in (*each.opts, *each.secondary_opts))
            rows.append(f"| {names} | {plain(each.help)} |")
    usage = " ".join(["tyrefem", words, *shown, *(["[OPTIONS]"] if rows else [])])
    lines = [f"## {words}", *paragraphs(command.help), f"```text\n{usage}\n```"]
    if rows:
        lines.append("\n".join(["| option | meaning |", "|---|---|", *rows]))
    return "\n\n".join(lines)


def page() -> str:
    """The page in Markdown."""
    from tyrefem.cli import app

    sections = [section(words, command) for words, command in walk((), typer.main.get_command(app))]
    start = "# Commands\n\nEvery command with its options, as `tyrefem COMMAND --help` prints them."
    return "\n\n".join([start, *sections]) + "\n"


def write(app: Sphinx) -> None:
    """Write the page where Sphinx reads it, if it changed."""
    place = Path(app.srcdir, "reference", "commands.md")
    text = page()
    if not place.is_file() or place.read_text(encoding="utf-8") != text:
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, Any]:
    """Write the page before Sphinx looks for pages."""
    app.connect("builder-inited", write)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
