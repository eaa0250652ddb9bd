"""A variant of a reduced model with the interface of a finished run."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.conduction.field import Peak
from tyrefem.inputs.study import StudyData
from tyrefem.reduced.balance import ReducedBalance
from tyrefem.reduced.model import ReducedModel
from tyrefem.reduced.readout import Readout
from tyrefem.simulation.heat_budget import HeatBudget
from tyrefem.simulation.readings import logged_columns
from tyrefem.simulation.result import ResultData, warmed
from tyrefem.simulation.rolling_resistance import RollingResistance, rolling_resistance
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.simulate import output_times
from tyrefem.simulation.surroundings import GAS, RIM

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Variant:
    """A `tyrefem.variants.finished_run.FinishedRun` whose numbers come from POD modes.

    Other attributes of a `Result` are computed at their first use.

    Parameters
    ----------
    readout : of the variant's batch. number : place of the variant in the batch.
    """

    readout: Readout
    number: int

    @property
    def tyre(self) -> RollingTyre:
        """The rolling tyre: drive, load cases and materials."""
        return self._balance.tyre

    @property
    def _balance(self) -> ReducedBalance:
        return self.readout.solution.batch.balances[self.number]

    @property
    def _alike(self) -> RollingTyre:
        """A tyre with the same phases, zones, section and sensors, which need not be made for this variant."""
        return self._balance.alike

    @property
    def input_answers(self) -> Mapping[str, Mapping[str, float]]:
        """Function -> its answers, of those that are known without making the tyre."""
        return self._balance.answers

    @property
    def _model(self) -> ReducedModel:
        return self.readout.solution.batch.models[self.number]

    @property
    def study(self) -> StudyData:
        """The study of the variant."""
        return self.tyre.study

    @property
    def times(self) -> Array:
        """Times of the readings, (n,) s."""
        return self.readout.times

    @functools.cached_property
    def result(self) -> ResultData:
        """The whole result, with all fields and the heat budget over time."""
        _, fields = output_times(self.tyre)
        return ResultData(self.study, self.tyre, self.readout.solution.history(self.number, self.times), fields, 0.0)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.result, name)

    @property
    def estimated_error(self) -> float | None:
        """Estimated error of the temperatures at sensors and at the hottest places, K; None: no estimate."""
        errors = self.readout.errors
        return None if errors is None else float(errors[self.number])

    @property
    def peaks(self) -> dict[str, Peak]:
        """Highest temperature of the ``tyre`` and of every region."""
        return self.readout.peaks[self.number]

    def place_of(self, peak: Peak) -> tuple[float, float]:
        """(s, depth) of a peak, m."""

        def located() -> tuple[float, float]:
            s, depth = section.locate(np.array([peak.point]))
            return float(s[0]), float(depth[0])

        section = self._alike.study.section
        return self._model.node_places.get((section, peak.point), located)

    def near(self, points: ArrayLike) -> Array:
        """Temperatures at points (n, 2) in (r, z), m, of another mesh of the section: (n_times, n), degC."""
        return self.result.near(points)

    @functools.cached_property
    def recorded(self) -> dict[str, Array]:
        """Sensor -> recorded temperature, (n_times,) degC."""
        return self.readout.recorded(self.number)

    @property
    def gas_temperature(self) -> Array:
        """Temperature of the contained air, (n_times,) degC."""
        history = self.readout.reservoirs(self.number).get(GAS)
        if history is not None:
            return history
        return np.full(len(self.times), self._balance.fixed_gas)

    @property
    def rim_temperature(self) -> Array | None:
        """Temperature of a lumped rim, (n_times,) degC; None if the rim's temperature is given."""
        return self.readout.reservoirs(self.number).get(RIM)

    def pressure_at(self, i: int) -> float:
        """Gauge pressure of the contained air at ``times[i]``, Pa."""
        return warmed(self._balance.pressure(float(self.times[i])), self.gas_temperature, i)

    @functools.cached_property
    def readings(self) -> pd.DataFrame:
        """Table of readings, as `Result.readings`."""
        import pandas as pd

        rim = self.rim_temperature
        lumped = {GAS: self.gas_temperature} | ({} if rim is None else {RIM: rim})
        return pd.DataFrame(logged_columns(self._alike.study, self.times, self.recorded, lumped))

    @property
    def wall_gradient(self) -> tuple[Array, Array]:
        """Stations s (k,) m along the meridian, and |T inner - T outer| / thickness there at the end, K/m."""
        return self._model.wall[0], self.readout.wall[self.number]

    @property
    def highest(self) -> Array:
        """Temperature of the hottest node over time, (n_times,) degC."""
        return self.readout.highest[:, self.number]

    @property
    def _sides(self) -> float:
        return 2.0 if self._alike.study.section.half else 1.0

    def generated(self, i: int) -> tuple[float, float]:
        """Heat of hysteresis in the whole tyre until ``times[i]``, J, and its power at ``times[i]``, W."""
        energy, power = self.readout.generated(i)
        return self._sides * float(energy[self.number]), self._sides * float(power[self.number])

    def cold_power(self, t: float) -> float:
        """Power of hysteresis in the whole tyre at the initial temperature, W, just before a reading at t."""
        i = int(np.searchsorted(self.times, t - 1e-12))
        return self._sides * float(self.readout.cold_power(i)[self.number])

    @functools.cached_property
    def rolling_resistance(self) -> RollingResistance:
        """Rolling resistance of hysteresis: force, N, and coefficient."""
        return rolling_resistance(self, self._balance.rolling)

    @functools.cached_property
    def end_budget(self) -> HeatBudget:
        """The heat budget of the whole tyre at the end."""
        return self.readout.end_budget(self.number)
