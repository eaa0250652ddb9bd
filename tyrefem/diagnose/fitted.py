"""A set of effects fitted to the data: values, evidence, and how well it predicts the held-out runs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from tyrefem.brief import Brief
from tyrefem.diagnose.evidence import Fit, Members
from tyrefem.diagnose.linearised import Gap
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns import Unknown

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Explained(Brief):
    """A set of effects fitted to the data.

    Parameters
    ----------
    members : the set. unknowns : everything fitted. fit : posterior. log_evidence : ln p(fitted data | set).
    computed : trial -> block means of the fitted model, corrected for the mesh. misfit : |r|^2 + |x/sd|^2.
    readings : number of fitted blocks. held_out : ln p(held-out data | fitted data, set), and
        its chi-squared probability ``held_out_p``; NaN where no run is held out. steps : simulations.
    """

    members: Members
    unknowns: tuple[Unknown, ...]
    fit: Fit
    log_evidence: float
    computed: dict[int, Array]
    misfit: float
    readings: int
    held_out: float
    held_out_p: float
    steps: int
    converged: bool
    #: Linear model of the fitted trials about the fit, d = J x + e: whitened data and jacobian of ``unknowns``.
    data: Array
    jacobian: Array
    #: State of the fit, from which `tyrefem.diagnose.fit` goes on.
    refinement: Any
    settings: DiagnosisSettings

    @property
    def close(self) -> bool:
        """Not far from a misfit that noise makes: a place to judge larger sets from, and to start them from.

        A fit that has not converged must already fit as well as noise lets the truth.
        """
        return self.misfit < self.settings.nearly * self.readings and (
            self.converged or self.p_value > self.settings.usual
        )

    @property
    def finished(self) -> bool:
        """Nothing is gained by going on: converged, with all shape parameters fitted."""
        return self.converged and not self.refinement.shapes

    @cached_property
    def values(self) -> dict[Unknown, float]:
        """Unknown -> x; 1 for what is simply there."""
        fitted = dict(zip(self.unknowns, (float(x) for x in self.fit.mean), strict=True))
        return fitted | {one: 1.0 for member in self.members for one in member.presence}

    @cached_property
    def sd(self) -> dict[Unknown, float]:
        """Unknown -> posterior standard deviation of x."""
        fitted = dict(zip(self.unknowns, (float(x) for x in self.fit.sd), strict=True))
        return fitted | {one: 0.0 for member in self.members for one in member.presence}

    @property
    def p_value(self) -> float:
        """Probability of a misfit at least as large, were the model right: chi-squared with one degree per block."""
        return float(chi2.sf(self.misfit, self.readings))

    @property
    def at_bound(self) -> tuple[str, ...]:
        """Keys of the effects' amplitudes that ended on a bound, and that the data want beyond it.

        An emissivity of 0.95 is, in half of all noise, best fitted by 1: that is no sign of another cause.
        """
        own = {one for member in self.members for one in member.amplitudes}
        pairs = zip(self.unknowns, self.fit.beyond, strict=True)
        return tuple(one.key for one, beyond in pairs if beyond > self.settings.pressed and one in own)


def explained(gap: Gap, one: Any) -> Explained:
    """What a refinement has come to."""
    values = one.named(one.x)
    computed = {i: gap.corrected(i, one.computed[i]) for i in gap.fitted}
    log_held = p_held = math.nan
    if gap.held_out:
        answers = gap.predicted.predict([(one.members, values)], gap.held_out)[0]
        columns = [gap.unknowns.index(unknown) for unknown in one.unknowns if unknown in gap.unknowns]
        kept = [k for k, unknown in enumerate(one.unknowns) if unknown in gap.unknowns]
        r, J = [], []
        for i, answer in zip(gap.held_out, answers, strict=True):
            computed[i] = gap.corrected(i, answer)
            r.append(gap.residual(i, answer))
            J.append(gap.whitened[i][:, columns])
        if not np.isfinite(np.concatenate(r)).all():
            # The held-out drive is not possible with these values: it rejects them.
            r = [np.full(len(one), 1e3) for one in r]
        log_held, p_held = _predictive(np.concatenate(r), np.vstack(J), one.best.covariance[np.ix_(kept, kept)])
    effective = one.r + one.J @ one.x
    # What the linear model promises is believed of a first fit, which may be carried on; not of one that was.
    doubted = one.promised / 2 if one.matters else 0.0
    return Explained(
        one.members,
        tuple(one.unknowns),
        Fit(one.x, one.best.covariance, one.best.log_evidence, one.best.at_bound, one.best.beyond),
        one.best.log_evidence - float(effective @ effective) / 2 - doubted,
        computed,
        one.misfit(one.r, one.x),
        len(one.r),
        log_held,
        p_held,
        one.steps,
        one.converged,
        effective,
        one.J,
        one,
        gap.settings,
    )


def _predictive(r: Array, J: Array, covariance: Array) -> tuple[float, float]:
    """ln N(r; 0, 1 + J C J^T) up to a constant, and the chi-squared probability of r."""
    spread = np.eye(len(r)) + J @ covariance @ J.T
    root = np.linalg.cholesky(spread)
    z = np.linalg.solve(root, r)
    square = float(z @ z)
    return float(-square / 2 - np.log(np.diag(root)).sum()), float(chi2.sf(square, len(r)))
