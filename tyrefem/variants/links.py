"""Linked numbers of a sweep: a name that stands for several numbers of the study, which vary together.

``[link]`` of a sweep file gives them: ``gauges = ["section.thickness_scale.*"]``. An entry may be NAME, -NAME or
0.5*NAME: its share of the value. A factor multiplies the value that each number has.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tyrefem.errors import InputError, nearest
from tyrefem.inputs.changes import canonical
from tyrefem.inputs.name_patterns import matching
from tyrefem.variants.answers import answer_names

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData

_SHARE = re.compile(r"^\s*(?:(-)|([-+]?(?:\d+\.?\d*|\.\d+))\s*\*)?\s*([^\s*-].*?)\s*$")
Links = Mapping[str, Sequence[str]]
#: Columns of a sweep's table and of a list of variants, beside numbers and answers that are numbers.
COLUMNS = ("variant", "name", "note", "hottest_region", "life_region", "by", "error_K", "feasible", "failure")


@dataclass(frozen=True)
class Members:
    """The numbers that a name of a sweep sets: dotted names, and of each its share of the value."""

    name: str
    keys: tuple[str, ...]
    shares: tuple[float, ...]

    @property
    def linked(self) -> bool:
        """Does the name differ from the name of the number that it sets?"""
        return self.keys != (self.name,)

    @property
    def pairs(self) -> tuple[tuple[str, float], ...]:
        """(dotted name, share), the first with the share 1: its value is the value of the link.

        Raises
        ------
        InputError : no share is 1.
        """
        pairs = list(zip(self.keys, self.shares, strict=True))
        whole = next((pair for pair in pairs if math.isclose(pair[1], 1.0)), None)
        if whole is None:
            raise InputError("one of the numbers must take the value itself, without a sign or factor", field="link")
        return (whole, *(pair for pair in pairs if pair is not whole))


def share_of(entry: str) -> tuple[str, float]:
    """The dotted name of an entry of a link, and its share of the value.

    >>> share_of("-materials.belt-2.cords.angle"), share_of("0.5 * drive.load"), share_of("drive.load")
    (('materials.belt-2.cords.angle', -1.0), ('drive.load', 0.5), ('drive.load', 1.0))
    """
    match = _SHARE.match(entry)
    share = 1.0 if match is None or (not match[1] and not match[2]) else -1.0 if match[1] else float(match[2])
    if match is None or share == 0:
        raise InputError(f"'{entry}' is not a dotted name, -NAME or 0.5*NAME", field="link")
    return match[3], share


def members(study: StudyData, name: str, links: Links) -> Members:
    """The numbers that a name of a sweep sets: those of a link, those that match ``*``, or the number itself.

    Raises
    ------
    InputError : the study has no such number; names the nearest link or number.
    """
    if name not in links:
        _check_known(study, name, links)
        keys = _keys(study, name)
        return Members(name, tuple(keys), (1.0,) * len(keys))
    shares: dict[str, float] = {}
    for entry in links[name]:
        pattern, share = share_of(entry)
        try:
            _check_known(study, pattern, ())
            keys = _keys(study, pattern)
        except InputError as error:
            raise InputError(error.message, field=f"link.{name}: {error.field or pattern}") from None
        twice = next((key for key in keys if key in shares), None)
        if twice is not None:
            raise InputError(f"sets '{twice}' twice", field=f"link.{name}")
        shares |= dict.fromkeys(keys, share)
    return Members(name, tuple(shares), tuple(shares.values()))


def _keys(study: StudyData, name: str) -> list[str]:
    """The numbers of a dotted name; a plain name stays as written."""
    if "*" in name:
        return [_plain(study, key) for key in matching(study.data, name, study.folder)]
    return [_plain(study, name)]


def _plain(study: StudyData, key: str) -> str:
    """A dotted name, of the cords' angle where it is written as an angle of a layer."""
    full = canonical(study.data, key)
    return key if full.split(".")[0] == key.split(".")[0].replace("-", "_") else full


def _check_known(study: StudyData, name: str, links: Iterable[str]) -> None:
    tables = type(study.card).model_fields
    table = name.split(".")[0].strip().replace("-", "_")
    if table not in tables:
        known = [*links, *tables] if "." not in name else list(tables)
        what = "no link and no table" if "." not in name else "no table"
        raise InputError(f"the study has {what} '{table}'{nearest(table, known)}", field=name)


def check_links(study: StudyData, links: Links, used: Iterable[str]) -> None:
    """Raise `InputError` for a link that nothing uses, or that has the name of a table of the study or of a column."""
    used = set(used)
    columns = {*COLUMNS, *answer_names(study, 0.0)}
    for name in links:
        if name in columns:
            raise InputError(f"'{name}' is a column of the sweep's table: give the link another name", field="link")
        if name in type(study.card).model_fields:
            raise InputError(f"'{name}' is a table of the study: give the link another name", field="link")
        if name not in used:
            raise InputError(
                "nothing varies it: name it in [vary], in [tornado] tolerances or in the table of cases",
                field=f"link.{name}",
            )
        if not members(study, name, links).keys:
            raise InputError("names no number of the study", field=f"link.{name}")


def check_apart(groups: Sequence[tuple[str, Sequence[str]]], study: StudyData) -> None:
    """Raise `InputError` if two names set the same number: (name, its dotted names)."""
    owner: dict[str, str] = {}
    for name, keys in groups:
        for key in keys:
            full = canonical(study.data, key)
            if full in owner:
                raise InputError(f"'{owner[full]}' and '{name}' both set '{key}'", field="vary")
            owner[full] = name
