"""`tyrefem list`: names of cards, effects, laws and sweep answers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import typer

from tyrefem.cli.shell import answer_with, say
from tyrefem.errors import InputError, nearest

KINDS = {"sections": "section", "materials": "material", "studies": "study", "sweeps": "sweep"}
#: Kinds that may be extended by plugins.
EXTENDED = ("effects", "boundary-laws", "tan-delta-laws", "strain-laws", "friction-laws", "sweep-answers")
#: Every kind; "laws" are the boundary laws, by their older name.
EVERY = (*KINDS, *EXTENDED, "laws", "plugins")
Rows = list[dict[str, str]]


def complete_kinds(incomplete: str) -> list[str]:
    """Kinds, for shell completion."""
    return [kind for kind in EVERY if kind.startswith(incomplete)]


def show_list(
    kind: Annotated[
        str,
        typer.Argument(
            help=f"{', '.join([*KINDS, *EXTENDED])}, or plugins: all of your own.", autocompletion=complete_kinds
        ),
    ] = "studies",
) -> None:
    """List sections, materials, studies or sweeps by name; effects, laws and sweep answers, also your own."""
    rows = _LISTS[kind]() if kind in _LISTS else _cards(kind)
    answer_with({"kind": kind, "entries": rows})


def _cards(kind: str) -> Rows:
    if kind not in KINDS:
        raise InputError(f"no kind '{kind}'{nearest(kind, EVERY)}")
    from tyrefem import library
    from tyrefem.cards import read_toml

    rows, names = [], sorted(library.names(KINDS[kind]).items())
    width = max([28, *(len(name) for name, _ in names)])
    for name, path in names:
        try:
            title = str(read_toml(path).get("title", ""))
        except InputError as error:
            title = f"(cannot be read: {error.message})"
        say(f"{name:{width}} {title}")
        rows.append({"name": name, "title": title, "file": str(path)})
    return rows


#: Shipped laws of a card's table, which are a class together.
_SHIPPED = {
    "tan-delta-laws": {
        "exponential": "value exp(-rate (T - at))",
        "constant": "the same at every temperature",
        "table": "rows of temperature and tan delta",
        "frequency": "a table or Prony series over frequency, shifted by temperature",
    },
    "friction-laws": {
        "constant": "the same at every sliding speed",
        "savkoor": "a peak over the sliding speed, shifted by temperature (Savkoor 1965)",
    },
}


def _first_line(cls: type) -> str:
    return next(iter((cls.__doc__ or "").strip().splitlines()), "").replace("``", "")


def _row(line: str, cls: type, **row: str) -> dict[str, str]:
    """Print a line, with the origin of a plugin in brackets; its row."""
    from tyrefem.plugins import registry

    plugin = registry().of_class(cls)
    if plugin is None:
        say(line)
        return row
    say(f"{line}  [{plugin.origin.words}]")
    return {**row, "plugin": plugin.origin.words}


def _laws() -> Rows:
    from tyrefem.boundaries import SIDES, laws

    return [
        _row(f"{side:14} {name:10} {_first_line(law)}", law, name=name, title=_first_line(law), side=side)
        for side in SIDES
        for name, law in sorted(laws(side).items())
    ]


def _effects() -> Rows:
    from tyrefem.effects import catalogue
    from tyrefem.effects.description import by_family

    return [
        _row(f"{each.name:28} {family:12} {each.sentence}", each, name=each.name, title=each.sentence, family=family)
        for family, members in by_family(catalogue()).items()
        for each in members
    ]


def _of_cards(key: str) -> Rows:
    """Laws of a table of the material cards: the shipped names, then the plugins."""
    from tyrefem.materials.road_friction import FRICTION
    from tyrefem.materials.tan_delta_card import TAN_DELTA
    from tyrefem.plugins import registry

    kind = {"tan-delta-laws": TAN_DELTA, "friction-laws": FRICTION}[key]
    titles = [(name, cls, _SHIPPED[key][name]) for name, cls in kind.shipped().items()]
    titles += [(name, cls, _first_line(cls)) for name, cls in sorted(registry().classes(kind).items())]
    return [_row(f"{name:20} {title}", cls, name=name, title=title) for name, cls, title in titles]


def _strain_laws() -> Rows:
    from tyrefem.mechanics.strain_laws import strain_laws

    classes = {name: type(law) for name, law in strain_laws().items()}
    return _by_docstring(classes)


def _sweep_answers() -> Rows:
    from tyrefem.sweep.question import sweep_questions

    return _by_docstring(dict(sweep_questions()))


def _by_docstring(classes: dict[str, type]) -> Rows:
    titles = {name: _first_line(cls) for name, cls in classes.items()}
    return [_row(f"{name:20} {titles[name]}", cls, name=name, title=titles[name]) for name, cls in classes.items()]


def _plugins() -> Rows:
    """Every plugin with where it comes from; those that fail are warned of."""
    from tyrefem.plugins import registry

    return [
        _row(f"{each.kind.name:14} {each.name:28} {each.cls.__name__}", each.cls, name=each.name, title=each.kind.name)
        for each in sorted(registry().plugins, key=lambda each: (each.kind.name, each.name))
    ]


_LISTS: dict[str, Callable[[], Rows]] = {
    "effects": _effects,
    "laws": _laws,
    "boundary-laws": _laws,
    "tan-delta-laws": lambda: _of_cards("tan-delta-laws"),
    "strain-laws": _strain_laws,
    "friction-laws": lambda: _of_cards("friction-laws"),
    "sweep-answers": _sweep_answers,
    "plugins": _plugins,
}
#: Place among the commands.
ORDER = 30


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command(name="list")(show_list)
