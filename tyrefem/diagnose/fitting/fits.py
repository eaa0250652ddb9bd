"""Sets of effects fitted to the data with the full model: values, evidence, and prediction of held-out runs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from tyrefem.brief import Brief
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.fitting.displaced_steps import displaced_steps
from tyrefem.diagnose.fitting.gauss_newton import FitState, initial_state
from tyrefem.diagnose.forward.multifidelity import Predictions
from tyrefem.diagnose.inference.evidence import Posterior
from tyrefem.diagnose.inference.linear_model import DesignMatrix, LinearModel
from tyrefem.diagnose.inference.shared_error import SharedError
from tyrefem.diagnose.unknowns.candidates import Candidate, Members
from tyrefem.diagnose.unknowns.unknown import Unknown, twins

Array = NDArray[np.float64]
Tick = Callable[[], None] | None


@dataclass(frozen=True, eq=False)
class FittedSet(Brief):
    """A set of effects fitted to the data.

    Parameters
    ----------
    members : the set. unknowns : all fitted unknowns. posterior : of the unknowns.
    log_evidence : ln p(fitted data | set).
    computed : number of the run -> block means of the fitted model, corrected for the mesh.
    misfit : |r|^2 + |x/sd|^2. readings : number of fitted blocks.
    held_out, held_out_p : ln p(held-out data | fitted data, set) and its chi-squared probability; NaN if no run is
        held out.
    linear : linear model of the fitted runs about the fit, d = J x + e. state : state from which the fit can continue.
    shared_error : error that readings share, beside which the set was fitted; None: none.
    spread : unknown -> standard deviation of its total that also counts other discrepancy models (`Robustness.spread`).
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
    shared_error: SharedError | None = None
    spread: Mapping[Unknown, float] = field(default_factory=dict)

    @property
    def steps(self) -> int:
        """Number of simulated points."""
        return self.state.steps

    @property
    def converged(self) -> bool:
        """Whether further steps would not reduce the misfit noticeably."""
        return self.state.converged

    @property
    def close(self) -> bool:
        """Whether the set nearly explains the data, so that larger sets can be judged from its fit and start there.

        A fit that has not converged must have a misfit that noise can explain.
        """
        settings = self.state.settings
        near = self.misfit < settings.close_misfit * self.readings
        return near and (self.converged or self.p_value > settings.usual_p)

    @property
    def finished(self) -> bool:
        """Whether the fit has converged with all shape parameters fitted."""
        return self.converged and not self.state.shapes

    @property
    def settled(self) -> bool:
        """Whether the fit has finished with sensitivities taken at its point, on which its evidence rests."""
        return self.finished and not self.state.lacks_tangents

    @property
    def worth_settling(self) -> bool:
        """Whether the fit is not settled, and explains the data well enough to be continued."""
        return not self.settled and self.misfit < self.state.settings.slow_misfit * self.readings

    @property
    def worth_continuing(self) -> bool:
        """Whether further steps may lead a first fit near the data: the misfit that the linear model predicts counts.

        The first steps of a strong effect may still be far off.
        """
        return -2 * self.log_evidence < self.state.settings.continued_misfit * self.readings

    @cached_property
    def values(self) -> dict[Unknown, float]:
        """Unknown -> x; 1 for effects without amplitude."""
        fitted = dict(zip(self.unknowns, (float(x) for x in self.posterior.mean), strict=True))
        return fitted | {unknown: 1.0 for member in self.members for unknown in member.presence}

    @cached_property
    def sd(self) -> dict[Unknown, float]:
        """Unknown -> posterior standard deviation of x; `spread` where it is given."""
        fitted = dict(zip(self.unknowns, (float(x) for x in self.posterior.sd), strict=True))
        return fitted | {unknown: 0.0 for member in self.members for unknown in member.presence} | dict(self.spread)

    def total(self, unknown: Unknown) -> tuple[float, float]:
        """x and standard deviation of the number that a study states: the sum of an unknown and its `twins`.

        The data tell the sum of an effect on a sensor and of the tolerance on its card; each part alone is as uncertain
        as the other's prior. The sum's variance counts their covariance.
        """
        parts = [place for place, each in enumerate(self.unknowns) if each.key == unknown.key]
        if len(parts) < 2:
            return self.values[unknown], self.sd[unknown]
        variance = float(self.posterior.covariance[np.ix_(parts, parts)].sum())
        x = sum(float(self.posterior.mean[place]) for place in parts)
        return x, max(math.sqrt(max(variance, 0.0)), self.spread.get(unknown, 0.0))

    @property
    def totals(self) -> dict[Unknown, tuple[float, float]]:
        """Unknown -> `total`; an unknown of the set's effects stands for its twin."""
        keys = {unknown.key: unknown for member in self.members for unknown in member.unknowns}
        return {unknown: self.total(unknown) for unknown in self.values if keys.get(unknown.key, unknown) == unknown}

    @property
    def p_value(self) -> float:
        """Probability of a misfit at least as large if the model is right: chi-squared with one degree per block."""
        return float(chdtrc(self.readings, self.misfit))

    def without(self, members: Sequence[Candidate]) -> FittedSet:
        """The set with effects left out that have amplitudes only, at the same point: a start for its fit."""
        state = self.state.without(members)
        kept = np.array([unknown in state.unknowns for unknown in self.unknowns])
        design = DesignMatrix(state.unknowns, len(state.unknowns), state.J)
        posterior = Posterior(
            state.x,
            self.posterior.covariance[np.ix_(kept, kept)],
            self.posterior.log_evidence,
            self.posterior.at_bound[kept],
            self.posterior.beyond[kept],
        )
        return replace(
            self,
            members=state.members,
            unknowns=state.unknowns,
            posterior=posterior,
            linear=LinearModel(design, state.r + state.J @ state.x),
            state=state,
        )

    @property
    def at_bound(self) -> tuple[str, ...]:
        """Keys of the effects' amplitudes that end on a bound and whose best value lies clearly beyond it.

        Noise alone can put an amplitude on a bound: an emissivity of 0.95 is often best fitted by 1. Therefore the best
        value must be more than ``DiagnosisSettings.beyond_bound`` standard deviations beyond the bound.
        """
        amplitudes = {unknown for member in self.members for unknown in member.amplitudes}
        beyond_bound = self.posterior.beyond > self.state.settings.beyond_bound
        return tuple(
            unknown.key for unknown, beyond in zip(self.unknowns, beyond_bound, strict=True)
            if beyond and unknown in amplitudes
        )  # fmt: skip


def first_fits(
    residuals: Residuals,
    predictions: Predictions,
    sets: Sequence[Members],
    starts: Mapping[Members, FittedSet] | None = None,
    tick: Tick = None,
) -> list[FittedSet]:
    """Fit every set with the full model in a few steps; the simulations of all sets run in parallel.

    ``starts``: set -> fit of a subset to start from; other sets start from x = 0. See `continued`.
    """
    parts = {members: fit.state for members, fit in (starts or {}).items()}
    linear = residuals.linear(residuals.fitted)
    computed = {number: residuals.computed[number] for number in residuals.fitted}
    states = [initial_state(linear, computed, members, residuals.settings, parts.get(members)) for members in sets]
    return _fitted([(residuals, state) for state in states], predictions, tick)


def continued(
    residuals: Residuals, predictions: Predictions, fits: Sequence[FittedSet], tick: Tick = None
) -> list[FittedSet]:
    """First fits continued to convergence, with new sensitivities at their points and with their shape parameters."""
    return _fitted([(residuals, fit.state.continued()) for fit in fits], predictions, tick)


def with_sensitivities(
    residuals: Residuals, predictions: Predictions, fit: FittedSet, unknowns: Sequence[Unknown], tick: Tick = None
) -> FittedSet:
    """The fit with sensitivities to unknowns of other effects at its point, for sets that are estimated from it.

    Far from x = 0 those taken there are wrong: base numbers that imitate a worn tread leave nothing for it to explain.
    """
    numbers = residuals.fitted
    point = fit.members, tuple(unknowns), fit.state.current_values
    (answers,) = predictions.jacobians([point], numbers, tick)
    # Of an effect that is impossible at this point, columns are not finite: those at x = 0 stay.
    taken = np.all([np.isfinite(J).all(axis=0) for J in answers], axis=0)
    columns = residuals.joined([residuals.runs[i].whitened(J[:, taken]) for i, J in zip(numbers, answers, strict=True)])
    known = dict(zip(itertools.compress(unknowns, taken), columns.T, strict=True))
    return replace(fit, state=replace(fit.state, further={**fit.state.further, **known}))


def fitted_beside(
    predictions: Predictions,
    fits: Sequence[tuple[FittedSet, Residuals]],
    tick: Tick = None,
    members: Members = (),
) -> list[FittedSet]:
    """Fits continued beside other discrepancies: pairs of a fit and of the residuals with a shared error.

    Unknowns that belong to every model of those residuals join the fit, and ``members``, effects with amplitudes. The
    steps take no new sensitivities.
    """
    return _fitted([(residuals, state_beside(residuals, fit, members)) for fit, residuals in fits], predictions, tick)


def state_beside(residuals: Residuals, fit: FittedSet, members: Members = ()) -> FitState:
    """The state of a fit beside a discrepancy, before its first step.

    ``members``: effects with amplitudes that join the set.
    """
    known = set(fit.unknowns)
    joining = (*residuals.unknowns[: residuals.nuisance], *(each for member in members for each in member.amplitudes))
    new = tuple(unknown for unknown in joining if unknown not in known)
    linear = linear_about(residuals, fit, new)
    r = linear.data - linear.jacobian[:, : len(fit.unknowns)] @ fit.posterior.mean
    return replace(fit.state, members=(*fit.members, *members)).beside(new, r, linear.jacobian)


def _fitted(pairs: Sequence[tuple[Residuals, FitState]], predictions: Predictions, tick: Tick) -> list[FittedSet]:
    """The finished fits; each step is made for all sets in parallel. All residuals are of the same runs."""
    residuals, current = [pair[0] for pair in pairs], [pair[1] for pair in pairs]
    while active := [place for place, state in enumerate(current) if not state.done]:
        numbers = residuals[active[0]].fitted
        points = [place for place in active if not current[place].needs_tangents]
        refined = displaced_steps(
            [residuals[place] for place in points], predictions, [current[place] for place in points]
        )
        for place, state in zip(points, refined, strict=True):
            current[place] = state
        points = [place for place in points if not (current[place].done or current[place].needs_tangents)]
        questions = [(current[place].members, current[place].next_values) for place in points]
        for place, answers in zip(points, predictions.predict(questions, numbers, tick), strict=True):
            current[place] = _advanced(residuals[place], current[place], answers)
        tangents = [place for place in active if current[place].needs_tangents and not current[place].done]
        wanted = (current[place] for place in tangents)
        places = [(state.members, state.wanted_tangents, state.current_values) for state in wanted]
        for place, answers in zip(tangents, predictions.jacobians(places, numbers, tick), strict=True):
            runs = residuals[place].runs
            whitened = [runs[i].whitened(J) for i, J in zip(numbers, answers, strict=True)]
            current[place] = current[place].with_jacobian(residuals[place].joined(whitened))
    held_out = residuals[0].held_out if residuals else ()
    questions = [(state.members, state.current_values) for state in current]
    of_held_out = predictions.predict(questions, held_out)
    return [_concluded(*each) for each in zip(residuals, current, of_held_out, strict=True)]


def _advanced(residuals: Residuals, state: FitState, answers: Sequence[Array]) -> FitState:
    """The state after the simulations at the next point."""
    if not all(np.isfinite(blocks).all() for blocks in answers):
        # No tyre is possible with these values.
        return state.rejected()
    computed = dict(zip(residuals.fitted, answers, strict=True))
    return state.accepted(computed, residuals.joined([residuals.residual(i, blocks) for i, blocks in computed.items()]))


def _concluded(residuals: Residuals, state: FitState, held_out: Sequence[Array]) -> FittedSet:
    """The fitted set of a finished state; ``held_out``: its block means of the held-out runs."""
    computed = {i: residuals.corrected(i, state.computed[i]) for i in residuals.fitted}
    log_held = p_held = math.nan
    if residuals.held_out:
        known = [k for k, unknown in enumerate(state.unknowns) if unknown in residuals.unknowns]
        columns = [residuals.unknowns.index(state.unknowns[k]) for k in known]
        r, J = [], []
        for i, answer in zip(residuals.held_out, held_out, strict=True):
            computed[i] = residuals.corrected(i, answer)
            r.append(residuals.residual(i, answer))
            J.append(residuals.whitened[i][:, columns])
        if not np.isfinite(np.concatenate(r)).all():
            # The held-out drive is impossible with these values, so it rejects the set.
            r = [np.full(len(part), 1e3) for part in r]
        covariance = state.posterior.covariance[np.ix_(known, known)]
        rest, slopes, spread = np.concatenate(r), np.vstack(J), np.eye(sum(map(len, r)))
        if shared := residuals.shared_error:
            rest = shared.held_out_from(state.r, rest)
            slopes = shared.held_out_from(state.J[:, known], slopes)
            spread = shared.held_out_covariance
        log_held, p_held = predictive(rest, spread + slopes @ covariance @ slopes.T)
    data = state.r + state.J @ state.x
    # A first fit gets credit for the predicted reduction, because it may be continued; a continued fit does not.
    penalty = state.predicted_reduction / 2 if state.continuation else 0.0
    of_linear = state.posterior
    return FittedSet(
        members=state.members,
        unknowns=state.unknowns,
        posterior=Posterior(
            state.x, of_linear.covariance, of_linear.log_evidence, of_linear.at_bound, of_linear.beyond
        ),
        log_evidence=of_linear.log_evidence - float(data @ data) / 2 - penalty - residuals.log_det,
        computed=computed,
        misfit=state.misfit(state.r, state.x),
        readings=len(state.r),
        held_out=log_held,
        held_out_p=p_held,
        linear=LinearModel(DesignMatrix(state.unknowns, len(state.unknowns), state.J), data),
        state=state,
        shared_error=residuals.shared_error,
    )


def predictive(r: Array, covariance: Array) -> tuple[float, float]:
    """ln N(r; 0, covariance) up to a constant, and the chi-squared probability of r."""
    root = np.linalg.cholesky(covariance)
    z = np.linalg.solve(root, r)
    square = float(z @ z)
    return float(-square / 2 - np.log(np.diag(root)).sum()), float(chdtrc(len(r), square))


def linear_about(residuals: Residuals, fit: FittedSet, unknowns: Sequence[Unknown]) -> LinearModel:
    """The linear model about a fit; the columns of further unknowns are those of the fit if it has them, else at x = 0.

    A shared error of the residuals that the fit was made without is whitened, in place of that of the fit; the offset
    of the residuals is subtracted if the fit has neither.
    """
    columns = [residuals.unknowns.index(unknown) for unknown in unknowns]
    further = np.vstack([residuals.whitened[i][:, columns] for i in residuals.fitted])
    jacobian, data = fit.linear.jacobian, fit.linear.data
    if (shared := residuals.shared_error) is not None:
        further = shared.whitened(further)
        if fit.shared_error is not shared:
            if fit.shared_error is not None:
                jacobian, data = fit.shared_error.colored(jacobian), fit.shared_error.colored(data)
            elif residuals.offset:
                data = data - np.concatenate(
                    [residuals.runs[i].whitened(residuals.offset[i]) for i in residuals.fitted]
                )
            jacobian, data = shared.whitened(jacobian), shared.whitened(data)
    if shared is fit.shared_error:
        for new, unknown in enumerate(unknowns):
            further[:, new] = fit.state.further.get(unknown, further[:, new])
    for new, known in twins(unknowns, fit.unknowns).items():
        further[:, new] = jacobian[:, known]
    return LinearModel(
        DesignMatrix((*fit.unknowns, *unknowns), len(fit.unknowns), np.hstack([jacobian, further])), data
    )
