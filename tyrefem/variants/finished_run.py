"""What answers may use of a finished run: results of full runs and variants of reduced models have it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from tyrefem.conduction.field import Peak
    from tyrefem.inputs.study import StudyData
    from tyrefem.simulation.heat_budget import HeatBudget
    from tyrefem.simulation.rolling_resistance import RollingResistance
    from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]


class FinishedRun(Protocol):
    """Interface of a finished run for answers.

    A reduced variant also has all other attributes of a `Result`; their first use computes the whole result, slowly.
    """

    @property
    def study(self) -> StudyData:
        """The study of the run."""
        ...

    @property
    def tyre(self) -> RollingTyre:
        """The rolling tyre: drive, load cases and materials."""
        ...

    @property
    def times(self) -> Array:
        """Times of the readings, (n,) s."""
        ...

    @property
    def peaks(self) -> Mapping[str, Peak]:
        """Highest temperature of the ``tyre`` and of every region over the run."""
        ...

    def place_of(self, peak: Peak) -> tuple[float, float]:
        """(s, depth) of a peak, m."""
        ...

    def near(self, points: ArrayLike) -> Array:
        """Temperatures at points (n, 2) in (r, z), m, of another mesh of the section: (n_times, n), degC."""
        ...

    @property
    def recorded(self) -> Mapping[str, Array]:
        """Sensor -> recorded temperature, (n,) degC."""
        ...

    @property
    def gas_temperature(self) -> Array:
        """Temperature of the contained air, (n,) degC."""
        ...

    @property
    def rim_temperature(self) -> Array | None:
        """Temperature of a lumped rim, (n,) degC; None: the rim is not lumped."""
        ...

    def pressure_at(self, i: int) -> float:
        """Gauge pressure of the contained air at ``times[i]``, Pa."""
        ...

    @property
    def wall_gradient(self) -> tuple[Array, Array]:
        """Stations s (k,) m along the meridian, and |T inner - T outer| / thickness there at the end, K/m."""
        ...

    @property
    def rolling_resistance(self) -> RollingResistance:
        """Rolling resistance: force and coefficient."""
        ...

    @property
    def end_budget(self) -> HeatBudget:
        """Heat budget at the end; the last time of its series is the end."""
        ...

    @property
    def highest(self) -> Array:
        """Temperature of the hottest node over time, (n,) degC."""
        ...
