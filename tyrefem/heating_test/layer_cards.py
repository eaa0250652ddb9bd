"""Identified layers as material cards that a study accepts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from tyrefem import library
from tyrefem.cards import merged
from tyrefem.errors import InputError, nearest
from tyrefem.heating_test.verdict import sentences
from tyrefem.materials.card import MaterialCard, material

if TYPE_CHECKING:
    from tyrefem.heating_test.card import RigCard
    from tyrefem.heating_test.identification import IdentificationData

#: The largest relative standard deviation that a card may state.
_MOST = 0.99


def bases(card: RigCard, given: Sequence[str]) -> dict[str, str]:
    """Layer -> base card, from ``LAYER=CARD`` or one ``CARD`` for every layer.

    Raises InputError for a layer that the rig does not have, or an unknown card.
    """
    names = [layer.name for layer in card.layers]
    chosen: dict[str, str] = {}
    for text in given:
        layer, equals, name = text.partition("=")
        if equals and layer not in names:
            raise InputError(f"unknown layer '{layer}'{nearest(layer, names)}", field="--base")
        try:
            material(name if equals else text)
        except InputError as error:
            raise error.within(field="--base") from None
        chosen = {**chosen, layer: name} if equals else {**dict.fromkeys(names, text), **chosen}
    return chosen


def layer_card(found: IdentificationData, layer: str, base: str) -> dict[str, Any]:
    """The data of one layer's card: what the rig knows laid over a base card, which gives the rest.

    The rig cannot know the loss tangent, the stiffness or the cords: they stay the base card's, with its sources.
    A linear property becomes a table between the ambient and the highest temperature that a sensor saw.

    Raises InputError for an unknown base card.
    """
    data, _, name = library.load("material", base)
    own = next(one for one in found.card.layers if one.name == layer)
    tests = ", ".join(f"{test.name} ({test.run.power:g} W)" for test in found.tests)
    source = f"identified with the laser rig '{found.card.title}' from tests {tests}"
    changes = {
        "title": f"{layer}, identified with the laser rig",
        "notes": (
            f"Conductivity and specific heat: laser rig, at {own.reference_temperature:g} degC where constant. "
            f"The rig cannot know loss tangent, stiffness and cords: they are those of the card '{name}'. "
            + " ".join(words for words in sentences(found) if layer in words)
        ).strip(),
        "conductivity": _property(found, layer, "conductivity", "W/m/K", source),
        "density": {"value": f"{own.density.value:.6g} kg/m**3", "source": own.density.source},
        "specific_heat": _property(found, layer, "specific_heat", "J/kg/K", source),
    }
    for key in ("density", "conductivity", "specific_heat"):
        data.get(key, {}).pop("relative_sd", None)
    card = merged(data, changes)
    MaterialCard.check(card)
    return card


def _property(found: IdentificationData, layer: str, key: str, unit: str, source: str) -> dict[str, Any]:
    one = found.by_name[f"{layer}.{key}"]
    sd = min(one.relative_sd or 0.0, _MOST)
    words = f"{source}; 95 % interval {one.low:.4g} to {one.high:.4g} {unit}"
    if one.verdict != "determined":
        words += f"; {one.verdict} by the readings: mostly the first guess ({_guess(found, layer, key)})"
    entry: dict[str, Any] = {"source": words, "relative_sd": f"{100 * sd:.2g} %"}
    own = next(one for one in found.card.layers if one.name == layer)
    slope = found.fit.values[f"{layer}.{key}_slope"]
    if slope == 0.0:
        return {**entry, "value": f"{one.value:.5g} {unit}"}
    low = min(test.run.ambient or found.card.surroundings.ambient for test in found.tests)
    high = max(max(float(block.computed.max()) for block in found.fit.blocks), low + 20.0)
    rows = []
    for T in (low, high):
        factor = min(max(1.0 + slope * (T - own.reference_temperature), 0.2), 5.0)
        rows.append([f"{T:.5g} degC", f"{one.value * factor:.5g} {unit}"])
    return {**entry, "table": rows}


def _guess(found: IdentificationData, layer: str, key: str) -> str:
    own = next(one for one in found.card.layers if one.name == layer)
    return str(getattr(own, key).source)


def layer_cards(found: IdentificationData, chosen: Mapping[str, str]) -> dict[str, dict[str, Any]]:
    """Layer -> card data for every layer that has a base."""
    return {layer: layer_card(found, layer, base) for layer, base in chosen.items()}
