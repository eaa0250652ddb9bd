"""A section whose tread is worn by a distance: a card that runs."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem import library
from tyrefem.errors import InputError
from tyrefem.quantity import parse
from tyrefem.sizes.drawn import millimetres
from tyrefem.wear.ring_wear import RingWear

if TYPE_CHECKING:
    from tyrefem.geometry import Section
    from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]
#: Least tread that is left, m.
LEFT = 0.5e-3
#: Half the width over which the wear is averaged, m.
WINDOW = 5e-3
#: Stations of the worn thickness along the tread: an even step of its length.
STATIONS = 60
#: Digits of the card's lengths in mm.
DIGITS = 7


@dataclass(frozen=True, eq=False)
class WornProfile:
    """Depth worn over the meridian: ``s`` (n,) from the crown, both sides averaged, ``depth`` (n,) per km, m."""

    s: Array
    depth: Array

    @classmethod
    def of(cls, section: Section, wear: RingWear) -> WornProfile:
        """Means over the area within `WINDOW` of each ring: single points at a sharp edge depend on the mesh.

        Both sides count alike: as many left as right turns. A factor near 1 keeps the worn volume.
        """
        s = np.abs(section.locate(wear.places.T)[0])
        stations: Array = np.unique(np.round(s, 7)).astype(float)
        near = np.abs(stations[:, None] - s) <= WINDOW
        mean = (near * wear.areas) @ wear.depth_per_km / (near @ wear.areas)
        whole = float(np.interp(s, stations, mean) @ wear.areas)
        return cls(stations, mean * (float(wear.depth_per_km @ wear.areas) / whole if whole > 0 else 1.0))

    def __call__(self, s: Array) -> Array:
        """Depth per km at stations, m; 0 beyond the last ring."""
        return np.interp(np.abs(s), self.s, self.depth, right=0.0)


def worn_section(study: StudyData, wear: RingWear, kilometres: float) -> dict[str, Any]:
    """Contents of a section file: the study's section, its tread thinner by the wear of a distance.

    Grooves keep their bottom. What lies under the tread keeps its place.

    Raises
    ------
    InputError : a distance that is not positive; a meridian that would move; a tread that is worn through: the message
        says after how many km.
    """
    if not kilometres > 0:
        raise InputError(f"must be more than 0 km, not {kilometres:g} km", field="distance")
    section = study.section
    if section.reference in ("total", "outer", section.layers[-1].name):
        message = (
            f"the meridian is placed by '{section.reference}', so that all layers would move as the tread wears: place"
            " it by a layer under the tread"
        )
        raise InputError(message, field="section.line.reference", file=study.file)
    profile, outer = WornProfile.of(section, wear), section.layers[-1]
    ends = profile.s[-1]
    s = np.union1d(np.asarray(outer.thickness.s), np.linspace(0.0, ends, STATIONS))
    # Stations less than 10 micrometres apart are one.
    s = np.unique(np.round(np.append(s, min(ends * (1 + 1e-3), section.line.length)), 5))
    # The table still reaches the end of the meridian.
    s[-1] = outer.thickness.s[-1]
    thickness, depth = outer.thickness(s), profile(s) * kilometres
    # Beyond the tread the layer may be thinner than what a tread must keep.
    reach = np.where(depth > 0, thickness - LEFT - depth, np.inf)
    if (reach < 0).any():
        most = float(np.min(((thickness - LEFT) / np.maximum(profile(s), 1e-30))[depth > 0]))
        at = s[int(np.argmin(reach))] * 1e3
        message = f"the tread is worn through {at:.0f} mm from the crown: {most:,.0f} km leave {LEFT * 1e3:g} mm"
        raise InputError(message, field="distance")
    data, _, _ = library.load("section", study.data["section"], study.folder)
    if "layers" not in data:
        message = "the section is drawn from a size: write it with 'tyrefem new section' first"
        raise InputError(message, field="section", file=study.file)
    data = copy.deepcopy(data)
    layer = data["layers"][-1]
    layer |= {"s": millimetres(s, DIGITS), "thickness": millimetres(thickness - depth, DIGITS)}
    layer["source"] = f"{layer.get('source', '')}; tread worn by {kilometres:,.0f} km (tyrefem wear)"
    _without_scales(data, section)
    if "outer_diameter" in data.get("parameters", {}):
        crown = float(profile(np.zeros(1))[0]) * kilometres
        data["parameters"]["outer_diameter"] = f"{(section.outer_diameter - 2 * crown) * 1e3:.6g} mm"
    data["title"] = f"{data.get('title', section.name)}, worn by {kilometres:,.0f} km"
    return data


def _without_scales(data: dict[str, Any], section: Section) -> None:
    """Take the factors of the outermost layer's regions out of a card: its new table has them.

    Where such a region lies in other layers too, all layers get tables with their factors.
    """
    scales = data.get("parameters", {}).get("thickness_scale", {})
    taken = {name: scales.pop(name) for name in section.layers[-1].regions.names if name in scales}
    scaled = {name for name, factor in taken.items() if parse(factor, "1") != 1}
    inner = section.layers[:-1]
    if any(scaled & set(layer.regions.names) for layer in inner):
        for card, layer in zip(data["layers"], inner, strict=False):
            profile = layer.thickness
            card |= {"s": millimetres(profile.s, DIGITS), "thickness": millimetres(profile.values, DIGITS)}
        scales.clear()
