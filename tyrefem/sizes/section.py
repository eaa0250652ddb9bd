"""A section from a size: what a study's ``section`` table or a command gives, made into a section's file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from tyrefem.cache import Cache
from tyrefem.errors import InputError, nearest
from tyrefem.sizes.designation import looks_like_size, parse_size
from tyrefem.sizes.drawn import Drawn
from tyrefem.sizes.kinds import draw
from tyrefem.sizes.rules import Rules

#: Keys of a ``section`` table beside ``size`` that are numbers of the rules.
NUMBERS = ("rim_width", "load", "pressure")
#: Names below ``parameters`` that a section's file has and no rule: they are laid over the file.
_OF_FILE = ("thickness_scale", "inner_volume")
#: Tables of a section's file that may be laid over.
_OVER = ("title", "layers", "grooves", "pattern", "wrap", "boundaries", "rating")
#: Regions whose gauge does not have their name, and regions whose gauge is that of one place only.
_GAUGES = {"bead": "bead_width", "sidewall": "", "chafer": "", "tread": ""}
_GAUGES |= dict.fromkeys(("body-ply", "body-plies", "turn-up", "bead-wrap", "carcass"), "ply_gauge")
_drawn: Cache[Drawn] = Cache(64)


def is_size(reference: object) -> bool:
    """Is a reference to a section a size, and not the name of a card?

    >>> is_size({"size": "205/60R15"}), is_size("22x5.5 8PR"), is_size("nasa-22x5.5-8pr"), is_size({"base": "mine"})
    (True, True, False, False)
    """
    if isinstance(reference, Mapping):
        return "size" in reference
    return looks_like_size(reference)


def draw_size(size: object, numbers: Mapping[str, Any] | None = None) -> Drawn:
    """A size drawn by its kind's rules. ``numbers``: name -> quantity as written, in place of the rules' own.

    Raises
    ------
    InputError : no such size, no such number, numbers that do not go together.

    >>> drawn = draw_size("205/60R15", {"rim_width": "6.5 in"})
    >>> drawn.rules["section_width"].text
    '213.64 mm'
    """
    given = dict(numbers or {})
    key = (str(size), json.dumps(given, sort_keys=True, default=str))
    return _drawn.get(key, lambda: draw(parse_size(size), Rules(given)))


def drawn_of(reference: Mapping[str, Any] | str) -> Drawn:
    """The drawing of a reference: a size as text, or a table ``{size, rim_width, load, pressure, parameters}``."""
    if isinstance(reference, str):
        return draw_size(reference)
    for key in reference:
        if key not in ("size", "parameters", *NUMBERS, *_OVER):
            raise InputError(
                f"unknown key '{key}'{nearest(str(key), ('size', 'parameters', *NUMBERS, *_OVER))}", field=str(key)
            )
    parameters = reference.get("parameters", {})
    if not isinstance(parameters, Mapping):
        raise InputError("must be a table of names and quantities", field="parameters")
    for key in NUMBERS:
        if key in reference and key in parameters:
            raise InputError(
                f"'{key}' of the same table is this number too: give one of them", field=f"parameters.{key}"
            )
    given = {key: value for key, value in parameters.items() if key not in _OF_FILE}
    given |= {key: reference[key] for key in NUMBERS if key in reference}
    try:
        return draw_size(reference["size"], given)
    except InputError as error:
        name = (error.field or "").removeprefix("parameters.")
        raise InputError(error.message, field=name if name in NUMBERS else error.field, file=error.file) from None


def section_of_size(reference: Mapping[str, Any] | str) -> tuple[dict[str, Any], Mapping[str, Any]]:
    """A section's file as plain data, and what the reference lays over it."""
    drawn = drawn_of(reference)
    over: dict[str, Any] = {}
    if isinstance(reference, Mapping):
        over = {key: reference[key] for key in _OVER if key in reference}
        kept = {key: value for key, value in reference.get("parameters", {}).items() if key in _OF_FILE}
        if kept:
            over["parameters"] = kept
    return dict(drawn.data), over


def gauge_of(reference: Mapping[str, Any] | str, region: str) -> str:
    """The number of a size's rules that is the thickness of a whole region; empty: none.

    >>> gauge_of("205/60R15", "turn-up"), gauge_of("205/60R15", "belt-1"), gauge_of("205/60R15", "shoulder-cushion")
    ('ply_gauge', 'belt_1_gauge', '')
    """
    name = _GAUGES.get(region, f"{region.replace('-', '_')}_gauge")
    return name if name in drawn_of(reference).rules.numbers else ""


def with_numbers(section: object, data: Mapping[str, Any]) -> dict[str, Any]:
    """The file of a size, ``data``, with its size and all numbers of its rules among the parameters (these go first:
    ``outer_diameter`` is that of the rules, of a bias tyre the inflated one).

    >>> with_numbers("205/60R15", {"parameters": {}})["parameters"]["rim_width"]
    '6 in'
    """
    assert isinstance(section, Mapping | str)
    drawn = drawn_of(section)
    numbers = {number.name: number.text for number in drawn.rules}
    beside = {"size": drawn.size.text, "rim_width": numbers["rim_width"]}
    return {**data, **beside, "parameters": {**data["parameters"], **numbers}}


def completed_materials(section: object, materials: Mapping[str, Any]) -> dict[str, Any]:
    """A study's ``[materials]``, with the cards of its section's size where it names none.

    A table without ``base`` is laid over the size's card. Studies whose section is no size keep theirs.

    >>> completed_materials("205/60R15", {"tread": "mine"})["tread"]
    'mine'
    >>> completed_materials("nasa-22x5.5-8pr", {"tread": "mine"})
    {'tread': 'mine'}
    """
    if not is_size(section):
        return dict(materials)
    assert isinstance(section, Mapping | str)
    complete = {}
    usual = drawn_of(section).materials
    for region, card in usual.items():
        given = materials.get(region)
        if given is None:
            complete[region] = card
        elif isinstance(given, Mapping) and "base" not in given:
            base = card if isinstance(card, Mapping) else {"base": card}
            complete[region] = _over(base, given)
        else:
            complete[region] = given
    return {**complete, **{region: card for region, card in materials.items() if region not in usual}}


def _over(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    result = dict(base)
    for key, value in changes.items():
        below = result.get(key)
        result[key] = _over(below, value) if isinstance(below, Mapping) and isinstance(value, Mapping) else value
    return result
