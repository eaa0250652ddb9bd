"""The numbers of a law's card in words, each with its unit."""

from __future__ import annotations

import typing
from typing import TYPE_CHECKING, Any

from tyrefem.quantity import Unit
from tyrefem.reports.words import number

if TYPE_CHECKING:
    from tyrefem.cards import Card


def card_numbers(card: Card) -> list[str]:
    """Every field with its unit; default values are marked."""
    numbers = []
    for name, info in type(card).model_fields.items():
        value = getattr(card, name)
        if name == "law" or value is None:
            continue
        unit = _unit([*info.metadata, info.annotation])
        if isinstance(value, float):
            text = f"{number(value)} {unit.replace('**', '')}".strip()
        else:
            text = f"table of {len(value)} rows" if isinstance(value, list) else str(value)
        default = "" if name in card.model_fields_set else " (default)"
        numbers.append(f"{name.replace('_', ' ')} {text}{default}")
    return numbers


def _unit(parts: list[Any]) -> str:
    """The unit in a field's annotation, also a nested one; empty if there is none."""
    for part in parts:
        if isinstance(part, Unit):
            return "" if part.unit == "1" else part.unit.replace("delta_degC", "K").replace("degC", "°C")
        unit = _unit(list(typing.get_args(part)))
        if unit:
            return unit
    return ""
