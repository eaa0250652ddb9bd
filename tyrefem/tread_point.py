"""One point of the tread: a strip of rubber through its thickness, and what it meets in a revolution."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tyrefem.boundaries import LawOf
from tyrefem.conduction import Conduction, Film, Fixed, Material
from tyrefem.errors import InputError
from tyrefem.road_contact import half_space_film, propagation_depth

#: Instantaneous film in contact over the mean one: this close to perfect contact, which loses 0.08 % of the heat.
PERFECT = 1000.0


@dataclass(frozen=True)
class TreadPoint:
    """A tread point and what it meets in one revolution. SI units, degC.

    ``inner_temperature`` holds the tread's inner side; None insulates it, and ``heat_source`` (W/m3) heats the rubber.
    ``air_film`` is the report's 5.44 + 1.674 v where it is None. Raises InputError for what cannot be.

    >>> round(TreadPoint(speed=10.0, footprint_length=0.14).contact_time, 4)
    0.014
    """

    speed: float
    footprint_length: float
    circumference: float = 1.9
    thickness: float = 0.010
    conductivity: float = 0.25
    heat_capacity: float = 2e6
    inner_temperature: float | None = 80.0
    heat_source: float = 0.0
    air_film: float | None = None
    air_temperature: float = 25.0
    road_temperature: float = 25.0

    def __post_init__(self) -> None:
        for field in ("speed", "footprint_length", "circumference", "thickness", "conductivity", "heat_capacity"):
            if not (math.isfinite(getattr(self, field)) and getattr(self, field) > 0):
                raise InputError(f"must be finite and more than 0, not {getattr(self, field)!r}", field=field)
        if self.footprint_length >= self.circumference:
            raise InputError(f"must be less than the circumference, {self.circumference:g} m", field="footprint_length")
        if self.air_film is not None and not (math.isfinite(self.air_film) and self.air_film >= 0):
            raise InputError(f"must be finite and at least 0, not {self.air_film!r}", field="air_film")

    @property
    def revolution(self) -> float:
        """Time of one revolution, s."""
        return self.circumference / self.speed

    @property
    def contact_time(self) -> float:
        """Time on the road in one revolution, s."""
        return self.footprint_length / self.speed

    @property
    def fraction(self) -> float:
        """Fraction of the revolution on the road."""
        return self.footprint_length / self.circumference

    @property
    def mean_film(self) -> float:
        """H_c, the exact mean over a contact with a road that keeps its temperature, W/m2/K."""
        return half_space_film(self.speed, self.footprint_length, self.conductivity, self.heat_capacity)

    @property
    def air(self) -> float:
        """Film off the road, W/m2/K."""
        if self.air_film is not None:
            return self.air_film
        return float(LawOf("outside_air", "nasa")({}).film(self.speed))

    @property
    def phases(self) -> tuple[tuple[float, float, float], ...]:
        """Duration s, film W/m2/K and sink degC: on the road, then off it."""
        on = (self.contact_time, PERFECT * self.mean_film, self.road_temperature)
        return on, (self.revolution - self.contact_time, self.air, self.air_temperature)

    @functools.cached_property
    def mesh(self) -> Any:
        """A strip one element wide, x from the inner side to the surface, fine where a contact reaches."""
        import skfem

        reach = propagation_depth(self.contact_time, self.conductivity, self.heat_capacity)
        sizes = [min(reach / 40, self.thickness / 60)]
        while sum(sizes) < self.thickness:
            sizes.append(min(1.12 * sizes[-1], self.thickness / 25))
        depths = np.concatenate([[0.0], np.cumsum(sizes)])
        x = self.thickness * (1 - depths[::-1] / depths[-1])
        mesh = skfem.MeshQuad.init_tensor(x, np.array([0.0, 40 * sizes[0]]))
        last = self.thickness * (1 - 1e-9)
        sides = {"inner": lambda p: p[0] < 1e-9 * self.thickness, "surface": lambda p: p[0] > last}
        return mesh.with_subdomains({"tread": lambda p: p[0] >= 0}).with_boundaries(sides)

    def conduction(self, films: Film | Sequence[Film]) -> Conduction:
        """The strip as a conduction problem under films on its surface, planar."""
        sides: dict[str, Any] = {"surface": films}
        if self.inner_temperature is not None:
            sides["inner"] = Fixed(self.inner_temperature)
        rubber = {"tread": Material(self.conductivity, self.heat_capacity)}
        return Conduction(self.mesh, rubber, sides, {"tread": self.heat_source}, axisymmetric=False)

    def averaged(self, film: float | None = None) -> Conduction:
        """The strip under f H_c + (1 - f) h_air; ``film`` is another H_c than the exact mean."""
        road = self.mean_film if film is None else film
        return self.conduction(
            [
                Film(self.fraction * road, self.road_temperature),
                Film((1 - self.fraction) * self.air, self.air_temperature),
            ]
        )
