"""The places of a tyre that fail first, with the plane of the crack and the reason in words."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.fatigue.life import LifeData
from tyrefem.geometry.place_names import place

Array = NDArray[np.float64]
#: Places that are reported; places of one region are at least this far apart, m.
COUNT, APART = 10, 10e-3
#: A place at most this far along the meridian from where its region ends is "at the edge", m.
EDGE = 6e-3
#: Share of shear in the energy from which it is the reason; below the other one, opening is.
SHEAR, OPENING = 0.6, 0.4


@dataclass(frozen=True)
class FailurePlace:
    """A place that fails: lengths in m, energies J/m3, T in J/m2, angles in degrees.

    ``plane_from_circumference``: between the plane of the crack and the circumference. ``normal_from_axis``: of the
    normal's part in the section, from the wheel's axis towards the tread.
    """

    region: str
    r: float
    z: float
    s: float
    depth: float
    km: float
    normal: tuple[float, float, float]
    plane_from_circumference: float
    normal_from_axis: float
    peak: float
    valley: float
    tearing_energy: float
    stretch: float
    shear_share: float
    temperature: float
    phase: str
    phase_share: float
    reason: str

    def row(self) -> dict[str, Any]:
        """A row of the table, with units in the names."""
        values = asdict(self)
        normal = values.pop("normal")
        units = {
            "r": "r_m", "z": "z_m", "s": "s_m", "depth": "depth_m", "km": "life_km", "peak": "peak_J_m3",
            "valley": "valley_J_m3", "tearing_energy": "tearing_energy_J_m2", "temperature": "temperature_degC",
            "plane_from_circumference": "plane_from_circumference_deg", "normal_from_axis": "normal_from_axis_deg",
        }  # fmt: skip
        row = {units.get(name, name): value for name, value in values.items()}
        at = list(row).index("plane_from_circumference_deg")
        parts = list(row.items())
        directions = [(f"normal_{axis}", part) for axis, part in zip("rzt", normal, strict=True)]
        return dict(parts[:at] + directions + parts[at:])


def first_places(life: LifeData, count: int = COUNT) -> tuple[FailurePlace, ...]:
    """The places that fail first, the shortest life first; those of one region are at least `APART` from each other."""
    order = [int(e) for e in np.argsort(life.element_km) if np.isfinite(life.element_km[e])]
    chosen: list[tuple[str, Array]] = []
    places = []
    for element in order:
        region, centre = life.rings.region_of(element), life.rings.points[:, element].mean(axis=-1)
        if any(region == other and np.hypot(*(centre - there)) < APART for other, there in chosen):
            continue
        chosen.append((region, centre))
        places.append(_place(life, element, region, centre))
        if len(places) == count:
            break
    return tuple(places)


def _place(life: LifeData, element: int, region: str, centre: Array) -> FailurePlace:
    at = element, int(life.typical[element])
    normal = life.normals[at] * np.where(life.normals[at][1] < 0, -1.0, 1.0)
    section = life.study.section
    s, depth = (float(values[0]) for values in section.locate(centre[None]))
    shares = life.shares[(slice(None), *at)]
    phase = int(shares.argmax())
    angle = float(np.degrees(np.arcsin(min(abs(normal[2]), 1.0))))
    shear = float(1 - life.opening[at])
    temperature = float(life.temperatures[at])
    return FailurePlace(
        region, float(centre[0]), float(centre[1]), s, depth, float(life.element_km[element]),
        (float(normal[0]), float(normal[1]), float(normal[2])), angle,
        float(np.degrees(np.arctan2(normal[0], normal[1]))), float(life.peak[at]), float(life.valley[at]),
        float(life.tearing_energy[at]), float(life.stretch[at]), shear, temperature,
        life.study.card.drive.phases[phase].name, float(shares[phase]),
        f"{_kind(shear)} {_where(life, region, s, depth)}, {temperature:.0f} degC, plane {angle:.0f} deg from the "
        "circumference",
    )  # fmt: skip


def _kind(shear: float) -> str:
    if shear >= SHEAR:
        return "shear"
    return "opening" if shear <= OPENING else "opening and shear"


def _where(life: LifeData, region: str, s: float, depth: float) -> str:
    """ "at the edge of belt-1, at the shoulder, ..."; "in the sidewall, ..."."""
    section = life.study.section
    points = life.rings.points[:, life.members(region)].reshape(2, -1).T
    ends = np.abs(section.locate(points)[0])
    length = section.line.length
    near = [end for end in (ends.min(), ends.max()) if EDGE < end < length - EDGE and abs(abs(s) - end) < EDGE]
    return f"{'at the edge of' if near else 'in'} {region}, {place(section, s, depth, region)}"
