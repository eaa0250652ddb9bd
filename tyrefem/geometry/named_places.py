"""Places that a section has by name, wherever its size and shape put them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

import numpy as np

from tyrefem.errors import InputError

if TYPE_CHECKING:
    from tyrefem.geometry.section import Section

PlaceName = Literal["crown-inner", "under-tread", "belt-edge", "shoulder-middle", "sidewall-middle", "bead-middle"]
#: Distance of `crown-inner` from the inner surface, m (estimate: a thermocouple just below the surface).
NEAR_SURFACE = 1e-3
#: Stations from the shoulder to the bead among which the widest place is found.
STATIONS = 201


def named_place(section: Section, name: PlaceName) -> tuple[float, float]:
    """(s, depth) of a place, m: along the meridian from the crown on the side z >= 0, and from the inner surface.

    Raises
    ------
    InputError : a section without it.

    >>> from tyrefem.geometry import load
    >>> [round(1e3 * part, 1) for part in named_place(load("passenger-205-55r16"), "belt-edge")]
    [72.9, 3.4]
    """
    return PLACES[name](section)


def named_places(section: Section) -> tuple[PlaceName, ...]:
    """Names of the places that a section has.

    >>> from tyrefem.geometry import load
    >>> "belt-edge" in named_places(load("nasa-22x5.5-8pr"))
    False
    """
    has = {"belt-edge": bool(_belts(section)), "bead-middle": "bead" in section.regions}
    return tuple(name for name in PLACES if has.get(name, True))


def _belts(section: Section) -> list[tuple[float, int]]:
    """Ends of the belts and numbers of their layers, the shortest first."""
    return sorted((piece.end, piece.layer) for piece in section.pieces if "belt" in piece.region and piece.start == 0)


def _crown(section: Section) -> float:
    """The middle of the crown, or of the rib beside the groove that is there."""
    for number, (start, end) in enumerate(section.grooves):
        if start <= 1e-9:
            following = section.grooves[number + 1 :]
            return (end + (following[0][0] if following else section.line.shoulder_s)) / 2
    return 0.0


def _crown_inner(section: Section) -> tuple[float, float]:
    s = _crown(section)
    return s, min(NEAR_SURFACE, float(section.rubber_thickness([s])[0]) / 2)


def _under_tread(section: Section) -> tuple[float, float]:
    s = _crown(section)
    faces = section.interfaces(np.array(s))
    return s, float(faces[-2] - faces[0])


def _belt_edge(section: Section) -> tuple[float, float]:
    belts = _belts(section)
    if not belts:
        raise InputError(
            f"section '{section.name}' has no place 'belt-edge': no region at its crown is a belt", field="place"
        )
    s, layer = belts[-2] if len(belts) > 1 else belts[0]
    faces = section.interfaces(np.array(s))
    return s, float(faces[layer] - faces[0])


def _shoulder(section: Section) -> tuple[float, float]:
    s = section.line.shoulder_s
    return s, float(section.rubber_thickness([s])[0]) / 2


def _sidewall(section: Section) -> tuple[float, float]:
    stations = np.linspace(section.line.shoulder_s, section.line.length, STATIONS)
    s = float(stations[np.argmax(section.line.position(stations)[:, 1])])
    return s, float(section.total_thickness([s])[0]) / 2


def _bead(section: Section) -> tuple[float, float]:
    section.require_region("bead")
    piece = next(piece for piece in section.pieces if piece.region == "bead")
    s = (piece.start + piece.end) / 2
    faces = section.interfaces(np.array(s))
    return s, float(faces[piece.layer] + faces[piece.layer + 1]) / 2 - float(faces[0])


#: What each place is, by its name.
PLACES: Mapping[PlaceName, Callable[[Section], tuple[float, float]]] = MappingProxyType({
    "crown-inner": _crown_inner,
    "under-tread": _under_tread,
    "belt-edge": _belt_edge,
    "shoulder-middle": _shoulder,
    "sidewall-middle": _sidewall,
    "bead-middle": _bead,
})  # fmt: skip
