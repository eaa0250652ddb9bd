"""The parameters of a fit with their priors, in coordinates in which the prior is N(0, 1)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tyrefem.heating_test.card import RigCard

Array = NDArray[Any]

#: Groups: properties to identify, and other uncertain numbers.
PROPERTY, SLOPE, RIG = "property", "slope", "rig"


@dataclass(frozen=True)
class RigParameter:
    """A number with its prior.

    ``log``: ln p ~ N(ln centre, spread); ``linear``: p ~ N(centre, spread); ``rayleigh``: distance of a point whose two
    coordinates are N(0, spread); ``folded``: |N(0, spread)|. `value` maps the coordinate x ~ N(0, 1) to p.

    >>> k = RigParameter("tread.conductivity", "W/m/K", "log", 0.25, 0.5, PROPERTY)
    >>> round(k.value(0.0), 3), round(k.value(1.0), 3)
    (0.25, 0.412)
    """

    name: str
    unit: str
    law: Literal["log", "linear", "rayleigh", "folded"]
    centre: float
    spread: float
    group: str

    def value(self, x: float) -> float:
        """The value at a coordinate."""
        if self.law == "log":
            return self.centre * math.exp(self.spread * x)
        if self.law == "linear":
            return self.centre + self.spread * x
        above = max(0.5 * math.erfc(x / math.sqrt(2.0)), 1e-16)
        if self.law == "rayleigh":
            return self.spread * math.sqrt(-2.0 * math.log(above))
        from scipy.special import ndtri

        return self.spread * float(-ndtri(above / 2.0))

    def derivative(self, x: float) -> float:
        """d value / d x."""
        if self.law == "log":
            return self.value(x) * self.spread
        if self.law == "linear":
            return self.spread
        return (self.value(x + 1e-4) - self.value(x - 1e-4)) / 2e-4


@dataclass(frozen=True)
class Parameters:
    """The free parameters in order, and the values of the fixed ones."""

    free: tuple[RigParameter, ...]
    held: Mapping[str, float]

    def __len__(self) -> int:
        return len(self.free)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the free parameters, in order."""
        return tuple(parameter.name for parameter in self.free)

    def values(self, x: Sequence[float] | Array) -> dict[str, float]:
        """Name -> value of every parameter of the rig at coordinates x."""
        return {
            **self.held,
            **{parameter.name: parameter.value(float(v)) for parameter, v in zip(self.free, x, strict=True)},
        }

    def without(self, names: Sequence[str] | set[str]) -> Parameters:
        """A copy with some parameters fixed at their centre."""
        gone = {parameter.name: parameter.centre for parameter in self.free if parameter.name in names}
        return replace(self, free=tuple(o for o in self.free if o.name not in gone), held={**self.held, **gone})


def clock_of(run: str) -> str:
    """The parameter of a run's clock: time by its table at which the card's time is 0, s."""
    return f"{run}.clock"


def parameters_of(card: RigCard, sensors: Sequence[str], runs: Sequence[str] | None = None) -> Parameters:
    """The parameters of a rig with the given sensors and runs (None: all); parameters without uncertainty are fixed.

    >>> from tyrefem.heating_test.files import load
    >>> parameters = parameters_of(load("trtlab")[0], ["outer", "inner", "interface"])
    >>> parameters.names[:4]
    ('tread.conductivity', 'tread.specific_heat', 'tread.conductivity_slope', 'tread.specific_heat_slope')
    """
    listed: list[RigParameter] = []
    for layer in card.layers:
        for key, unit in (("conductivity", "W/m/K"), ("specific_heat", "J/kg/K")):
            guess = getattr(layer, key)
            listed.append(_log(f"{layer.name}.{key}", unit, guess.value, guess.relative_sd, PROPERTY))
        for key in ("conductivity", "specific_heat"):
            slope = getattr(layer, key).slope
            listed.append(RigParameter(f"{layer.name}.{key}_slope", "1/K", "linear", slope, card.slope_sd, SLOPE))
    laser, around = card.laser, card.surroundings
    listed += [
        _log("absorptance", "1", laser.absorptance, laser.absorptance_sd / laser.absorptance, RIG),
        _log("outer_film", "1", 1.0, around.convection_sd, RIG),
        _log("inner_film", "1", 1.0, around.convection_sd, RIG),
    ]
    emissivity = around.emissivity if around.radiation else 0.0
    listed.append(
        RigParameter("emissivity", "1", "linear", emissivity, around.emissivity_sd if emissivity else 0.0, RIG)
    )
    for layer in card.layers:
        listed.append(RigParameter(f"{layer.name}.thickness", "m", "linear", layer.thickness, layer.thickness_sd, RIG))
    seen = {name: card.sensors[name] for name in sensors}
    # One coordinate is enough if every sensor is aimed at the mark: only the distance has an effect.
    aside = any(parameter.aside > 0 for parameter in seen.values())
    listed.append(RigParameter("spot_along", "m", "linear", 0.0, laser.placing_sd if aside else 0.0, RIG))
    listed.append(RigParameter("spot_across", "m", "folded" if aside else "rayleigh", 0.0, laser.placing_sd, RIG))
    for name, sensor in seen.items():
        if sensor.depth is not None:
            listed.append(RigParameter(f"{name}.depth", "m", "linear", sensor.depth, sensor.depth_sd, RIG))
            spread = sensor.lag_sd if sensor.lag else 0.0
            listed.append(_log(f"{name}.lag", "s", sensor.lag, spread, RIG))
        listed.append(RigParameter(f"{name}.offset", "K", "linear", 0.0, sensor.offset_sd, RIG))
        listed.append(_log(f"{name}.gain", "1", 1.0, sensor.gain_sd, RIG))
    for run in card.runs if runs is None else runs:
        listed.append(RigParameter(clock_of(run), "s", "linear", 0.0, card.phases.clock_sd, RIG))
    free = tuple(parameter for parameter in listed if parameter.spread > 0)
    return Parameters(free, {parameter.name: parameter.centre for parameter in listed if not parameter.spread > 0})


def _log(name: str, unit: str, centre: float, relative_sd: float, group: str) -> RigParameter:
    return RigParameter(name, unit, "log", centre, math.sqrt(math.log1p(relative_sd**2)), group)


def at(x: Array, place: int, step: float) -> Array:
    """Coordinates with a step in one of them."""
    moved = np.array(x, dtype=float)
    moved[place] += step
    return moved
