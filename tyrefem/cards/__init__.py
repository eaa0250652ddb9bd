"""The base of every file a person writes: validated, immutable, with errors that name file and field.

It holds files and units, and is independent of tyres.
"""

from __future__ import annotations

import copy
import functools
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, ClassVar, Self, Union, get_args, get_origin

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from tyrefem.brief import Brief, short
from tyrefem.cards.entries import entry_number
from tyrefem.cards.plausible import Plausible
from tyrefem.errors import InputError, InputWarning, nearest
from tyrefem.output import note_input
from tyrefem.quantity import Unit

Text = Annotated[str, Field(min_length=1)]
#: The largest tyre is 4 m in diameter; far beyond, coordinates have too few digits for elements.
PositiveLength = Annotated[float, Unit("m", gt=0, le=20)]
Temperature = Annotated[float, Unit("degC", le=2000)]
#: Temperature of a gas, whose mass or pressure goes with its inverse.
Warmth = Annotated[float, Unit("degC", gt=-273.15, le=2000)]
FilmCoefficient = Annotated[float, Unit("W/m**2/K", ge=0)]


class Card(Brief, BaseModel):
    """A table of a TOML file. Unknown keys are errors that name the nearest key."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)
    kind: ClassVar[str] = "card"

    def _title(self) -> str:
        return str(getattr(self, "name", None) or getattr(self, "title", None) or "")

    def _facts(self) -> Mapping[str, Any]:
        """The given values with their SI units, in the order of the fields; the source is last."""
        names = sorted(type(self).model_fields, key=lambda name: name in ("source", "notes"))
        values = {name: getattr(self, name) for name in names if name not in ("name", "title")}
        units = _units(type(self))
        return {
            name: f"{short(value)} {units[name]}" if name in units and isinstance(value, float) else value
            for name, value in values.items()
            if value not in (None, "", (), [], {})
        }

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        if isinstance(data, cls):
            return data
        if not isinstance(data, Mapping):
            number = isinstance(data, str | int | float) and "value" in _allowed(cls)
            hint = "; its number has the key 'value'" if number else ""
            raise InputError(f"must be a table of keys, not {data!r:.60}{hint}")
        allowed = _allowed(cls)
        for key in data:
            if key not in allowed:
                raise InputError(f"unknown key '{key}'{nearest(str(key), allowed)}")
        for key in _plain_numbers(cls) & set(data):
            _refuse_truth(data[key], key)
        return data

    @classmethod
    def check(cls, data: Any, file: str | Path | None = None) -> Self:
        """Validate plain data; the first error is raised as `InputError`."""
        try:
            return cls.model_validate(data)
        except ValidationError as error:
            raise _one_error(error, data, file) from None

    def warnings(self) -> tuple[InputWarning, ...]:
        """Unlikely values in this table and in its subtables; field names as in the file.

        Every field annotated with `Plausible` is compared with its range. A subclass whose numbers are not only
        fields extends the list.
        """
        unlikely = [
            range_.warning(getattr(self, name), key)
            for name, key, range_ in _plausible(type(self))
            if getattr(self, name) is not None
        ]
        below = [
            warning.within(field=key)
            for name, field in type(self).model_fields.items()
            for key, card in _cards(field.alias or name, getattr(self, name))
            for warning in card.warnings()
        ]
        return (*filter(None, unlikely), *below)

    def checked(self, before: Mapping[str, Any], data: Mapping[str, Any], file: str | Path | None = None) -> Self:
        """`check` of data, where this card was made of ``before``: shared tables are not validated again."""
        kept: dict[str, Any] = dict(data)
        for key in type(self).model_fields:
            if key in before and key in data and before[key] is data[key]:
                value = getattr(self, key)
                cards = list(value.values()) if isinstance(value, dict) else [value]
                if cards and all(isinstance(item, Card) for item in cards):
                    kept[key] = value
        return type(self).check(kept, file)


@functools.cache
def _plausible(card: type[Card]) -> tuple[tuple[str, str, Plausible], ...]:
    """Name, key in the file and range of the fields that have one."""
    ranges = []
    for name, field in card.model_fields.items():
        # "Annotated[...] | None" keeps its annotations within the union.
        metadata = [*field.metadata, *(item for part in get_args(field.annotation) for item in get_args(part)[1:])]
        ranges += [(name, field.alias or name, item) for item in metadata if isinstance(item, Plausible)]
    return tuple(ranges)


def _cards(key: str, value: Any) -> Iterator[tuple[str, Card]]:
    """The tables in a field's value, with their dotted names."""
    if isinstance(value, Card):
        yield key, value
    elif isinstance(value, Mapping):
        for name, entry in value.items():
            yield from _cards(f"{key}.{name}", entry)
    elif isinstance(value, tuple | list):
        for number, entry in enumerate(value):
            yield from _cards(f"{key}.{number}", entry)


#: Annotations that read a field's value themselves.
_READERS = (Unit, BeforeValidator)


@functools.cache
def _plain_numbers(card: type[Card]) -> frozenset[str]:
    """Keys of fields with numbers that pydantic reads itself: it takes true and false as 1 and 0."""
    return frozenset(
        field.alias or name
        for name, field in card.model_fields.items()
        if not any(isinstance(mark, _READERS) for mark in field.metadata) and _is_number(field.annotation)
    )


def _is_number(annotation: Any) -> bool:
    """Whether a field takes whole numbers or numbers, alone or in a tuple, also as an option."""
    if annotation in (int, float):
        return True
    if get_origin(annotation) is Annotated:
        base, *marks = get_args(annotation)
        return _is_number(base) and not any(isinstance(mark, _READERS) for mark in marks)
    return get_origin(annotation) in (Union, UnionType, tuple) and any(map(_is_number, get_args(annotation)))


def _refuse_truth(value: Any, key: str) -> None:
    """Raise `InputError` for true or false in place of a number, also in a list."""
    if isinstance(value, bool):
        raise InputError(f"must be a number, not {value!r}", field=key)
    for number, entry in enumerate(value) if isinstance(value, list | tuple) else ():
        _refuse_truth(entry, f"{key}.{number}")


@functools.cache
def _allowed(card: type[Card]) -> frozenset[str]:
    return frozenset(field.alias or name for name, field in card.model_fields.items())


@functools.cache
def _units(card: type[Card]) -> dict[str, str]:
    """Field -> unit of its number; none for pure numbers."""
    units = {}
    for name, field in card.model_fields.items():
        marks = [*field.metadata, *(mark for kind in get_args(field.annotation) for mark in get_args(kind)[1:])]
        unit = next((mark.unit for mark in marks if isinstance(mark, Unit)), "1")
        if unit != "1":
            units[name] = "K" if unit == "delta_degC" else unit
    return units


def _one_error(error: ValidationError, data: Any, file: str | Path | None) -> InputError:
    first = error.errors(include_url=False)[0]
    cause = first.get("ctx", {}).get("error")
    field = ".".join(_keys(first["loc"], data, whole=isinstance(cause, InputError)))
    if isinstance(cause, InputError):
        return cause.within(field=field or None, file=file)
    message = str(cause) if cause is not None else first["msg"]
    if first["type"] == "missing":
        message = "missing; this field is required"
    elif first["type"] == "string_type":
        message = f"must be text, not {first['input']!r:.60}"
    elif first["type"] in ("dict_type", "model_attributes_type"):
        message = f"must be a table of keys, not {first['input']!r:.60}"
    elif first["type"] == "too_short":
        least = first["ctx"]["min_length"]
        message = f"must have at least {least} entr{'y' if least == 1 else 'ies'}, not {first['ctx']['actual_length']}"
    elif first["type"] == "too_long":
        message = f"must have at most {first['ctx']['max_length']} entries"
    elif first["type"] in ("bool_type", "bool_parsing"):
        message = f"must be true or false, not {first['input']!r:.60}"
    elif first["type"] in ("int_type", "int_parsing", "int_from_float"):
        message = f"must be a whole number, not {first['input']!r:.60}"
    elif first["type"] == "string_too_short":
        message = "must not be empty"
    elif first["type"] in ("tuple_type", "list_type"):
        message = f"must be a list in square brackets, not {first['input']!r:.60}"
    elif first["type"] == "union_tag_invalid":
        tags = [tag.strip().strip("'") for tag in first["ctx"]["expected_tags"].split(",")]
        message = f"unknown law '{first['ctx']['tag']}'{nearest(str(first['ctx']['tag']), tags)}"
        field = f"{field}.law"
    elif first["type"] == "union_tag_not_found":
        message = "missing key 'law'"
    elif first["type"] == "literal_error":
        allowed = re.findall(r"'([^']+)'", first["ctx"]["expected"])
        message = f"{first['input']!r:.60} is not allowed{nearest(str(first['input']), allowed)}"
    return InputError(message, field=field or None, file=file)


def _keys(place: Sequence[int | str], data: Any, *, whole: bool) -> list[str]:
    """The keys of pydantic's place as in the file: without the law's name, which it adds to that of a table of laws.

    ``whole``: a list at the place is no error by itself, so that the law "table" is not its key "table".
    """
    keys: list[str] = []
    for number, part in enumerate(place):
        law = data.get("law") if isinstance(data, Mapping) else None
        after = place[number + 1 : number + 2]
        if part == law and (part not in data or after == (part,) or (whole and not after)):
            continue
        keys.append(str(part))
        inside = isinstance(data, Mapping) and part in data
        entry = isinstance(data, list | tuple) and isinstance(part, int) and part < len(data)
        data = data[part] if inside or entry else None
    return keys


def read_toml(path: str | Path) -> dict[str, Any]:
    """A TOML file as plain data; `InputError` with the line if it is not valid TOML."""
    path = Path(path)
    note_input(path)
    try:
        stat = path.stat()
        return copy.deepcopy(_parsed(path.absolute(), stat.st_mtime_ns, stat.st_size, stat.st_ino))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"not valid TOML: {error}{_unquoted(path, str(error))}", file=path) from None
    except UnicodeDecodeError:
        raise InputError("not a text file in UTF-8", file=path) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", file=path) from None
    except (ValueError, RecursionError):
        raise InputError("not valid TOML: a number is too long, or lists are nested too deep", file=path) from None


def _unquoted(path: Path, message: str) -> str:
    """What to do about a key with letters that TOML takes in quotes only, or nothing if the line has none.

    ``message`` has the line as of `tomllib.TOMLDecodeError`: "... (at line 3, column 2)".
    """
    place = re.search(r"at line (\d+)", message)
    if place is None:
        return ""
    line = path.read_text(encoding="utf-8-sig").split("\n")[int(place[1]) - 1]
    key = re.match(r"\s*\[*\s*(?:[\w-]+\.)*?([\w-]*[^\W\x00-\x7f][\w-]*)", line)
    return "" if key is None else f"; write '{key[1]}' in double quotes, as it has other letters than A to Z"


@functools.lru_cache(maxsize=64)
def _parsed(path: Path, *_state: int) -> dict[str, Any]:
    """The content of a file with this state: modification time, size, inode number."""
    return tomllib.loads(path.read_text(encoding="utf-8-sig"))


#: Alternative keys of a property: a change with some of them removes the others.
FORMS = ({"value"}, {"along", "across"}, {"table"}, {"shear_modulus"}, {"c10", "c01", "c20", "c30"})


def merged(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """``base`` with ``changes``: tables are merged key by key, all other values replaced.

    >>> merged({"k": {"value": "1 W/m/K", "source": "a"}}, {"k": {"along": "2 W/m/K", "across": "1 W/m/K"}})
    {'k': {'source': 'a', 'along': '2 W/m/K', 'across': '1 W/m/K'}}
    >>> merged({"layers": [{"name": "liner"}, {"name": "ply"}]}, {"layers": {"1": {"name": "plies"}}})
    {'layers': [{'name': 'liner'}, {'name': 'plies'}]}
    >>> merged({"layers": [{"name": "liner"}, {"name": "ply"}]}, {"layers": {"ply": {"k": 1}}})
    {'layers': [{'name': 'liner'}, {'name': 'ply', 'k': 1}]}
    """
    given = [form for form in FORMS if form & set(changes)]
    dropped = set().union(*FORMS) - set().union(*given) if given else set()
    result = {key: value for key, value in base.items() if key not in dropped}
    for key, value in changes.items():
        below = result.get(key)
        if isinstance(below, Mapping) and isinstance(value, Mapping):
            value = merged(below, value)
        elif isinstance(below, list) and isinstance(value, Mapping):
            value = _entries(below, value, str(key))
        result[key] = value
    return result


def _entries(base: list[Any], changes: Mapping[str, Any], field: str) -> list[Any]:
    """A list with changes to entries given by name or number: ``layers.2.regions.0.to``, ``layers.tread.source``."""
    result = list(base)
    for name, value in changes.items():
        number = entry_number(base, name, field)
        below = result[number]
        both = isinstance(below, Mapping) and isinstance(value, Mapping)
        result[number] = merged(below, value) if both else value
    return result
