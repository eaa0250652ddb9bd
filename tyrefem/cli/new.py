"""`tyrefem new`: copy a shipped card into this folder."""

from __future__ import annotations

import filecmp
import os
import re
from collections.abc import Container, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from tyrefem.cli.common import ForceOption, SetOption, as_argument, settings
from tyrefem.cli.new_plugin import PLUGINS, new_plugin
from tyrefem.cli.shell import answer_with, say
from tyrefem.cli.show import complete_names
from tyrefem.errors import InputError, nearest
from tyrefem.interruption import interruption_delayed
from tyrefem.output.device_names import is_device

#: Number of a size -> its option.
OPTIONS = {"rim_width": "--rim", "load": "--load", "pressure": "--pressure"}
DEFAULTS = {"study": "nasa-22x5.5-8pr", "section": "nasa-22x5.5-8pr", "material": "nasa-tread"}


def new(
    kind: Annotated[
        str,
        typer.Argument(
            help="study, section, material or tyre; or a plugin: effect, boundary-law, tan-delta-law, strain-law, "
            "friction-law, sweep-answer."
        ),
    ],
    name: Annotated[
        str, typer.Argument(help="Name of the new card: letters, digits, . _ -; or a tyre's size; or of the plugin.")
    ] = "",
    copy_of: Annotated[
        str | None,
        typer.Option(
            "--from",
            help="Card to copy; default: nasa-22x5.5-8pr, of a material nasa-tread. Of a tyre: the study to scale.",
            autocompletion=complete_names,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", help="The file to write, .toml, of a plugin .py; of a tyre the folder of both files."),
    ] = None,
    rim: Annotated[str | None, typer.Option("--rim", help="Of a size: the rim's width, e.g. '6 in'.")] = None,
    load: Annotated[str | None, typer.Option("--load", help="Of a size: a load that it must carry.")] = None,
    pressure: Annotated[
        str | None, typer.Option("--pressure", help="Of a size: the pressure it carries it at.")
    ] = None,
    changes: SetOption = None,
    force: ForceOption = False,
) -> None:
    """Begin a card of your own in this folder: a copy, or made from a tyre's size; or a plugin from a template.

    A section or study may be made from a tyre's size: `tyrefem new section 205/60R15 --rim "6 in"`. `new tyre` scales
    a study with its section to another size: `tyrefem new tyre 225/45R17 --from passenger-205-55r16`.
    A plugin is a short Python file to begin from, in the folder plugins: `tyrefem new effect lamp`.
    """
    if kind in PLUGINS:
        if copy_of or rim or load or pressure or changes:
            raise InputError("--from, --rim, --load, --pressure and --set are for cards, not for plugins", field="kind")
        new_plugin(kind, name, out, force=force)
        return
    from tyrefem import library
    from tyrefem.output import atomic_path, place_of_output
    from tyrefem.output.file import results_file
    from tyrefem.schemas.line import schema_line, without_line
    from tyrefem.sizes import looks_like_size

    if kind not in (*DEFAULTS, "tyre"):
        raise InputError(f"no kind '{kind}'{nearest(kind, [*DEFAULTS, 'tyre', *PLUGINS])}")
    if not name:
        raise InputError("is missing: the new card's name; an empty one is not allowed as a card's name", field="name")
    if copy_of is not None and not copy_of.strip():
        raise InputError("is empty; name a card, or leave the option out", field="--from")
    options = {"rim_width": rim, "load": load, "pressure": pressure}
    given = {key: value for key, value in options.items() if value is not None}
    of_size = _numbers(given, settings(changes))
    with _naming_options(given):
        if kind == "tyre":
            from tyrefem.cli.new_tyre import new_tyre

            new_tyre(name, copy_of, of_size, out, force=force)
            return
        if kind != "material" and copy_of is None and looks_like_size(name):
            from tyrefem.cli.new_size import new_size

            new_size(kind, name, of_size, out, force=force)
            return
    if of_size:
        raise InputError("--rim, --load, --pressure and --set go with a tyre's size such as 205/60R15", field="name")
    _check_name(kind, name, copy_of)
    source = library.find(kind, copy_of or DEFAULTS[kind])
    folder = Path(library.FOLDERS[kind])
    target = folder / name / "study.toml" if kind == "study" else folder / f"{name}.toml"
    if out is None and (os.path.lexists(target) or (kind == "study" and os.path.lexists(target.parent))):
        raise InputError("the file exists already; nothing was written; to replace it: --out FILE --force", file=target)
    if out is not None and out.is_file() and not force:
        raise InputError("exists and may have been edited; replace it with --force", file=out, field="--out")
    target = out or target
    place_of_output(target.parent)
    files = {target: source, **_copies(source, target, _companions(kind, source), force=force)}
    first_line, note = _of_the_other_tyre(kind, source)
    note = "; ".join(filter(None, (note, _meant_size(kind, name, copy_of))))
    with results_file(target, (".toml",), force=force), interruption_delayed():
        for place, file in files.items():
            with atomic_path(place) as temporary:
                if place == target:
                    text = without_line(file.read_text(encoding="utf-8-sig"))
                    temporary.write_text(schema_line(kind, target) + first_line + text, encoding="utf-8")
                else:
                    temporary.write_bytes(file.read_bytes())
    answer_with({"kind": kind, "file": target, "copy_of": source, "note": note})
    say(f"{target} written, a copy of {source.parent.name if kind == 'study' else source.stem}")
    if note:
        say(f"note: {note}")
    say(f"edit it, then: tyrefem check {as_argument(target)}")


def _numbers(given: Mapping[str, str], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The numbers of a size by their names in its rules, of options and of ``--set``.

    Raises
    ------
    InputError : a number is given twice.

    >>> _numbers({"rim_width": "6 in"}, {"section.parameters.plies": 2})
    {'rim_width': '6 in', 'plies': 2}
    """
    numbers: dict[str, Any] = dict(given)
    for key, value in changes.items():
        name = key.removeprefix("section.").removeprefix("parameters.")
        if name in numbers:
            beside = f" beside {OPTIONS[name]}" if name in given else ""
            raise InputError(f"'{name}' is given twice{beside}", field="--set")
        numbers[name] = value
    return numbers


@contextmanager
def _naming_options(given: Container[str]) -> Iterator[None]:
    """Name the option, not the number, in an error of what an option has given."""
    try:
        yield
    except InputError as error:
        if error.file is None and error.field in OPTIONS and error.field in given:
            raise InputError(error.message, field=OPTIONS[error.field]) from None
        raise


def _check_name(kind: str, name: str, copy_of: str | None) -> None:
    """Raise `InputError` for a name that no card can have."""
    from tyrefem.sizes import looks_like_size

    if not re.fullmatch(r"\w[\w.-]*", name) or name.lower().endswith(".toml"):
        if copy_of is not None and kind != "material" and looks_like_size(name):
            message = f"a size is drawn, not copied; scaled from a study: tyrefem new tyre '{name}' --from STUDY"
            raise InputError(message, field="--from")
        raise InputError(
            f"'{name}' is not allowed as a card's name; allowed: letters, digits, . _ -, without '.toml' at the end"
        )
    if is_device(name) or name.endswith("."):
        raise InputError(f"'{name}' can be no file on Windows; give the card another name", field="name")


def _copies(source: Path, target: Path, names: Iterable[Path], *, force: bool) -> dict[Path, Path]:
    """The files beside a study that are copied with it: copy -> file.

    Raises
    ------
    InputError : another file stands in the place of a copy.
    """
    copies = {target.parent / name: source.parent / name for name in names}
    copies = {place: file for place, file in copies.items() if place.resolve() != file.resolve()}
    for place, file in copies.items():
        if os.path.lexists(place) and not force and not (place.is_file() and filecmp.cmp(place, file, shallow=False)):
            message = f"would be overwritten by that of {source.parent.name}; choose another folder, or replace it with"
            raise InputError(f"{message} --force", file=place, field="--out")
    return copies


def _meant_size(kind: str, name: str, copy_of: str | None) -> str:
    """A note on a card whose name reads like a road tyre's size, though it is a copy of another tyre's.

    >>> _meant_size("study", "205-55-16", None)
    "'205-55-16' is a name here; a study of that size: tyrefem new study 205/55R16"
    """
    match = re.fullmatch(r"(\d{3})[-_.]?(\d{2})[-_.]?[rR]?[-_.]?(\d{2})", name)
    if match is None or kind == "material" or copy_of is not None:
        return ""
    size = f"{match[1]}/{match[2]}R{match[3]}"
    return f"'{name}' is a name here; a {kind} of that size: tyrefem new {kind} {size}"


def _of_the_other_tyre(kind: str, source: Path) -> tuple[str, str]:
    """Notes on numbers that hold for one tyre only: a line for the copied file, and a line for the screen."""
    if kind == "study":
        from tyrefem.api import study

        try:
            copied = study(source)
        except InputError:
            return "", ""  # the copy keeps the errors, to be corrected there
        section, names = copied.card.made_for or copied.new_section.name, ", ".join(copied.card.of_one_tyre)
        if not names:
            return "", ""
        line = (
            f'made_for = "{section}"     # the section for which these were made: {names}\n'
            if not copied.card.made_for
            else ""
        )
        return line, f"for section '{section}' only (made_for): {names}; with another section the study warns"
    if kind == "section":
        from tyrefem.cards import read_toml

        data: dict[str, Any] = read_toml(source)
        kept = [name for name in ("rating", "parameters.inner_volume") if _has(data, name)]
        if kept:
            words = f"for {source.stem} only: {' and '.join(kept)}"
            return f"# A copy of {source.stem}; {words}.\n", words
    return "", ""


def _has(data: dict[str, Any], name: str) -> bool:
    for part in name.split("."):
        if not isinstance(data, dict) or part not in data:
            return False
        data = data[part]
    return True


def _companions(kind: str, source: Path) -> list[Path]:
    """Files in a study's folder that the study names: tables and mesh. Cards in other folders are not copied."""
    from tyrefem.cards import read_toml

    if kind != "study":
        return []
    data: dict[str, Any] = read_toml(source)
    measured = data.get("measured")
    named = [data.get("cases"), *(entry.get("table") for entry in measured or [] if isinstance(entry, dict))]
    if isinstance(data.get("mesh"), dict):
        named.append(data["mesh"].get("file"))
    names = [Path(name) for name in dict.fromkeys(named) if isinstance(name, str)]
    inside = [name for name in names if not name.is_absolute() and ".." not in name.parts]
    return [name for name in inside if (source.parent / name).is_file()]


#: Place among the commands.
ORDER = 60


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(new)
