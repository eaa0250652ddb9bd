"""Loads, pressures and speeds at which a tyre may be driven: what an envelope looks at."""

from __future__ import annotations

from typing import Any

from tyrefem.dotted import scaled, value_at
from tyrefem.errors import InputError
from tyrefem.quantity import parse
from tyrefem.studies import Study
from tyrefem.sweep.answers import check_answer
from tyrefem.sweep.card import EnvelopeCard
from tyrefem.sweep.plan import sensible

#: Loads where none are given: shares of the study's own.
SHARES = (0.5, 0.75, 1.0, 1.25)


def checked_pairs(study: Study, card: EnvelopeCard) -> list[tuple[str, str]]:
    """Loads and pressures of an envelope, as written; every one of them is something that the study takes.

    Raises
    ------
    InputError : as of `envelope`.
    """
    try:
        check_answer(card.answer, study)
    except InputError as error:
        raise error.within(field="envelope.answer") from None
    speed_range(card)
    loads = card.loads or tuple(_shares(study))
    pressures = card.pressures or (str(_given(study, "pressure")),)
    for field, unit, values in (("loads", "N", loads), ("pressures", "Pa", pressures)):
        if len({_parsed(value, unit, field) for value in values}) < len(values):
            raise InputError("one of them is given twice", field=f"envelope.{field}")
    pairs = [(load, pressure) for load in loads for pressure in pressures]
    sensible(study, [("", operating(pair, card.fastest)) for pair in pairs])
    return pairs


def speed_range(card: EnvelopeCard) -> tuple[float, float]:
    """Slowest and fastest speed searched, m/s."""
    low, high = (_parsed(text, "m/s", name) for name, text in (("slowest", card.slowest), ("fastest", card.fastest)))
    if not 0 < low < high:
        raise InputError(f"'{card.slowest}' to '{card.fastest}' is no range of speeds", field="envelope.slowest")
    return low, high


def _given(study: Study, name: str) -> Any:
    try:
        return value_at(study.data, f"drive.{name}", study.folder)
    except InputError as error:
        raise InputError(f"the study gives no one {name}: name them", field=f"envelope.{name}s") from error


def _shares(study: Study) -> list[str]:
    load = _given(study, "load")
    try:
        return [scaled(load, share, significant=4) for share in SHARES]
    except InputError as error:
        raise InputError(f"the study gives no one load: {error.message}; name them", field="envelope.loads") from None


def _parsed(text: str, unit: str, field: str) -> float:
    try:
        return parse(text, unit)
    except InputError as error:
        raise error.within(field=f"envelope.{field}") from None


def operating(pair: tuple[str, str], speed: str) -> dict[str, str]:
    """What a study changes to be driven at a load, a pressure and a speed."""
    return {"drive.load": pair[0], "drive.pressure": pair[1], "drive.speed": speed}
