"""The parts of the public interface as plain data, for `record_interface.py`: signatures, flags, keys of cards.

Everything is looked up by class name, field or flag, never by module path.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import types
import typing
from collections.abc import Iterator
from typing import Any

import pydantic

#: What people call themselves, among the classes that tyrefem offers; all others are made by verbs.
CALLED = ("Conduction", "Material", "Film", "Flux", "Radiation", "Fixed", "Reservoir")
Part = dict[str, Any]


def import_everything(package: types.ModuleType) -> None:
    """Import every module of a package, so that every subclass is known."""
    for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)


# -- names and signatures --------------------------------------------------------------------------------------------


def parameters(function: Any) -> list[Part]:
    """Name, kind and default of every parameter but ``self``; annotations are left out."""
    rows = []
    for parameter in inspect.signature(function).parameters.values():
        if parameter.name == "self":
            continue
        required = parameter.default is inspect.Parameter.empty
        rows.append({"name": parameter.name, "kind": parameter.kind.name, "required": required})
        if not required:
            rows[-1]["default"] = shown(parameter.default)
    return rows


def shown(value: Any) -> str:
    """A default as text; numbers and names in full."""
    if isinstance(value, str) and " " in value:
        return "a sentence"
    if value is None or isinstance(value, str | int | float | tuple):
        return repr(value)
    return f"{len(value)} entries" if isinstance(value, list | dict) else "an object"


def member(owner: type, name: str) -> Part:
    """A public name of a class: a method with its parameters, a property, or a value."""
    value = inspect.getattr_static(owner, name, None)
    function = value.__func__ if isinstance(value, classmethod | staticmethod) else value
    if inspect.isfunction(function):
        return {"kind": "method", "parameters": [row for row in parameters(function) if row["name"] != "cls"]}
    return {"kind": "value"}


def members(thing: Any) -> dict[str, Part]:
    """Every public name of a class, or of an object of it (the fields, too)."""
    owner = thing if isinstance(thing, type) else type(thing)
    names = set(dir(thing)) | set(getattr(owner, "__dataclass_fields__", ()))
    inherited = set(dir(pydantic.BaseModel)) if issubclass(owner, pydantic.BaseModel) else set()
    return {name: member(owner, name) for name in sorted(names - inherited) if not name.startswith("_")}


def public_name(value: Any) -> Part:
    """A name of the package: a function with its parameters, or a class with its members."""
    if inspect.isfunction(value):
        return {"kind": "function", "parameters": parameters(value)}
    if isinstance(value, type):
        built = {"parameters": parameters(value)} if value.__name__ in CALLED else {}
        return {"kind": "class", "members": members(value)} | built
    return {"kind": "value"}


# -- the command line ------------------------------------------------------------------------------------------------


def commands(group: Any, path: str = "") -> Iterator[tuple[str, Part]]:
    """Every command below a group of typer's: its arguments by number, its options by flag."""
    for name, command in getattr(group, "commands", {}).items():
        full = f"{path} {name}".strip()
        yield from commands(command, full)
        if not hasattr(command, "commands"):
            arguments = [row for row in command.params if row.param_type_name == "argument"]
            options = [row for row in command.params if row not in arguments]
            flags = {" ".join(sorted([*row.opts, *row.secondary_opts])): _option(row) for row in options}
            yield full, {f"argument {n}": _option(row) for n, row in enumerate(arguments, 1)} | flags


def _option(parameter: Any) -> Part:
    """What typer knows of a parameter, whether it brings its own click or uses the library."""
    descriptor = getattr(parameter, "type_descriptor", None)
    takes = _takes(descriptor.annotation) if descriptor is not None else parameter.type.name
    if descriptor is not None and isinstance(descriptor.annotation, type):
        takes = descriptor.annotation.__name__
    return {
        "takes": takes,
        "required": parameter.required,
        "repeatable": bool(getattr(parameter, "multiple", False)) or parameter.nargs != 1,
        "default": shown(parameter.default),
        "min": shown(getattr(parameter, "min", None)),
        "max": shown(getattr(parameter, "max", None)),
    }


# -- cards -----------------------------------------------------------------------------------------------------------


def subclasses(base: type) -> list[type]:
    """All classes below one, by name."""
    below = [deeper for cls in base.__subclasses__() for deeper in (cls, *subclasses(cls))]
    return sorted(set(below), key=lambda cls: cls.__name__)


def card_trees(card: type[pydantic.BaseModel], effect: type) -> dict[str, dict[str, str]]:
    """Kind of file (or class name, of a card that no other has in it) -> dotted key -> what the key takes."""
    cards = [cls for cls in subclasses(card) if cls is not effect and not issubclass(cls, effect)]
    inside = {inner for cls in cards for inner in _inner(cls)}
    roots = [cls for cls in cards if cls not in inside and not cls.__subclasses__()]
    trees: dict[str, dict[str, str]] = {}
    for cls in roots:
        name = getattr(cls, "kind", "card")
        trees.setdefault(cls.__name__ if name == "card" or name in trees else name, {}).update(keys(cls, effect))
    return trees


def _inner(cls: type[pydantic.BaseModel]) -> Iterator[type]:
    for field in cls.model_fields.values():
        for inner in _cards(field.annotation, field.metadata):
            yield inner
            yield from _bases(inner)


def _bases(cls: type) -> Iterator[type]:
    yield from (base for base in cls.__mro__ if issubclass(base, pydantic.BaseModel))


def _cards(annotation: Any, metadata: typing.Iterable[Any] = ()) -> Iterator[type[pydantic.BaseModel]]:
    """Card classes that an annotation allows: of a base class, its subclasses (of one side, where that is said)."""
    if typing.get_origin(annotation) is typing.Annotated:
        yield from _cards(annotation.__origin__, annotation.__metadata__)
    elif isinstance(annotation, type) and issubclass(annotation, pydantic.BaseModel):
        sides = {item.side for item in metadata if hasattr(item, "side")}
        below = [cls for cls in subclasses(annotation) if not sides or getattr(cls, "side", None) in sides]
        lawful = [cls for cls in below if "law" in cls.model_fields]
        yield from lawful or below or [annotation]
    else:
        for inner in typing.get_args(annotation):
            yield from _cards(inner, metadata)


def keys(cls: type[pydantic.BaseModel], effect: type, path: str = "", above: tuple[type, ...] = ()) -> dict[str, str]:
    """Dotted key -> what it takes, through all cards below; ``*``: any name, ``[]``: entries of a list."""
    result: dict[str, str] = {}
    for name, field in cls.model_fields.items():
        key = f"{path}{field.alias or name}"
        inner = [card for card in _cards(field.annotation, field.metadata) if not issubclass(card, effect)]
        takes = "table" if inner else _takes(field.annotation, field.metadata)
        result[key] = f"{takes}, {_default(field)}"
        for card in inner:
            if card not in above:
                below = f"{key}{_nesting(field.annotation)}{_law(card)}."
                result |= keys(card, effect, below, (*above, cls))
    return result


def _default(field: Any) -> str:
    return "required" if field.is_required() else f"default {shown(field.get_default(call_default_factory=True))}"


def _law(card: type[pydantic.BaseModel]) -> str:
    field = card.model_fields.get("law")
    values = typing.get_args(field.annotation) if field is not None else ()
    return f"({'|'.join(sorted(map(str, values)))})" if values else ""


def _nesting(annotation: Any) -> str:
    origin = typing.get_origin(annotation)
    if origin is typing.Annotated:
        return _nesting(annotation.__origin__)
    if origin in (list, tuple):
        return "[]"
    if origin is not None and isinstance(origin, type) and issubclass(origin, typing.Mapping):
        return ".*"
    inner = {_nesting(argument) for argument in typing.get_args(annotation)} - {""}
    return "".join(sorted(inner))


def _takes(annotation: Any, metadata: typing.Iterable[Any] = ()) -> str:
    """A type in words that do not name modules: unit and bounds, allowed values, plain types."""
    origin, arguments = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is typing.Annotated:
        return _takes(arguments[0], annotation.__metadata__)
    units = [item for item in metadata if hasattr(item, "unit")]
    if units and not isinstance(units[0].unit, str):  # what may also change over a phase
        return f"ramp of {_takes(float, [units[0].unit])}"
    bounds = {
        name: getattr(item, name)
        for item in metadata
        for name in ("gt", "ge", "lt", "le", "min_length", "low", "high")
        if getattr(item, name, None) is not None
    }
    extra = "".join(f" {name}={value!r}" for name, value in sorted(bounds.items()))
    if units:
        return f"quantity in {units[0].unit}{extra}"
    if origin is typing.Literal:
        return " | ".join(sorted(map(repr, arguments)))
    inner = [_takes(argument) for argument in arguments if argument is not Ellipsis]
    if inner and isinstance(origin, type) and origin is not types.UnionType:
        return f"{origin.__name__}[{', '.join(inner)}]{extra}"
    if inner:
        return f"{' or '.join(sorted(inner))}{extra}"
    plain = {str: "str", int: "int", float: "float", bool: "bool", type(None): "nothing"}
    return f"{plain.get(annotation, 'value') if isinstance(annotation, type) else 'value'}{extra}"


def effects(effect: Any) -> dict[str, Part]:
    """Every shipped effect by name: family, parameters with unit, null, bounds and prior, other keys."""
    result = {}
    for cls in subclasses(effect):
        if not cls.name or not cls.__module__.startswith("tyrefem."):
            continue
        fields = ("unit", "scale", "low", "high", "null", "start", "amplitude", "written")
        priors = {row.name: {name: shown(getattr(row.prior, name)) for name in fields} for row in cls.parameters()}
        others = {
            field.alias or name: _takes(field.annotation, field.metadata)
            for name, field in cls.model_fields.items()
            if name not in priors
        }
        result[cls.name] = {"family": cls.family, "parameters": priors, "keys": others}
    return result
