"""What an answer may ask of a run: a full one's `Result` has it, and so has a variant of a reduced model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from tyrefem.conduction.history import Peak
    from tyrefem.heat_budget import HeatBudget
    from tyrefem.rolling import RollingTyre
    from tyrefem.rolling_resistance import RollingResistance
    from tyrefem.studies import Study

Array = NDArray[np.float64]


class Outcome(Protocol):
    """A finished run, as far as answers look at it. An answer that needs more takes it from the whole `Result`, which
    a reduced variant makes when it is first asked for: right, but slower."""

    @property
    def study(self) -> Study:
        """What was run."""
        ...

    @property
    def tyre(self) -> RollingTyre:
        """Its drive, load cases and materials."""
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

    @property
    def recorded(self) -> Mapping[str, Array]:
        """Sensor -> what the logger recorded, (n,) degC."""
        ...

    @property
    def gas_temperature(self) -> Array:
        """Contained air, (n,) degC."""
        ...

    @property
    def rim_temperature(self) -> Array | None:
        """A lumped rim, (n,) degC; None: not lumped."""
        ...

    def pressure_at(self, i: int) -> float:
        """Gauge pressure of the contained air at ``times[i]``, Pa."""
        ...

    @property
    def wall_gradient(self) -> tuple[Array, Array]:
        """s (k,) m along the meridian, and |T inner - T outer| / thickness there at the end, K/m."""
        ...

    @property
    def rolling_resistance(self) -> RollingResistance:
        """Force and coefficient."""
        ...

    @property
    def end_budget(self) -> HeatBudget:
        """Heat budget at the end; its series have one time at least, the last being the end."""
        ...

    @property
    def highest(self) -> Array:
        """Hottest node over time, (n,) degC."""
        ...
