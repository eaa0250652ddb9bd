"""Identified layers as material cards that a study accepts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from tyrefem import library
from tyrefem.cards import merged
from tyrefem.errors import InputError, nearest
from tyrefem.heating_test.verdict import REMARK, sentences
from tyrefem.materials.card import MaterialCard, material

if TYPE_CHECKING:
    from tyrefem.heating_test.card import RigCard
    from tyrefem.heating_test.identification import IdentificationData

#: The largest relative standard deviation that a card may state.
_MOST = 0.99


def bases(card: RigCard, given: Sequence[str]) -> dict[str, str]:
    """Layer -> base card, from ``LAYER=CARD`` or one ``CARD`` for every layer.

    Raises InputError if the rig does not have the layer, a card is unknown, or a layer or all layers have two cards.
    """
    names = [layer.name for layer in card.layers]
    chosen: dict[str, str] = {}
    before: set[str] = set()
    for text in given:
        layer, equals, name = text.partition("=")
        if equals and layer not in names:
            raise InputError(f"unknown layer '{layer}'{nearest(layer, names)}", field="--base")
        place = f"layer '{layer}'" if equals else "all layers"
        if place in before:
            raise InputError(f"a second card for {place}: {name if equals else text}; give one", field="--base")
        before.add(place)
        try:
            material(name if equals else text)
        except InputError as error:
            raise error.within(field="--base") from None
        chosen = {**chosen, layer: name} if equals else {**dict.fromkeys(names, text), **chosen}
    return chosen


def layer_card(identification: IdentificationData, layer: str, base: str) -> dict[str, Any]:
    """Data of a layer's card: identified properties, with the rest from a base card.

    The rig cannot measure loss tangent, stiffness and cords: these are from the base card, with its sources. A linear
    property becomes a table between ambient and the highest temperature of a reading.

    Raises InputError if the base card is unknown.
    """
    data, _, name = library.load("material", base)
    rig_layer = next(candidate for candidate in identification.card.layers if candidate.name == layer)
    tests = ", ".join(f"{test.name} ({test.run.power:g} W)" for test in identification.tests)
    source = f"identified with the laser rig '{identification.card.title}' from tests {tests}"
    changes = {
        "title": f"{layer}, identified with the laser rig",
        "notes": (
            f"Conductivity and specific heat: laser rig, at {rig_layer.reference_temperature:g} degC where constant. "
            f"The rig cannot measure loss tangent, stiffness and cords: these are from the card '{name}'. "
            + " ".join(words for words in sentences(identification) if layer in words)
        ).strip(),
        "conductivity": _property(identification, layer, "conductivity", "W/m/K", source),
        "density": {"value": f"{rig_layer.density.value:.6g} kg/m**3", "source": rig_layer.density.source},
        "specific_heat": _property(identification, layer, "specific_heat", "J/kg/K", source),
    }
    for key in ("density", "conductivity", "specific_heat"):
        data.get(key, {}).pop("relative_sd", None)
    card = merged(data, changes)
    MaterialCard.check(card)
    return card


def _property(identification: IdentificationData, layer: str, key: str, unit: str, source: str) -> dict[str, Any]:
    estimate = identification.by_name[f"{layer}.{key}"]
    sd = min(estimate.relative_sd or 0.0, _MOST)
    words = f"{source}; 95 % interval {estimate.low:.4g} to {estimate.high:.4g} {unit}"
    if estimate.verdict == "not determined":
        words += f"; {estimate.verdict} by the readings: mostly the prior value ({_guess(identification, layer, key)})"
    elif estimate.verdict != "determined":
        words += f"; {REMARK[estimate.verdict]}"
    entry: dict[str, Any] = {"source": words, "relative_sd": f"{100 * sd:.2g} %"}
    rig_layer = next(estimate for estimate in identification.card.layers if estimate.name == layer)
    slope = identification.fit.values[f"{layer}.{key}_slope"]
    if slope == 0.0:
        return {**entry, "value": f"{estimate.value:.5g} {unit}"}
    given = [test.run.ambient for test in identification.tests]
    low = min(identification.card.surroundings.ambient if each is None else each for each in given)
    high = max(max(float(block.computed.max()) for block in identification.fit.blocks), low + 20.0)
    rows = []
    for T in (low, high):
        factor = min(max(1.0 + slope * (T - rig_layer.reference_temperature), 0.2), 5.0)
        rows.append([f"{T:.5g} degC", f"{estimate.value * factor:.5g} {unit}"])
    return {**entry, "table": rows}


def _guess(identification: IdentificationData, layer: str, key: str) -> str:
    rig_layer = next(candidate for candidate in identification.card.layers if candidate.name == layer)
    return str(getattr(rig_layer, key).source)


def layer_cards(identification: IdentificationData, chosen: Mapping[str, str]) -> dict[str, dict[str, Any]]:
    """Layer -> card data, for every layer with a base card."""
    return {layer: layer_card(identification, layer, base) for layer, base in chosen.items()}
