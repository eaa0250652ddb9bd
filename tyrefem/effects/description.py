"""What an effect is and does, in rows for people: the command line, the report and docs/effects.md use them."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING

from tyrefem.effects.effect import FAMILIES, PORTS, Effect

if TYPE_CHECKING:
    from tyrefem.effects.effect import Prior

#: Heading of the columns of `parameter_rows`.
COLUMNS = ("parameter", "meaning", "not there at", "allowed", "prior sd")


def by_family(effects: dict[str, type[Effect]]) -> dict[str, list[type[Effect]]]:
    """Effects by family, families in their usual order."""
    found = {family: [one for one in effects.values() if one.family == family] for family in FAMILIES}
    return {family: members for family, members in found.items() if members}


def equation(effect: type[Effect]) -> str:
    """What it changes, as the first line of the class says."""
    return " ".join(inspect.cleandoc(effect.__doc__ or "").split())


def ports(effect: type[Effect]) -> str:
    """Where it enters, in words."""
    return ", ".join(WORDS[port] for port in effect.ports())


def parameter_rows(effect: type[Effect]) -> list[list[str]]:
    """Name, meaning, null (or start of a shape), bounds and prior of every parameter; then the text fields."""
    rows = []
    for one in effect.parameters():
        prior = one.prior
        begin = prior.text(prior.null) if prior.amplitude else f"(shape; starts at {prior.text(_start(prior))})"
        bounds = f"{prior.text(prior.low)} to {prior.text(prior.high)}"
        rows.append([one.name, prior.meaning, begin, bounds, prior.text(prior.scale)])
    numbers = {one.name for one in effect.parameters()}
    for name, field in effect.model_fields.items():
        if name not in numbers | set(Effect.model_fields):
            rows.append(
                [name, TEXTS.get(name, "choice"), "", "" if field.is_required() else f"default: {field.default}", ""]
            )
    return rows


def _start(prior: Prior) -> float:
    return prior.null if prior.start is None else prior.start


def example(effect: type[Effect], sensors: tuple[str, ...] = ("crown-inner", "crown-middle")) -> str:
    """An entry of a study file with the amplitudes at the prior's scale."""
    texts = dict(zip(("sensor", "other"), sensors, strict=True))
    texts |= {"film": "outside_air", "station": "60 mm", "width": "10 mm"}
    lines = ["[[effects]]", f'name = "{effect.name}"']
    lines += [f'{name} = "{texts[name]}"' for name, field in effect.model_fields.items() if field.is_required()]
    for one in effect.parameters():
        if one.prior.amplitude:
            value = one.prior.text(one.prior.null + one.prior.scale)
            lines.append(f"{one.name} = {value}" if one.prior.unit == "1" else f'{one.name} = "{value}"')
    return "\n".join(lines)


#: Port -> what it is, in words.
WORDS = dict(
    zip(
        PORTS,
        (
            "factor on the heat source",
            "addend to the heat source",
            "factor on the conductivity",
            "factor on the heat capacity",
            "factor on films",
            "addend to films",
            "resistance in series with a film",
            "shift of a surrounding temperature",
            "flux through a surface",
            "radiation of a surface",
            "factor on the contained air's heat capacity",
            "power into a lumped rim",
            "the section",
            "place of a sensor",
            "lag of a sensor",
            "offset of a sensor",
            "the logger's clock",
            "the logger's channels",
        ),
        strict=True,
    )
)
TEXTS = {"sensor": "name of the sensor", "other": "name of the other sensor", "side": "loaded side, left or right"}
