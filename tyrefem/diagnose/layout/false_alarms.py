"""How often the criteria of "unexplained" reject a right model: many draws with nothing hidden."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import betaincinv, chdtrc

from tyrefem.diagnose.fitting.pulls import pulls_probability
from tyrefem.diagnose.layout.linear_layout import LinearLayout

#: Draws that are computed at once.
BATCH = 2000
#: Criterion by the held-out runs.
HELD_OUT = "held-out runs"


@dataclass(frozen=True)
class Frequency:
    """``count`` of ``of`` cases with its exact 95 % interval (Clopper & Pearson 1934); ``stated``: share by the method.

    >>> each = Frequency(0, 100)
    >>> [round(x, 4) for x in each.interval]
    [0.0, 0.0362]
    """

    count: int
    of: int
    stated: float | None = None

    @property
    def share(self) -> float:
        """The share; NaN without cases."""
        return self.count / self.of if self.of else math.nan

    @property
    def interval(self) -> tuple[float, float]:
        """Lower and upper limit of the share."""
        k, n = self.count, self.of
        low = float(betaincinv(k, n - k + 1, 0.025)) if k else 0.0
        return low, float(betaincinv(k + 1, n - k, 0.975)) if k < n else 1.0

    @property
    def agrees(self) -> bool:
        """Whether the stated share lies in the interval; True if none is stated."""
        low, high = self.interval
        return self.stated is None or low <= self.stated <= high

    def to_dict(self) -> dict[str, float | int | None]:
        """Plain data."""
        low, high = self.interval
        return {
            "count": self.count, "of": self.of, "share": self.share, "low": low, "high": high, "stated": self.stated,
        }  # fmt: skip


def false_alarms(layout: LinearLayout, draws: int, seed: int) -> dict[str, Frequency]:
    """Criterion -> share of draws that it rejects although nothing is missing and all priors are right.

    d = J x + e with x ~ N(0, S^2), e ~ N(0, 1), fitted without effects: misfit |d - J x|^2 + |x/s|^2 (chi-squared,
    exact for a linear model), largest pull, all pulls together, and, if runs are held out, their prediction.
    """
    settings, design = layout.settings, layout.design
    n = design.nuisance
    sd = design.sd[:n]
    J, held_out = design.jacobian[:, :n] * sd, layout.held_out[:, :n] * sd
    covariance = np.asarray(np.linalg.inv(np.eye(n) + J.T @ J), dtype=np.float64)
    root = np.linalg.cholesky(np.eye(len(held_out)) + held_out @ covariance @ held_out.T)
    rng = np.random.default_rng([seed, draws])
    counts, union, done = dict.fromkeys(("misfit", "a pull", "all pulls"), 0), 0, 0
    if len(held_out):
        counts[HELD_OUT] = 0
    while done < draws:
        size = min(BATCH, draws - done)
        x = rng.normal(size=(n, size))
        data = J @ x + rng.normal(size=(len(J), size))
        rest = held_out @ x + rng.normal(size=(len(held_out), size))
        z = covariance @ (J.T @ data)
        misfit = ((data - J @ z) ** 2).sum(axis=0) + (z**2).sum(axis=0)
        w = np.linalg.solve(root, rest - held_out @ z)
        rejected = {
            "misfit": chdtrc(len(J), misfit) < settings.rejected_p,
            "a pull": (np.abs(z) > settings.largest_pull).any(axis=0),
            "all pulls": pulls_probability((z**2).sum(axis=0), covariance) < settings.rejected_p,
        }
        if HELD_OUT in counts:
            rejected[HELD_OUT] = chdtrc(len(rest), (w**2).sum(axis=0)) < settings.rejected_p
        for name, each in rejected.items():
            counts[name] += int(each.sum())
        union += int(np.any(list(rejected.values()), axis=0).sum())
        done += size
    stated = dict.fromkeys(("misfit", "all pulls", HELD_OUT), settings.rejected_p)
    result = {name: Frequency(count, draws, stated.get(name)) for name, count in counts.items()}
    return result | {"any of them": Frequency(union, draws)}
