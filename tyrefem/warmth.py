"""What the mechanics feels of the temperatures: the contained air's, and every region's mean."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from tyrefem.result import Result
    from tyrefem.studies import Study

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Moment:
    """Temperatures of a moment, degC: of the contained air, and the mean of every region."""

    gas: float
    regions: Mapping[str, float]

    def distance(self, other: Moment, *, gas: bool, regions: tuple[str, ...]) -> float:
        """Largest difference, K, of the contained air (if ``gas``) and of some regions."""
        found = [abs(self.gas - other.gas)] if gas else []
        found += [abs(self.regions[name] - other.regions[name]) for name in regions]
        return max(found, default=0.0)

    def towards(self, other: Moment, share: float) -> Moment:
        """A share of the way to another moment."""
        if share == 1:
            return other
        regions = {name: T + share * (other.regions[name] - T) for name, T in self.regions.items()}
        return Moment(self.gas + share * (other.gas - self.gas), regions)


@dataclass(frozen=True, eq=False)
class Warmth:
    """Temperatures over a drive, degC: ``times`` (n,) s, contained air ``gas`` (n,), ``regions`` name -> (n,).

    Linear between the times, constant beyond them.

    >>> warmth = Warmth(np.array([0.0, 100.0]), np.array([25.0, 45.0]), {"tread": np.array([25.0, 65.0])})
    >>> warmth.at(50.0)
    Moment(gas=35.0, regions={'tread': 45.0})
    """

    times: Array
    gas: Array
    regions: Mapping[str, Array]

    def at(self, time: float) -> Moment:
        """The moment of a time, s."""
        regions = {name: float(np.interp(time, self.times, T)) for name, T in self.regions.items()}
        return Moment(float(np.interp(time, self.times, self.gas)), regions)

    @classmethod
    def even(cls, study: Study, warmer_by: float = 0.0) -> Warmth:
        """Every region at the drive's initial temperature and the air at its own, or all so much warmer, K."""
        initial = study.card.drive.initial
        gas = study.card.boundaries.contained_air.start(initial)
        regions = {region: np.array([initial + warmer_by]) for region in study.materials}
        return cls(np.zeros(1), np.array([gas + warmer_by]), regions)

    @classmethod
    def of(cls, result: Result) -> Warmth:
        """That of a finished run: means by volume."""
        operators, values, regions = result.tyre.problem.operators, result.history.values, {}
        for region in result.study.materials:
            weights = np.asarray(operators.source(region).sum(axis=0)).ravel()
            regions[region] = values[:, operators.dofs(region)] @ (weights / weights.sum())
        return cls(result.times, result.gas_temperature, regions)
