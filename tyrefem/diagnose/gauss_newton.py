"""One set of effects on its way to the best fit: Gauss-Newton with secant corrections, each step a new state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from tyrefem.brief import Brief
from tyrefem.diagnose.candidates import Members
from tyrefem.diagnose.evidence import Posterior, posterior
from tyrefem.diagnose.linear_model import LinearModel
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns import Unknown

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FitState(Brief):
    """Where the fit of a set stands: r(x') = r - J (x' - x), and the point that is to be simulated next.

    Gauss-Newton within a trust region, a box of so many prior standard deviations about the last good point. A step
    that makes the fit worse, or leads to no possible tyre, shrinks it, and the next is proposed with what was learnt.

    Parameters
    ----------
    members : the set. unknowns : everything fitted (k). shapes : parameters that are fitted once tangents are taken.
    x : (k,) last good point. r : (n,) whitened residuals there. J : (n, k) -dr/dx.
    computed : trial -> block means there. trial : (k,) next point. posterior : of the linear model about x.
    radius : of the trust region, prior sd. limit : steps at most. steps, tangents : made; still allowed.
    done, converged : nothing more is asked for; because nothing is to be gained. carried : after a first fit.
    moved : J was not taken at x. wants_tangents : J is asked for at x. simulated : x was simulated.
    """

    members: Members
    unknowns: tuple[Unknown, ...]
    shapes: tuple[Unknown, ...]
    settings: DiagnosisSettings
    x: Array
    r: Array
    J: Array
    computed: Mapping[int, Array]
    trial: Array
    posterior: Posterior
    radius: float
    limit: int
    steps: int = 0
    tangents: int = 0
    done: bool = False
    converged: bool = False
    carried: bool = False
    moved: bool = False
    wants_tangents: bool = False
    simulated: bool = True

    @property
    def point(self) -> dict[Unknown, float]:
        """Values of the unknowns where the next simulation is."""
        return self.named(self.trial)

    @property
    def place(self) -> dict[Unknown, float]:
        """Values of the unknowns at the last good point."""
        return self.named(self.x)

    def named(self, x: Array) -> dict[Unknown, float]:
        """Unknown -> its value; 1 for what is simply there."""
        fixed = [unknown for member in self.members for unknown in member.presence]
        return dict(zip(self.unknowns, (float(value) for value in x), strict=True)) | dict.fromkeys(fixed, 1.0)

    @cached_property
    def _prior(self) -> tuple[Array, Array, Array]:
        limits = np.array([(unknown.sd, unknown.low, unknown.high) for unknown in self.unknowns]).reshape(-1, 3)
        return limits[:, 0], limits[:, 1], limits[:, 2]

    def fitted(self, radius: float = np.inf) -> Posterior:
        """The linear model about x fitted, within a box about it."""
        sd, low, high = self._prior
        low, high = np.maximum(low, self.x - radius * sd), np.minimum(high, self.x + radius * sd)
        return posterior(self.J.T @ self.J, self.J.T @ (self.r + self.J @ self.x), sd, low, high)

    def misfit(self, r: Array, x: Array) -> float:
        """|r|^2 + |x/sd|^2."""
        return float(r @ r + ((x / self._prior[0]) ** 2).sum())

    def _drop(self, x: Array) -> float:
        """Drop of the misfit that the linear model promises at a point."""
        return self.misfit(self.r, self.x) - self.misfit(self.r - self.J @ (x - self.x), x)

    @property
    def promised(self) -> float:
        """Drop of the misfit that is still to be had, by the linear model."""
        return max(self._drop(self.posterior.mean), 0.0)

    @property
    def _may_learn(self) -> bool:
        return self.tangents > 0 and self.steps < self.limit

    @property
    def _poor(self) -> bool:
        """Would noise seldom make a misfit like this?"""
        return float(chi2.sf(self.misfit(self.r, self.x), len(self.r))) < self.settings.seldom

    # -- steps: each gives the next state

    def proposed(self) -> FitState:
        """The next point chosen, or the fit at its end."""
        state = replace(self, posterior=self.fitted(), trial=self.fitted(self.radius).mean)
        if state.promised < self.settings.settled:
            return replace(state, done=True, converged=True)
        return replace(state, done=state.done or self.steps >= self.limit or self.radius < self.settings.trust_smallest)

    def refused(self) -> FitState:
        """After a point at which no tyre can be."""
        return replace(self, steps=self.steps + 1, radius=self.settings.trust_shorter * self._reach).proposed()

    @property
    def _reach(self) -> float:
        """How far the next point is, prior sd."""
        return float(np.abs((self.trial - self.x) / self._prior[0]).max(initial=0.0))

    def accepted(self, computed: Mapping[int, Array], r: Array) -> FitState:
        """After the simulations at the next point: block means by trial, and whitened residuals (n,)."""
        settings, sd, reach = self.settings, self._prior[0], self._reach
        step = self.trial - self.x
        missed = (self.r - self.J @ step) - r
        promised, gained = self._drop(self.trial), self.misfit(self.r, self.x) - self.misfit(r, self.trial)
        J = self.J
        if reach > 0:
            # Broyden: the smallest change of J (in units of the priors) that would have predicted this simulation.
            J = J + np.outer(missed, step / sd**2) / float(((step / sd) ** 2).sum())
        state = replace(self, J=J, steps=self.steps + 1, simulated=True)
        if gained < 0 and self.simulated:
            state = replace(state, radius=settings.trust_shorter * reach)
            return state._with_tangents() if state.moved and state._may_learn else state.proposed()
        limited = bool((np.abs(step / sd) > 0.99 * self.radius).any())
        radius = self.radius * settings.trust_wider if limited and gained > promised / 2 else self.radius
        state = replace(state, x=self.trial, r=r, computed=dict(computed), moved=True, radius=radius)
        if not self.simulated:
            return state._asking_tangents(())
        return state._judged(missed, gained, limited=limited)

    def _judged(self, missed: Array, gained: float, *, limited: bool) -> FitState:
        """After a good step: new tangents, the next point, or the end."""
        settings, off = self.settings, float(np.linalg.norm(missed))
        now = self.misfit(self.r, self.x)
        slow = self.carried and now > max(settings.far_off * len(self.r), settings.slow * (now + gained))
        if (self.shapes or off > settings.predicted_astray) and self._may_learn and not slow:
            return self._with_tangents()
        state = self.proposed()
        if not limited and off < settings.predicted_close:
            state = replace(state, done=True, converged=True)
        state = replace(state, done=state.done or slow)
        if state.converged and state.carried and state.moved and state._may_learn and state._poor:
            # Corrected step by step, tangents may say that nothing is left to gain where much is.
            return replace(state, done=False, converged=False)._with_tangents()
        return state

    def _with_tangents(self) -> FitState:
        return replace(self, tangents=self.tangents - 1)._asking_tangents(self.shapes)

    def _asking_tangents(self, shapes: Sequence[Unknown]) -> FitState:
        """Ask for tangents at this point; with an amplitude at hand, the parameters that shape it are fitted too."""
        return replace(
            self,
            unknowns=(*self.unknowns, *shapes),
            x=np.concatenate([self.x, np.zeros(len(shapes))]),
            shapes=tuple(unknown for unknown in self.shapes if unknown not in shapes),
            moved=False,
            wants_tangents=True,
        )

    def carried_on(self) -> FitState:
        """A fit that begins here with tangents and takes some more steps."""
        settings = self.settings
        further = replace(
            self,
            done=False,
            carried=True,
            tangents=settings.more_tangents - 1,
            limit=self.steps + settings.more_steps,
            radius=max(self.radius, 1.0),
        )
        return further._asking_tangents(further.shapes)

    def with_jacobian(self, J: Array) -> FitState:
        """After tangents at x: whitened (n, k)."""
        return replace(self, J=J, wants_tangents=False).proposed()


def begun(
    linear: LinearModel,
    computed: Mapping[int, Array],
    members: Members,
    settings: DiagnosisSettings,
    part: FitState | None = None,
) -> FitState:
    """The fit of a set at its beginning: at x = 0, or where the fit of a part of the set has come to.

    Parameters
    ----------
    linear : the linear model about x = 0. computed : block means there, by trial.
    """
    design = linear.design
    taken = () if part is None else part.members
    new = [member for member in members if member not in taken]
    amplitudes = tuple(unknown for member in new for unknown in member.amplitudes)
    present = [unknown for member in new for unknown in member.presence]
    shapes = tuple(unknown for member in new for unknown in member.shapes)
    columns = linear.jacobian[:, design.columns(amplitudes)]
    if part is None:
        unknowns = (*design.unknowns[: design.nuisance], *amplitudes)
        x, r = np.zeros(len(unknowns)), linear.data
        J = np.hstack([linear.jacobian[:, : design.nuisance], columns])
    else:
        unknowns = (*part.unknowns, *amplitudes)
        x, r = np.concatenate([part.x, np.zeros(len(amplitudes))]), part.r
        J, computed, shapes = np.hstack([part.J, columns]), part.computed, (*part.shapes, *shapes)
    r = r - linear.jacobian[:, design.columns(present)].sum(axis=1)
    empty = Posterior(x, np.zeros((len(x), len(x))), 0.0, np.zeros(len(x), dtype=bool), np.zeros(len(x)))
    # What is simply there changes what every unknown does: with it, the start is simulated, tangents taken first.
    state = FitState(
        members, unknowns, shapes, settings, x, r, J, dict(computed), x, empty, settings.trust, settings.first_steps,
        simulated=not present,
    )  # fmt: skip
    return state.proposed() if state.simulated else replace(state, posterior=state.fitted())
