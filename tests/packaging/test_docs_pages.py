"""Every page of docs/ begins with purpose, command and picture; its links, commands and tables hold."""

from __future__ import annotations

import csv
import re
import shlex
from itertools import groupby
from pathlib import Path

import pytest
import typer

import tyrefem as tf
from tyrefem.cli import app

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / "docs").rglob("*.md"))
#: Pages of the site that the README leads to, read where they are.
HOWTO = sorted(page for page in (ROOT / "site" / "howto").glob("*.md") if page.stem != "index")
TEXTS = [*PAGES, ROOT / "README.md", *HOWTO]
LINKED = [*TEXTS, ROOT / "CHANGELOG.md", ROOT / "CONTRIBUTING.md", *sorted(ROOT.glob("studies/*/README.md"))]
SHELL = re.compile(r"^```(?:sh|bash|console)\n(.*?)^```", re.DOTALL | re.MULTILINE)
BEGINNING = re.compile(r"# .+\n\n([A-Z`](?:[^\n]+\n)+)\n```sh\n(?:(?!```).*\n)+```\n\n(!\[.+)")
PICTURE = re.compile(r"!\[([^\]]+)\]\(([^)\s]+)\)")
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
#: typer brings a click of its own, or not.
USAGE_ERROR: type[Exception] = typer.BadParameter.__mro__[1]
BETWEEN = {"&&", "||", ";", "|"}


def relative(page: Path) -> str:
    return page.relative_to(ROOT / "docs").as_posix()


def prose(page: Path) -> str:
    """The page without its code blocks."""
    return re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)


def anchors(page: Path) -> set[str]:
    """The names that GitHub gives to the headings of a page."""
    headings = re.findall(r"^#+ (.+)$", prose(page), re.MULTILINE)
    words = (re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).strip().lower() for heading in headings)
    return {re.sub(r"[^\w\- ]", "", heading).replace(" ", "-") for heading in words}


def shell_commands(page: Path) -> list[list[str]]:
    """The words of every command in the shell blocks of a page."""
    commands = []
    for block in SHELL.findall(page.read_text(encoding="utf-8")):
        for line in block.replace("\\\n", " ").splitlines():
            lexer = shlex.shlex(line, posix=True, punctuation_chars=";|&")
            lexer.whitespace_split = True
            words = list(lexer)
            commands += [list(part) for between, part in groupby(words, BETWEEN.__contains__) if not between]
    return commands


def tyrefem_arguments(words: list[str]) -> list[str] | None:
    """What follows `tyrefem`, however it is started; None for another program."""
    if words[0] == "tyrefem" or words[0].endswith("/tyrefem"):
        return words[1:]
    if words[1:3] == ["-m", "tyrefem"]:
        return words[3:]
    return None


def parse(arguments: list[str]) -> None:
    """Read the arguments as the command line does, without running anything."""
    command = typer.main.get_command(app)
    with command.make_context("tyrefem", ["--help"], resilient_parsing=True) as context:
        while hasattr(command, "resolve_command") and not (arguments and arguments[0] == "--help"):
            name, command, arguments = command.resolve_command(context, list(arguments))
            group = hasattr(command, "resolve_command")
            if command is None:
                raise typer.BadParameter("there is no such command")
            context = command.make_context(name, ["--help"] if group else arguments, context, resilient_parsing=group)


@pytest.mark.parametrize("page", PAGES, ids=relative)
def test_a_page_begins_with_purpose_command_and_picture(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    beginning = BEGINNING.match(text)
    assert beginning is not None, "title, purpose in one paragraph, a shell block, a picture"
    purpose, after = beginning.groups()
    assert len(purpose.split()) < 60, "the purpose takes two sentences"
    picture = PICTURE.match(after)
    assert picture is not None, "a picture follows the command"
    file = (page.parent / picture.group(2)).resolve()
    assert file.is_file(), f"{picture.group(2)} is missing"
    assert file.stat().st_size < 200_000, f"{picture.group(2)} is larger than 200 kB"
    assert shell_commands(page), "the shell block has a command"


@pytest.mark.parametrize("page", LINKED, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_relative_link_leads_somewhere(page: Path) -> None:
    broken = []
    for target in LINK.findall(prose(page)):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        if not file.exists() or (anchor and anchor not in anchors(file)):
            broken.append(target)
    assert broken == []


def linked_pages(page: Path) -> set[Path]:
    targets = (target.partition("#")[0] for target in LINK.findall(prose(page)))
    return {(page.parent / target).resolve() for target in targets if target.endswith(".md")}


def test_every_page_is_two_clicks_from_the_readme() -> None:
    first = linked_pages(ROOT / "README.md")
    assert {relative(page) for page in PAGES if page.parent.name == "docs" and page not in first} == set()
    reached = first.union(*(linked_pages(page) for page in first & set(PAGES)))
    assert {relative(page) for page in PAGES if page not in reached} == set()


@pytest.mark.parametrize("page", TEXTS, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_command_in_a_shell_block_exists(page: Path) -> None:
    for words in shell_commands(page):
        arguments = tyrefem_arguments(words)
        if arguments is not None:
            try:
                parse(arguments)
            except USAGE_ERROR as error:
                pytest.fail(f"{shlex.join(words)}: {error.format_message()}")
        for script in words[1:]:
            if re.fullmatch(r"(?:benchmarks|tools|studies)/\S+\.\w+", script):
                assert (ROOT / script).is_file(), shlex.join(words)


@pytest.mark.parametrize("line", ["fly nasa-22x5.5-8pr", "run nasa-22x5.5-8pr --wings", "rig fly", "sweep x --count 0"])
def test_a_command_that_does_not_exist_is_refused(line: str) -> None:
    with pytest.raises(USAGE_ERROR):
        parse(line.split())


@pytest.mark.parametrize("page", HOWTO, ids=lambda page: page.stem)
def test_a_change_within_a_sentence_is_a_key_of_a_study(page: Path) -> None:
    changes = re.findall(r"`--set ([^`]+)`", prose(page))
    studies = ("nasa-22x5.5-8pr", "nasa-taxi-takeoff")
    for change in (shlex.split(text)[0].split("=", 1) for text in changes):
        errors = [_error_of(name, dict([change])) for name in studies]
        assert "" in errors, errors


def _error_of(study: str, changes: dict[str, str]) -> str:
    try:
        tf.study(study, changes)
    except tf.InputError as error:
        return str(error)
    return ""


def test_every_picture_is_on_a_page() -> None:
    shown = {(page.parent / name).resolve() for page in TEXTS for _, name in PICTURE.findall(prose(page))}
    assert {file.relative_to(ROOT) for file in (ROOT / "docs").rglob("*.png") if file not in shown} == set()


TABLES = sorted((ROOT / "docs").rglob("*.csv"))


def rows(table: Path) -> list[list[str]]:
    with table.open(encoding="utf-8", newline="") as lines:
        return list(csv.reader(lines))


@pytest.mark.parametrize("table", TABLES, ids=relative)
def test_a_table_has_a_heading_and_full_rows(table: Path) -> None:
    heading, *body = rows(table)
    assert body, "rows follow the heading"
    assert all(heading), "every column has a name"
    assert len(set(heading)) == len(heading), "every column has its own name"
    assert {len(row) for row in body} == {len(heading)}


def test_every_table_is_linked_from_a_page() -> None:
    linked = {(page.parent / target).resolve() for page in TEXTS for target in LINK.findall(prose(page))}
    assert {relative(table) for table in TABLES if table not in linked} == set()
