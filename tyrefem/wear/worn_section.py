"""A section whose tread is worn by a distance: a card that runs."""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem import library
from tyrefem.errors import InputError
from tyrefem.quantity import parse
from tyrefem.sizes.drawn import millimetres
from tyrefem.wear.ring_wear import RingWear
from tyrefem.wear.worn_shoulder import WornShoulder

if TYPE_CHECKING:
    from tyrefem.geometry import Section
    from tyrefem.geometry.layer import Layer
    from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]
#: Least tread that is left, m.
LEFT = 0.5e-3
#: Half the width over which the wear is averaged, m.
WINDOW = 5e-3
#: Stations of the worn thickness along the tread: an even step of its length.
STATIONS = 60
#: The same over the worn shoulder.
SHOULDER_STATIONS = 12
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
        """Depth per km at stations, m; beyond the last ring that of the last ring."""
        return np.interp(np.abs(s), self.s, self.depth)


@dataclass(frozen=True, eq=False)
class WornFace:
    """Depth worn over the meridian by a distance, with the shoulder beyond the last ring.

    The friction of the rings wears the shoulder too, so they wear as by a shorter distance: the volume is the rings'.

    Parameters
    ----------
    profile : of the rings. shoulder : beyond them. volume : of the rings per km, m3, with that of transverse grooves.
    """

    profile: WornProfile
    shoulder: WornShoulder
    volume: float

    @classmethod
    def of(cls, section: Section, wear: RingWear) -> WornFace:
        """Of rings on a section."""
        profile = WornProfile.of(section, wear)
        return cls(profile, WornShoulder.of(section, float(profile.s[-1])), wear.volume_per_km / wear.rubber)

    @property
    def end(self) -> float:
        """Station of the last ring, m."""
        return float(self.profile.s[-1])

    def kilometres(self, ring_km: float) -> float:
        """Distance, km, by which the rings wear as by ``ring_km`` without a shoulder."""
        if not self.volume:
            return ring_km
        return ring_km + self.shoulder.volume(ring_km * float(self.profile.depth[-1])) / self.volume

    def ring_kilometres(self, kilometres: float) -> float:
        """Inverse of `kilometres`."""
        from scipy.optimize import brentq

        return float(brentq(lambda km: self.kilometres(km) - kilometres, 0.0, kilometres, xtol=1e-9 * kilometres))

    def through(self, thickness: float) -> float:
        """Distance, km, by which a layer of a thickness, m, is worn through; beyond it shapes have no meaning."""
        deepest = float(self.profile.depth.max())
        return self.kilometres(2 * thickness / deepest) if deepest > 0 else math.inf

    def depth(self, s: Array, ring_km: float) -> Array:
        """Depth at stations, m, where the rings wear as by ``ring_km`` without a shoulder."""
        beyond = self.shoulder.depth(s, ring_km * float(self.profile.depth[-1]))
        return np.where(s > self.end, beyond, self.profile(s) * ring_km)

    @property
    def everywhere(self) -> Array:
        """Stations of any depth, m."""
        return np.union1d(np.linspace(0.0, self.end, STATIONS), self.shoulder.s)

    def stations(self, ring_km: float) -> Array:
        """Stations that resolve the depth, m."""
        reach = self.shoulder.reach(ring_km * float(self.profile.depth[-1]))
        return np.union1d(np.linspace(0.0, self.end, STATIONS), np.linspace(self.end, reach, SHOULDER_STATIONS))


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
    worn, outer = WornFace.of(section, wear), section.layers[-1]
    ring_km = worn.ring_kilometres(min(kilometres, worn.through(float(np.max(outer.thickness.values)))))
    table = np.asarray(outer.thickness.s)
    _check_left(worn, np.union1d(table, worn.everywhere), outer, ring_km)
    # Stations less than 10 micrometres apart are one.
    s = np.unique(np.round(np.union1d(table, worn.stations(ring_km)), 5))
    # The table still reaches the end of the meridian.
    s[-1] = table[-1]
    thickness, depth = outer.thickness(s), worn.depth(s, ring_km)
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
        crown = float(worn.profile(np.zeros(1))[0]) * ring_km
        data["parameters"]["outer_diameter"] = f"{(section.outer_diameter - 2 * crown) * 1e3:.6g} mm"
    data["title"] = f"{data.get('title', section.name)}, worn by {kilometres:,.0f} km"
    return data


def _check_left(worn: WornFace, s: Array, outer: Layer, ring_km: float) -> None:
    """Raise `InputError` where less than `LEFT` is left of a layer at stations, m.

    Beyond the wear the layer may be thinner than what a tread must keep.
    """
    from scipy.optimize import brentq

    rubber = outer.thickness(s) - LEFT
    most_rubber = max(float(rubber.max()), 0.0)

    def left(km: float) -> Array:
        depth = worn.depth(s, km)
        return np.where(depth > 0, rubber - depth, most_rubber)

    lacking = left(ring_km)
    if lacking.min() < 0:
        most = worn.kilometres(float(brentq(lambda km: left(km).min(), 0.0, ring_km)))
        at = s[int(np.argmin(lacking))] * 1e3
        message = f"the tread is worn through {at:.0f} mm from the crown: {most:,.0f} km leave {LEFT * 1e3:g} mm"
        raise InputError(message, field="distance")


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
