"""Result of the feedback of temperature on the strain cycle."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from tyrefem.brief import counted


@dataclass(frozen=True)
class InflationState:
    """Gauge pressure, Pa, and deflection, m, at a time, s."""

    time: float
    pressure: float
    deflection: float

    def __str__(self) -> str:
        return f"{self.deflection * 1e3:.1f} mm at {self.pressure / 1e3:.0f} kPa"


@dataclass(frozen=True)
class FeedbackOutcome:
    """Convergence of strain cycles and temperatures, and the changes by the feedback.

    Attributes
    ----------
    changes : K, of every run: largest difference between its temperatures and those of its strain cycles, over all
        knots, contained air, means of the regions that soften and, for friction, of the tread; infinite for an
        interrupted run.
    start, end : pressure and deflection at start and end.
    softened : region -> modulus of its compound at the end over the card's.
    friction_temperature : degC, of the coefficient of friction at the end; None: it does not follow the run.
    """

    tolerance: float
    changes: tuple[float, ...]
    start: InflationState
    end: InflationState
    softened: dict[str, float]
    friction_temperature: float | None = None

    @property
    def iterations(self) -> int:
        """Number of runs of the whole drive."""
        return len(self.changes)

    @property
    def converged(self) -> bool:
        """True if temperatures and strain cycles agree within the tolerance."""
        return self.changes[-1] <= self.tolerance

    @property
    def warnings(self) -> tuple[str, ...]:
        """One line if the feedback has not converged."""
        if self.converged or math.isinf(self.changes[-1]):
            return ()
        return (
            f"the feedback of temperature on the strain cycle has not converged: after {self.iterations} runs "
            f"temperatures still differ by {self.changes[-1]:.2g} K from those of the strain cycles (tolerance "
            f"{self.tolerance:g} K); increase mechanics.feedback.iterations",
        )

    @property
    def words(self) -> str:
        """One line of text."""
        change = f"{self.changes[-1]:.2g} K"
        state = f"converged to {change}" if self.converged else f"NOT converged: {change}"
        runs = counted(self.iterations, "run")
        if math.isinf(self.changes[-1]):
            state = "interrupted before the end of the drive"
        return f"{self.start} at the start, {self.end} at the end; {runs}, {state}"

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        contacts = {
            when: {"time_s": at.time, "gauge_pressure_Pa": at.pressure, "deflection_m": at.deflection}
            for when, at in (("start", self.start), ("end", self.end))
        }
        return {
            "converged": self.converged,
            "iterations": self.iterations,
            "change_K": list(self.changes),
            "tolerance_K": self.tolerance,
            **contacts,
            "relative_modulus_at_end": self.softened,
            "friction_temperature_at_end_degC": self.friction_temperature,
        }
