"""Selection of properties that are linear in temperature, by evidence; and identified parameters with intervals."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.heating_test.noise import Normal, log_evidence
from tyrefem.heating_test.parameters import SLOPE, Parameters, RigParameter

Array = NDArray[Any]


#: Gain of ln evidence that justifies a more complex model.
MARGIN = 1.0


#: Largest number of slopes with all combinations; with more slopes, at most two are combined.
_ALL = 8


@dataclass(frozen=True, eq=False)
class Selection(Brief):
    """Evidence of every combination of linear properties.

    Attributes
    ----------
    chosen : slopes that are fitted; the others have the card's value (usually 0).
    log_evidence : combination -> ln evidence relative to no slope.
    probability : slope -> probability of a non-zero slope, with equal prior probabilities of all combinations.
    mean, covariance : mean and covariance of all coordinates, over the combinations weighted by probability.
    """

    chosen: tuple[str, ...]
    log_evidence: Mapping[tuple[str, ...], float]
    probability: Mapping[str, float]
    mean: Array
    covariance: Array


def combinations(slopes: Sequence[str]) -> list[tuple[str, ...]]:
    """Sets of slopes, the empty one first.

    >>> combinations(["a", "b"])
    [(), ('a',), ('b',), ('a', 'b')]
    """
    most = len(slopes) if len(slopes) <= _ALL else 2
    return [combination for n in range(most + 1) for combination in itertools.combinations(slopes, n)]


def select(parameters: Parameters, eq: Normal, x: Array) -> Selection:
    """Compute the evidence of every combination, linearised at x, where `parameters` has every slope free.

    The Laplace evidence integrates each slope over its prior, so an unnecessary slope reduces the evidence.
    """
    slopes = [parameter.name for parameter in parameters.free if parameter.group == SLOPE]
    place = {name: i for i, name in enumerate(parameters.names)}
    right = eq.right + eq.matrix @ x
    sets = combinations(slopes)
    logs, means, covariances = [], [], []
    for combination in sets:
        kept = np.array([i for name, i in place.items() if name not in slopes or name in combination])
        logs.append(log_evidence(eq, x, kept))
        block = np.linalg.inv(np.eye(kept.size) + eq.matrix[np.ix_(kept, kept)])
        mean, covariance = np.zeros(x.size), np.zeros((x.size, x.size))
        mean[kept] = block @ right[kept]
        covariance[np.ix_(kept, kept)] = block
        means.append(mean)
        covariances.append(covariance)
    values = np.array(logs)
    weight = np.exp(values - values.max())
    weight /= weight.sum()
    centre = np.tensordot(weight, np.array(means), 1)
    spread = sum(w * (c + np.outer(m - centre, m - centre)) for w, m, c in zip(weight, means, covariances, strict=True))
    probable = {
        n: float(sum(w for w, combination in zip(weight, sets, strict=True) if n in combination)) for n in slopes
    }
    good = [i for i in range(len(sets)) if values[i] > values.max() - MARGIN]
    simplest = min(good, key=lambda i: (len(sets[i]), -values[i]))
    relative = {combination: float(v - values[0]) for combination, v in zip(sets, values, strict=True)}
    return Selection(sets[simplest], relative, probable, centre, np.asarray(spread))


#: Half width of a 95 % interval in standard deviations: Student's t with 8 degrees of freedom, because the card's
#: standard deviations are estimates with a relative error of 25 % (GUM, JCGM 100:2008, G.4.2: nu = 1/2 0.25^-2).
COVERAGE = 2.306


#: A property is not determined if the posterior sd is more than this share of the prior sd,
PRIOR_SHARE = 0.5


#: and poorly determined if its relative standard deviation is larger than this.
POOR = 0.10


@dataclass(frozen=True)
class ParameterEstimate:
    """A parameter's most probable value, 95 % interval, and ratio of posterior sd and prior sd.

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
    #: Whether the model misses the readings by more than an interval can allow for.
    doubtful: bool = False

    @property
    def verdict(self) -> str:
        """``determined``, ``poor``, ``not determined``, or ``doubtful`` in place of the first two."""
        if self.share_left > PRIOR_SHARE:
            return "not determined"
        if self.doubtful:
            return "doubtful"
        if self.relative_sd is not None and self.relative_sd > POOR:
            return "poor"
        return "determined"

    def holds(self, value: float) -> bool:
        """True if a number is in the 95 % interval."""
        return self.low <= value <= self.high

    def to_dict(self) -> dict[str, Any]:
        """Data for tables and JSON."""
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


def estimate_of(parameter: RigParameter, x: float, sd: float) -> ParameterEstimate:
    """The estimate from a coordinate and its standard deviation.

    >>> k = RigParameter("tread.conductivity", "W/m/K", "log", 0.25, 0.47, "property")
    >>> estimate = estimate_of(k, 0.1, 0.05)
    >>> round(estimate.low, 3), round(estimate.value, 3), round(estimate.high, 3), estimate.verdict
    (0.248, 0.262, 0.277, 'determined')
    """
    value = parameter.value(x)
    ends = sorted(parameter.value(x + sign * COVERAGE * sd) for sign in (-1.0, 1.0))
    width = abs(parameter.derivative(x)) * sd
    relative = parameter.spread * sd if parameter.law == "log" else None
    prior = parameter.value(0.0)
    prior_sd = abs(parameter.derivative(0.0))
    return ParameterEstimate(
        parameter.name, parameter.unit, parameter.group, value, ends[0], ends[1], width, relative, prior, prior_sd, sd
    )
