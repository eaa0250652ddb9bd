"""A section from a tyre's size."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from tyrefem.errors import InputError

if TYPE_CHECKING:
    from tyrefem.geometry import Section


def section_from_size(size: str, numbers: Mapping[str, Any] | None = None) -> Section:
    """A section from a tyre's size: ``"205/60R15"``, ``"295/80R22.5"``, ``"22x5.5 8PR"``, ``"46x17R20"``.

    Parameters
    ----------
    size : as it stands on the tyre's wall.
    numbers : name -> quantity, in place of the rules' own: ``{"rim_width": "6 in", "crown_radius": "700 mm"}``.
        `tyrefem new section SIZE` writes all of them, with their sources.

    Raises
    ------
    InputError : no such size or number; a rim out of range; a pressure that cannot carry the load.

    >>> section = section_from_size("205/60R15")
    >>> round(section.outer_diameter, 4), round(section.overall_width, 3)
    (0.627, 0.209)
    """
    from tyrefem.geometry import load

    if not isinstance(numbers, Mapping | None):
        raise InputError(f"must be a mapping like {{'rim_width': '6 in'}}, not {numbers!r:.60}", field="numbers")
    return load({"size": size, "parameters": dict(numbers or {})})
