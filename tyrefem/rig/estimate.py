"""One identified number with its interval, and how much of it the readings know."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from tyrefem.rig.parameters import Parameter

#: Half width of a 95 % interval in standard deviations: Student's t with 8 degrees of freedom, as the card's standard
#: deviations are estimates that may be a quarter off (GUM, JCGM 100:2008, G.4.2: nu = 1/2 0.25^-2).
COVERAGE = 2.306
#: A property is not determined where readings leave more than this share of the prior's standard deviation ...
PRIOR_SHARE = 0.5
#: ... and only poorly where its relative standard deviation is larger than this.
POOR = 0.10


@dataclass(frozen=True)
class Estimate:
    """A parameter's most probable value, its 95 % interval, and the share of the prior's sd that is left.

    ``relative_sd`` is None for numbers that may be 0.
    """

    name: str
    unit: str
    group: str
    value: float
    low: float
    high: float
    sd: float
    relative_sd: float | None
    prior_value: float
    prior_sd: float
    share_left: float

    @property
    def verdict(self) -> str:
        """``determined``, ``poor`` or ``not determined``."""
        if self.share_left > PRIOR_SHARE:
            return "not determined"
        if self.relative_sd is not None and self.relative_sd > POOR:
            return "poor"
        return "determined"

    def holds(self, truth: float) -> bool:
        """Is a number inside the 95 % interval?"""
        return self.low <= truth <= self.high

    def to_dict(self) -> dict[str, Any]:
        """For tables and JSON."""
        return {
            "name": self.name,
            "unit": self.unit,
            "group": self.group,
            "value": self.value,
            "low_95": self.low,
            "high_95": self.high,
            "sd": self.sd,
            "relative_sd": self.relative_sd,
            "prior_value": self.prior_value,
            "prior_sd": self.prior_sd,
            "share_of_prior_sd_left": self.share_left,
            "verdict": self.verdict,
        }


def estimate_of(parameter: Parameter, x: float, sd: float) -> Estimate:
    """The estimate of a coordinate and its standard deviation.

    >>> k = Parameter("tread.conductivity", "W/m/K", "log", 0.25, 0.47, "property")
    >>> one = estimate_of(k, 0.1, 0.05)
    >>> round(one.low, 3), round(one.value, 3), round(one.high, 3), one.verdict
    (0.248, 0.262, 0.277, 'determined')
    """
    value = parameter.value(x)
    ends = sorted(parameter.value(x + sign * COVERAGE * sd) for sign in (-1.0, 1.0))
    width = abs(parameter.derivative(x)) * sd
    relative = parameter.spread * sd if parameter.law == "log" else None
    prior = parameter.value(0.0)
    prior_sd = abs(parameter.derivative(0.0))
    return Estimate(
        parameter.name, parameter.unit, parameter.group, value, ends[0], ends[1], width, relative, prior, prior_sd, sd
    )
