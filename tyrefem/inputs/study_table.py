"""Tables and lists of a study as written, which nobody changes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NoReturn

from tyrefem.errors import InputError


def _refused(self: object, *entries: object, **more: object) -> NoReturn:
    """A study that was read has its numbers: a change of its text alone would act on nothing."""
    raise InputError("a study does not change; study.replace({'drive.speed': '25 mph'}) gives a changed one")


class StudyTable(dict[str, Any]):
    """A table that cannot be changed; ``dict(table)`` and ``copy.deepcopy(table)`` are tables that can.

    >>> table = fixed({"drive": {"speed": "20 mph"}})
    >>> table["drive"]["speed"] = "25 mph"
    Traceback (most recent call last):
    ...
    tyrefem.errors.InputError: a study does not change; study.replace({'drive.speed': '25 mph'}) gives a changed one
    """

    __setitem__ = __delitem__ = __ior__ = update = setdefault = pop = popitem = clear = _refused

    def __reduce__(self) -> tuple[Any, ...]:
        return StudyTable, (dict(self),)

    def __deepcopy__(self, known: dict[int, Any]) -> dict[str, Any]:
        return plain(self)


class StudyList(list[Any]):
    """A list that cannot be changed; ``list(entries)`` and ``copy.deepcopy(entries)`` are lists that can."""

    __setitem__ = __delitem__ = __iadd__ = __imul__ = _refused
    append = extend = insert = pop = remove = clear = sort = reverse = _refused

    def __reduce__(self) -> tuple[Any, ...]:
        return StudyList, (list(self),)

    def __deepcopy__(self, known: dict[int, Any]) -> list[Any]:
        return plain(self)


def fixed(value: Any) -> Any:
    """Tables and lists that cannot be changed; what is fixed already stays the same object."""
    if isinstance(value, StudyTable | StudyList):
        return value
    if isinstance(value, Mapping):
        return StudyTable({key: fixed(entry) for key, entry in value.items()})
    if isinstance(value, list | tuple):
        return StudyList(fixed(entry) for entry in value)
    return value


def plain(value: Any) -> Any:
    """The tables and lists of `fixed` as those that can be changed."""
    if isinstance(value, StudyTable):
        return {key: plain(entry) for key, entry in value.items()}
    return [plain(entry) for entry in value] if isinstance(value, StudyList) else value
