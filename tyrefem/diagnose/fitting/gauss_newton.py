"""Fit of one set of effects by Gauss-Newton steps with secant corrections; each step gives a new state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from tyrefem.brief import Brief
from tyrefem.diagnose.inference.evidence import Posterior, posterior
from tyrefem.diagnose.inference.linear_model import LinearModel
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Candidate, Members
from tyrefem.diagnose.unknowns.unknown import Unknown, twins

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FitState(Brief):
    """State of the fit of a set: the linear model r(x') = r - J (x' - x) and the next point to simulate.

    Gauss-Newton within a trust region, a box of ``radius`` prior standard deviations about the last good point. A step
    that makes the fit worse, or leads to an impossible tyre, shrinks the region. The corrected J gives the next step.

    Parameters
    ----------
    members : the set. unknowns : all fitted unknowns (k). shapes : parameters that join the fit with new sensitivities.
    x : (k,) last good point. r : (n,) whitened residuals there. J : (n, k) -dr/dx.
    computed : number of the run -> block means at x. next_point : (k,). posterior : of the linear model about x.
    radius : of the trust region, prior sd. limit : most steps. steps : steps made. tangents : Jacobians still allowed.
    done : the fit has ended. converged : further steps would not reduce the misfit noticeably.
    continuation : the state continues a first fit. jacobian_outdated : J was not taken near x.
    tangents_at : (k,) x where the sensitivities of J were taken; None: unknown.
    pending : unknowns whose sensitivities in J were taken elsewhere, at x = 0.
    needs_tangents : J is needed at x. simulated : x was simulated.
    further : unknowns of other effects -> (n,) whitened -dr/dx, where they were taken at a point of this fit.
    expected, next_jacobian : (n,) residuals at the next point and the linear model there, where they are known better
        than by J; None: by J.
    """

    members: Members
    unknowns: tuple[Unknown, ...]
    shapes: tuple[Unknown, ...]
    settings: DiagnosisSettings
    x: Array
    r: Array
    J: Array
    computed: Mapping[int, Array]
    next_point: Array
    posterior: Posterior
    radius: float
    limit: int
    steps: int = 0
    tangents: int = 0
    done: bool = False
    converged: bool = False
    continuation: bool = False
    jacobian_outdated: bool = False
    needs_tangents: bool = False
    simulated: bool = True
    tangents_at: Array | None = None
    pending: tuple[Unknown, ...] = ()
    further: Mapping[Unknown, Array] = field(default_factory=dict)
    expected: Array | None = None
    next_jacobian: Array | None = None

    @property
    def next_values(self) -> dict[Unknown, float]:
        """Values of the unknowns at the next point."""
        return self.by_unknown(self.next_point)

    @property
    def current_values(self) -> dict[Unknown, float]:
        """Values of the unknowns at the last good point."""
        return self.by_unknown(self.x)

    def by_unknown(self, x: Array) -> dict[Unknown, float]:
        """Unknown -> its value; 1 for effects without amplitude."""
        fixed = [unknown for member in self.members for unknown in member.presence]
        return dict(zip(self.unknowns, (float(value) for value in x), strict=True)) | dict.fromkeys(fixed, 1.0)

    @cached_property
    def prior(self) -> tuple[Array, Array, Array]:
        """Standard deviation, lowest and highest x of the unknowns, (k,) each."""
        limits = np.array([(unknown.sd, unknown.low, unknown.high) for unknown in self.unknowns]).reshape(-1, 3)
        return limits[:, 0], limits[:, 1], limits[:, 2]

    def fitted(self, radius: float = np.inf) -> Posterior:
        """Posterior of the linear model about x, within a box of ``radius`` prior sd about x."""
        sd, low, high = self.prior
        low, high = np.maximum(low, self.x - radius * sd), np.minimum(high, self.x + radius * sd)
        return posterior(self.J.T @ self.J, self.J.T @ (self.r + self.J @ self.x), sd, low, high)

    def best_within(self, data: Array, J: Array, low: Array, high: Array) -> Array:
        """(k,) best point of another linear model data = J x + e, with the unknowns' priors, within a box."""
        return posterior(J.T @ J, J.T @ data, self.prior[0], low, high).mean

    def misfit(self, r: Array, x: Array) -> float:
        """|r|^2 + |x/sd|^2."""
        return float(r @ r + ((x / self.prior[0]) ** 2).sum())

    def _reduction_at(self, x: Array) -> float:
        """Reduction of the misfit at a point, predicted by the linear model."""
        return self.misfit(self.r, self.x) - self.misfit(self.r - self.J @ (x - self.x), x)

    @property
    def predicted_reduction(self) -> float:
        """Largest further reduction of the misfit, predicted by the linear model."""
        return max(self._reduction_at(self.posterior.mean), 0.0)

    @property
    def _may_take_tangents(self) -> bool:
        return self.tangents > 0 and self.steps < self.limit

    @property
    def _misfit_is_improbable(self) -> bool:
        """Whether noise alone would rarely give a misfit this large."""
        return float(chdtrc(len(self.r), self.misfit(self.r, self.x))) < self.settings.doubtful_p

    # -- steps: each returns the next state

    def proposed(self) -> FitState:
        """The state with the next point, or the finished fit."""
        state = replace(
            self, posterior=self.fitted(), next_point=self.fitted(self.radius).mean, expected=None, next_jacobian=None
        )
        if state.predicted_reduction < self.settings.least_reduction:
            return replace(state, done=True, converged=True)
        return replace(state, done=state.done or self.steps >= self.limit or self.radius < self.settings.trust_smallest)

    def expecting(self, next_point: Array, r: Array, J: Array) -> FitState:
        """The state with another next point, at which residuals ``r`` and the linear model ``J`` are expected.

        The fit has converged if little is to be gained there, unless a narrow trust region is the reason.
        """
        state = replace(self, next_point=next_point, expected=r, next_jacobian=J)
        gain = self.misfit(self.r, self.x) - self.misfit(r, next_point)
        if gain >= self.settings.least_reduction or state._limited:
            return state
        return replace(self, done=True, converged=True)._confirmed()

    def rejected(self) -> FitState:
        """The state after a next point at which the tyre is impossible."""
        return replace(self, steps=self.steps + 1, radius=self.settings.trust_shorter * self._reach).proposed()

    @property
    def _near_tangents(self) -> bool:
        """Whether J was taken so near that new tangents would change the ln evidence by less than 0.4."""
        if self.tangents_at is None:
            return False
        return bool(np.abs((self.x - self.tangents_at) / self.prior[0]).max(initial=0.0) <= self.settings.near_tangents)

    @property
    def lacks_tangents(self) -> bool:
        """Whether some sensitivities in J were not taken near x."""
        return self.jacobian_outdated or bool(self.pending)

    @property
    def wanted_tangents(self) -> tuple[Unknown, ...]:
        """The unknowns whose tangents are needed at x."""
        return self.unknowns if self.jacobian_outdated or not self.pending else self.pending

    @property
    def _limited(self) -> bool:
        """Whether the trust region ends the step to the next point."""
        return bool((np.abs(self.next_point - self.x) / self.prior[0] > 0.99 * self.radius).any())

    @property
    def _reach(self) -> float:
        """Largest distance from x to the next point, prior sd."""
        return float(np.abs((self.next_point - self.x) / self.prior[0]).max(initial=0.0))

    def accepted(self, computed: Mapping[int, Array], r: Array) -> FitState:
        """The state after the simulations at the next point: block means by run, and whitened residuals (n,)."""
        settings, sd, reach = self.settings, self.prior[0], self._reach
        step = self.next_point - self.x
        expected = self.r - self.J @ step if self.expected is None else self.expected
        prediction_error = expected - r
        before = self.misfit(self.r, self.x)
        predicted_reduction = before - self.misfit(expected, self.next_point)
        reduction = before - self.misfit(r, self.next_point)
        # Broyden's update: the smallest change of J, in prior sd, that predicts this simulation.
        change = np.zeros_like(self.J)
        if reach > 0:
            change = np.outer(prediction_error, step / sd**2) / float(((step / sd) ** 2).sum())
        state = replace(
            self, J=self.J + change, steps=self.steps + 1, simulated=True, expected=None, next_jacobian=None
        )
        if reduction < 0 and self.simulated:
            state = replace(state, radius=settings.trust_shorter * reach)
            return state._with_tangents() if state.lacks_tangents and state._may_take_tangents else state.proposed()
        limited = self._limited
        radius = self.radius * settings.trust_wider if limited and reduction > predicted_reduction / 2 else self.radius
        J = (self.J if self.next_jacobian is None else self.next_jacobian) + change
        state = replace(state, x=self.next_point, r=r, J=J, computed=dict(computed), radius=radius)
        state = replace(state, jacobian_outdated=self.jacobian_outdated or not state._near_tangents)
        if not self.simulated:
            return state._requesting_tangents(())
        return state._judged(prediction_error, reduction, limited=limited)

    def _judged(self, prediction_error: Array, reduction: float, *, limited: bool) -> FitState:
        """The state after a good step: request of tangents, next point, or end."""
        settings, off = self.settings, float(np.linalg.norm(prediction_error))
        now = self.misfit(self.r, self.x)
        slow = self.continuation and now > max(
            settings.slow_misfit * len(self.r), settings.slow_share * (now + reduction)
        )
        if (self.shapes or off > settings.poor_prediction) and self._may_take_tangents and not slow:
            return self._with_tangents()
        state = self.proposed()
        if not limited and off < settings.close_prediction:
            state = replace(state, done=True, converged=True)
        state = replace(state, done=state.done or slow)
        return state._confirmed()

    def _confirmed(self) -> FitState:
        """The state; with new tangents in place of an end that J may wrongly predict after many secant corrections."""
        ended = self.converged and self.continuation and self.lacks_tangents
        if ended and self._may_take_tangents and self._misfit_is_improbable:
            return replace(self, done=False, converged=False)._with_tangents()
        return self

    def _with_tangents(self) -> FitState:
        return replace(self, tangents=self.tangents - 1)._requesting_tangents(self.shapes)

    def _requesting_tangents(self, shapes: Sequence[Unknown]) -> FitState:
        """The state that needs tangents at x; the shape parameters join the fit because the amplitudes are known."""
        # Where only some sensitivities were taken elsewhere, the others stay.
        partly = bool(self.pending) and not self.jacobian_outdated and self.simulated and not shapes
        return replace(
            self,
            unknowns=(*self.unknowns, *shapes),
            x=np.concatenate([self.x, np.zeros(len(shapes))]),
            shapes=tuple(unknown for unknown in self.shapes if unknown not in shapes),
            jacobian_outdated=False,
            pending=self.pending if partly else (),
            needs_tangents=True,
        )

    def continued(self) -> FitState:
        """The state that continues this fit with new tangents and more steps; x is simulated first if it was not."""
        settings = self.settings
        further = replace(
            self,
            done=False,
            continuation=True,
            tangents=settings.more_tangents - 1,
            limit=self.steps + settings.more_steps,
            radius=max(self.radius, 1.0),
        )
        if not self.simulated:
            return replace(further, next_point=self.x)
        if self.lacks_tangents or self.shapes or self.tangents_at is None:
            return further._requesting_tangents(further.shapes)
        return further.proposed()

    def beside(self, unknowns: Sequence[Unknown], r: Array, J: Array) -> FitState:
        """The state at the same point with further unknowns at 0, beside another covariance of the readings.

        ``r`` (n,), ``J`` (n, k + number of further unknowns): whitened by it. No new tangents are taken.
        """
        further = replace(
            self,
            unknowns=(*self.unknowns, *unknowns),
            x=np.concatenate([self.x, np.zeros(len(unknowns))]),
            r=r,
            J=J,
            done=False,
            converged=False,
            continuation=False,
            tangents=0,
            limit=self.steps + self.settings.beside_steps,
            radius=self.settings.trust,
            simulated=True,
            tangents_at=None,
            pending=(),
            further={},
        )
        return further.proposed()

    def without(self, members: Sequence[Candidate]) -> FitState:
        """The state with effects left out that have amplitudes only: at the same point, predicted with J."""
        left_out = {unknown for member in members for unknown in member.unknowns}
        kept = np.array([unknown not in left_out for unknown in self.unknowns])
        return replace(
            self,
            members=tuple(member for member in self.members if member not in members),
            unknowns=tuple(unknown for unknown in self.unknowns if unknown not in left_out),
            shapes=tuple(unknown for unknown in self.shapes if unknown not in left_out),
            x=self.x[kept],
            r=self.r + self.J[:, ~kept] @ self.x[~kept],
            J=self.J[:, kept],
            tangents_at=None,
            pending=(),
            simulated=False,
        )

    def taken(self, linear: LinearModel, unknowns: Sequence[Unknown]) -> Array:
        """(n, k) whitened -dr/dx over unknowns of other effects: at this fit if they are known there, else at x = 0.

        ``linear``: the linear model about x = 0. `twins` have the sensitivities of their numbers in this fit.
        """
        columns = linear.jacobian[:, linear.design.columns(unknowns)]
        for number, unknown in enumerate(unknowns):
            columns[:, number] = self.further.get(unknown, columns[:, number])
        for number, place in twins(unknowns, self.unknowns).items():
            columns[:, number] = self.J[:, place]
        return columns

    def with_jacobian(self, J: Array) -> FitState:
        """The state after the tangents at x; ``J``: whitened (n, number of `wanted_tangents` unknowns)."""
        if self.wanted_tangents != self.unknowns:
            whole = self.J.copy()
            whole[:, [self.unknowns.index(unknown) for unknown in self.wanted_tangents]] = J
            return replace(self, J=whole, pending=(), needs_tangents=False).proposed()
        return replace(self, J=J, tangents_at=self.x, pending=(), needs_tangents=False).proposed()


def initial_state(
    linear: LinearModel,
    computed: Mapping[int, Array],
    members: Members,
    settings: DiagnosisSettings,
    part: FitState | None = None,
) -> FitState:
    """The initial state of the fit of a set: at x = 0, or at the result of the fit of a subset.

    Parameters
    ----------
    linear : the linear model about x = 0. computed : number of the run -> block means there.
    part : state of the fit of a subset, or of the set itself.
    """
    design = linear.design
    taken = () if part is None else part.members
    new = [member for member in members if member not in taken]
    amplitudes = tuple(unknown for member in new for unknown in member.amplitudes)
    present = [unknown for member in new for unknown in member.presence]
    shapes = tuple(unknown for member in new for unknown in member.shapes)
    further = {} if part is None else part.further
    columns, at_once = (
        linear.jacobian[:, design.columns(each)] if part is None else part.taken(linear, each)
        for each in (amplitudes, present)
    )
    tangents_at: Array | None = None
    pending: tuple[Unknown, ...] = ()
    if part is None:
        unknowns = (*design.unknowns[: design.nuisance], *amplitudes)
        x, r = np.zeros(len(unknowns)), linear.data
        J, tangents_at = np.hstack([linear.jacobian[:, : design.nuisance], columns]), x
    else:
        unknowns = (*part.unknowns, *amplitudes)
        x, r = np.concatenate([part.x, np.zeros(len(amplitudes))]), part.r
        J, computed, shapes = np.hstack([part.J, columns]), part.computed, (*part.shapes, *shapes)
        if part.tangents_at is not None and not part.jacobian_outdated:
            tangents_at = np.concatenate([part.tangents_at, np.zeros(len(amplitudes))])
        known = {*part.further, *(amplitudes[number] for number in twins(amplitudes, part.unknowns))}
        pending = (*part.pending, *(unknown for unknown in amplitudes if unknown not in known))
    r = r - at_once.sum(axis=1)
    empty = Posterior(x, np.zeros((len(x), len(x))), 0.0, np.zeros(len(x), dtype=bool), np.zeros(len(x)))
    # An effect without amplitude changes all sensitivities, so its start is simulated and tangents are taken first.
    state = FitState(
        members, unknowns, shapes, settings, x, r, J, dict(computed), x, empty, settings.trust, settings.first_steps,
        simulated=not present, tangents_at=None if present else tangents_at, pending=pending, further=further,
    )  # fmt: skip
    return state.proposed() if state.simulated else replace(state, posterior=state.fitted())
