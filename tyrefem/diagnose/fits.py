"""Sets of effects fitted to the data with the full model: values, evidence, and how well they predict held-out runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from tyrefem.brief import Brief
from tyrefem.diagnose.candidates import Members
from tyrefem.diagnose.evidence import Posterior
from tyrefem.diagnose.gauss_newton import FitState, begun
from tyrefem.diagnose.linear_model import DesignMatrix, LinearModel
from tyrefem.diagnose.multifidelity import Predictions
from tyrefem.diagnose.residuals import Residuals
from tyrefem.diagnose.unknowns import Unknown

Array = NDArray[np.float64]
Tick = Callable[[], None] | None


@dataclass(frozen=True, eq=False)
class FittedSet(Brief):
    """A set of effects fitted to the data.

    Parameters
    ----------
    members : the set. unknowns : everything fitted. posterior : of these. log_evidence : ln p(fitted data | set).
    computed : trial -> block means of the fitted model, corrected for the mesh. misfit : |r|^2 + |x/sd|^2.
    readings : number of fitted blocks. held_out : ln p(held-out data | fitted data, set), and
        its chi-squared probability ``held_out_p``; NaN where no run is held out.
    linear : model of the fitted trials about the fit, d = J x + e. state : from which the fit can be carried on.
    """

    members: Members
    unknowns: tuple[Unknown, ...]
    posterior: Posterior
    log_evidence: float
    computed: dict[int, Array]
    misfit: float
    readings: int
    held_out: float
    held_out_p: float
    linear: LinearModel
    state: FitState

    @property
    def steps(self) -> int:
        """Simulations."""
        return self.state.steps

    @property
    def converged(self) -> bool:
        """Is nothing to be gained by going on?"""
        return self.state.converged

    @property
    def close(self) -> bool:
        """Not far from a misfit that noise makes: a place to judge larger sets from, and to start them from.

        A fit that has not converged must already fit as well as noise lets the right set.
        """
        settings = self.state.settings
        near = self.misfit < settings.nearly * self.readings
        return near and (self.converged or self.p_value > settings.usual)

    @property
    def finished(self) -> bool:
        """Nothing is gained by going on: converged, with all shape parameters fitted."""
        return self.converged and not self.state.shapes

    @cached_property
    def values(self) -> dict[Unknown, float]:
        """Unknown -> x; 1 for what is simply there."""
        fitted = dict(zip(self.unknowns, (float(x) for x in self.posterior.mean), strict=True))
        return fitted | {unknown: 1.0 for member in self.members for unknown in member.presence}

    @cached_property
    def sd(self) -> dict[Unknown, float]:
        """Unknown -> posterior standard deviation of x."""
        fitted = dict(zip(self.unknowns, (float(x) for x in self.posterior.sd), strict=True))
        return fitted | {unknown: 0.0 for member in self.members for unknown in member.presence}

    @property
    def p_value(self) -> float:
        """Probability of a misfit at least as large, were the model right: chi-squared with one degree per block."""
        return float(chi2.sf(self.misfit, self.readings))

    @property
    def at_bound(self) -> tuple[str, ...]:
        """Keys of the effects' amplitudes that ended on a bound, and that the data want beyond it.

        An emissivity of 0.95 is, in half of all noise, best fitted by 1: that is no sign of another cause.
        """
        amplitudes = {unknown for member in self.members for unknown in member.amplitudes}
        pressed = self.posterior.beyond > self.state.settings.pressed
        return tuple(
            unknown.key for unknown, beyond in zip(self.unknowns, pressed, strict=True)
            if beyond and unknown in amplitudes
        )  # fmt: skip


def first_fits(
    residuals: Residuals,
    predictions: Predictions,
    sets: Sequence[Members],
    starts: Mapping[Members, FittedSet] | None = None,
    tick: Tick = None,
) -> list[FittedSet]:
    """Fit every set with the full model in a few steps; the simulations of all sets are asked for together.

    ``starts``: the fit of a part of a set to begin with; else the study as it is. See `carried_on`.
    """
    parts = {members: fit.state for members, fit in (starts or {}).items()}
    linear = residuals.linear(residuals.fitted)
    computed = {number: residuals.computed[number] for number in residuals.fitted}
    begun_sets = [begun(linear, computed, members, residuals.settings, parts.get(members)) for members in sets]
    return _fitted(residuals, predictions, begun_sets, tick)


def carried_on(
    residuals: Residuals, predictions: Predictions, fits: Sequence[FittedSet], tick: Tick = None
) -> list[FittedSet]:
    """First fits carried on to convergence with tangents at where they are, their shape parameters fitted too."""
    return _fitted(residuals, predictions, [fit.state.carried_on() for fit in fits], tick)


def _fitted(residuals: Residuals, predictions: Predictions, states: Sequence[FitState], tick: Tick) -> list[FittedSet]:
    """The fits taken to their end, step by step side by side."""
    current, numbers = list(states), residuals.fitted
    while active := [place for place, state in enumerate(current) if not state.done]:
        points = [place for place in active if not current[place].wants_tangents]
        questions = [(current[place].members, current[place].point) for place in points]
        for place, answers in zip(points, predictions.predict(questions, numbers, tick), strict=True):
            current[place] = _advanced(residuals, current[place], answers)
        tangents = [place for place in active if current[place].wants_tangents]
        places = [(current[place].members, current[place].unknowns, current[place].place) for place in tangents]
        for place, answers in zip(tangents, predictions.jacobians(places, numbers, tick), strict=True):
            whitened = [residuals.trials[i].whitened(J) for i, J in zip(numbers, answers, strict=True)]
            current[place] = current[place].with_jacobian(np.vstack(whitened))
    return [_concluded(residuals, predictions, state) for state in current]


def _advanced(residuals: Residuals, state: FitState, answers: Sequence[Array]) -> FitState:
    """The fit after the simulations at its next point."""
    if not all(np.isfinite(blocks).all() for blocks in answers):
        # No tyre can be like that.
        return state.refused()
    computed = dict(zip(residuals.fitted, answers, strict=True))
    return state.accepted(computed, np.concatenate([residuals.residual(i, blocks) for i, blocks in computed.items()]))


def _concluded(residuals: Residuals, predictions: Predictions, state: FitState) -> FittedSet:
    """What a fit has come to."""
    computed = {i: residuals.corrected(i, state.computed[i]) for i in residuals.fitted}
    log_held = p_held = math.nan
    if residuals.held_out:
        answers = predictions.predict([(state.members, state.place)], residuals.held_out)[0]
        known = [k for k, unknown in enumerate(state.unknowns) if unknown in residuals.unknowns]
        columns = [residuals.unknowns.index(state.unknowns[k]) for k in known]
        r, J = [], []
        for i, answer in zip(residuals.held_out, answers, strict=True):
            computed[i] = residuals.corrected(i, answer)
            r.append(residuals.residual(i, answer))
            J.append(residuals.whitened[i][:, columns])
        if not np.isfinite(np.concatenate(r)).all():
            # The held-out drive is not possible with these values: it rejects them.
            r = [np.full(len(part), 1e3) for part in r]
        covariance = state.posterior.covariance[np.ix_(known, known)]
        log_held, p_held = _predictive(np.concatenate(r), np.vstack(J), covariance)
    data = state.r + state.J @ state.x
    # What the linear model promises is believed of a first fit, which may be carried on; not of one that was.
    doubted = state.promised / 2 if state.carried else 0.0
    of_linear = state.posterior
    return FittedSet(
        members=state.members,
        unknowns=state.unknowns,
        posterior=Posterior(
            state.x, of_linear.covariance, of_linear.log_evidence, of_linear.at_bound, of_linear.beyond
        ),
        log_evidence=of_linear.log_evidence - float(data @ data) / 2 - doubted,
        computed=computed,
        misfit=state.misfit(state.r, state.x),
        readings=len(state.r),
        held_out=log_held,
        held_out_p=p_held,
        linear=LinearModel(DesignMatrix(state.unknowns, len(state.unknowns), state.J), data),
        state=state,
    )


def _predictive(r: Array, J: Array, covariance: Array) -> tuple[float, float]:
    """ln N(r; 0, 1 + J C J^T) up to a constant, and the chi-squared probability of r."""
    spread = np.eye(len(r)) + J @ covariance @ J.T
    root = np.linalg.cholesky(spread)
    z = np.linalg.solve(root, r)
    square = float(z @ z)
    return float(-square / 2 - np.log(np.diag(root)).sum()), float(chi2.sf(square, len(r)))


def linear_about(residuals: Residuals, fit: FittedSet, unknowns: Sequence[Unknown]) -> LinearModel:
    """The linear model about a fit, with the columns of further unknowns as at x = 0."""
    columns = [residuals.unknowns.index(unknown) for unknown in unknowns]
    further = np.vstack([residuals.whitened[i][:, columns] for i in residuals.fitted])
    jacobian = np.hstack([fit.linear.jacobian, further])
    return LinearModel(DesignMatrix((*fit.unknowns, *unknowns), len(fit.unknowns), jacobian), fit.linear.data)
