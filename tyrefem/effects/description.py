"""Text and tables that describe an effect, for the command line, the report and docs/effects.md."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Literal, get_args, get_origin

from tyrefem.effects.effect import FAMILIES, PORTS, Effect

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo


#: Heading of the columns of `parameter_rows`.
COLUMNS = ("parameter", "meaning", "not there at", "allowed", "prior sd")


def by_family(effects: dict[str, type[Effect]]) -> dict[str, list[type[Effect]]]:
    """Effects by family, with a fixed order of families."""
    families = {family: [effect for effect in effects.values() if effect.family == family] for family in FAMILIES}
    return {family: members for family, members in families.items() if members}


def equation(effect: type[Effect]) -> str:
    """The effect's equation: the class's docstring, in one line."""
    return " ".join(inspect.cleandoc(effect.__doc__ or "").split()).replace("``", "")


def ports(effect: type[Effect]) -> str:
    """Text on the ports where the effect acts."""
    return ", ".join(port.words for port in PORTS if effect.overrides(port.name))


def parameter_rows(effect: type[Effect]) -> list[list[str]]:
    """Name, meaning, null (or start of a shape), bounds and prior of every parameter; then the text fields."""
    rows = []
    for parameter in effect.parameters():
        prior = parameter.prior
        begin = prior.text(prior.null) if prior.amplitude else f"(shape; starts at {prior.text(prior.origin)})"
        bounds = f"{prior.text(prior.low)} to {prior.text(prior.high)}"
        rows.append([parameter.name, prior.meaning, begin, bounds, prior.text(prior.scale)])
    numbers = {parameter.name for parameter in effect.parameters()}
    for name, field in effect.model_fields.items():
        if name not in numbers | set(Effect.model_fields):
            default = "" if field.is_required() else f"default: {field.default}"
            rows.append([name, field.description or "choice", "", default, ""])
    return rows


def example(effect: type[Effect]) -> str:
    """An entry of a study file: each choice as its field's first example, each amplitude at its usual value."""
    lines = ["[[effects]]", f'name = "{effect.name}"']
    required = {name: field for name, field in effect.model_fields.items() if field.is_required()}
    lines += [f'{name} = "{_first_example(field)}"' for name, field in required.items()]
    for parameter in effect.parameters():
        if parameter.prior.amplitude:
            value = parameter.prior.text(parameter.prior.usual)
            lines.append(
                f"{parameter.name} = {value}" if parameter.prior.unit == "1" else f'{parameter.name} = "{value}"'
            )
    return "\n".join(lines)


def _first_example(field: FieldInfo) -> str:
    """Example of a choice from its field; else the first allowed value, or dots."""
    allowed = get_args(field.annotation) if get_origin(field.annotation) is Literal else ()
    return str(next(iter([*(field.examples or ()), *allowed, "..."])))
