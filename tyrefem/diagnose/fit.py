"""The full model fitted to the data with sets of effects: Gauss-Newton with secant corrections."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from tyrefem.brief import Brief
from tyrefem.diagnose.evidence import Fit, Members, fit
from tyrefem.diagnose.fitted import Explained, explained
from tyrefem.diagnose.linearised import Gap
from tyrefem.diagnose.unknowns import Unknown

Array = NDArray[np.float64]


class Refinement(Brief):
    """One set on its way: asks for simulations at its `point` and takes what they say.

    Gauss-Newton within a region of trust, a box of so many prior standard deviations about the last good point: a step
    that makes the fit worse, or leads to no possible tyre, shrinks it, and the next is proposed with what was learnt.
    """

    def __init__(self, gap: Gap, members: Members, start: Explained | None = None) -> None:
        self.gap, self.members, self.settings = gap, members, gap.settings
        linear = gap.linear(gap.fitted)
        taken = () if start is None else start.members
        new = [one for one in members if one not in taken]
        own = [one for member in new for one in member.amplitudes]
        self.fixed = [one for member in members for one in member.presence]
        present = [one for member in new for one in member.presence]
        columns = linear.jacobian[:, linear.columns(own)]
        if start is None:
            self.unknowns = [*gap.unknowns[: gap.nuisance], *own]
            self.x, self.r = np.zeros(len(self.unknowns)), linear.data
            self.J = np.hstack([linear.jacobian[:, : gap.nuisance], columns])
            self.computed = {i: gap.computed[i] for i in gap.fitted}
            self.shapes: list[Unknown] = []
        else:
            part = start.refinement
            self.unknowns = [*part.unknowns, *own]
            self.x, self.r = np.concatenate([part.x, np.zeros(len(own))]), part.r
            self.J = np.hstack([part.J, columns])
            self.computed, self.shapes = dict(part.computed), list(part.shapes)
        self.r = self.r - linear.jacobian[:, linear.columns(present)].sum(axis=1)
        self.shapes += [one for member in new for one in member.shapes]
        self.steps, self.radius, self.limit, self.tangents = 0, self.settings.trust, self.settings.first_steps, 0
        self.done, self.converged, self.matters = False, False, False
        #: Whether the tangents are not those of x; whether they are asked for.
        self.moved, self.wants_tangents = False, False
        # What is simply there changes what every unknown does: with it, the start is simulated, tangents taken first.
        self.simulated = not present
        if self.simulated:
            self._propose()
        else:
            self.best, self.trial = self._fitted(), self.x

    @property
    def point(self) -> dict[Unknown, float]:
        return self.named(self.trial)

    def named(self, x: Array) -> dict[Unknown, float]:
        return dict(zip(self.unknowns, (float(one) for one in x), strict=True)) | dict.fromkeys(self.fixed, 1.0)

    @property
    def _prior(self) -> tuple[Array, Array, Array]:
        return tuple(np.array([getattr(one, what) for one in self.unknowns]) for what in ("sd", "low", "high"))  # type: ignore[return-value]

    def _fitted(self, radius: float = np.inf) -> Fit:
        """The linear model about x fitted, within a box about it."""
        sd, low, high = self._prior
        low, high = np.maximum(low, self.x - radius * sd), np.minimum(high, self.x + radius * sd)
        return fit(self.J.T @ self.J, self.J.T @ (self.r + self.J @ self.x), sd, low, high)

    def misfit(self, r: Array, x: Array) -> float:
        return float(r @ r + ((x / self._prior[0]) ** 2).sum())

    def _drop(self, x: Array) -> float:
        """Drop of the misfit that the linear model promises at a point."""
        return self.misfit(self.r, self.x) - self.misfit(self.r - self.J @ (x - self.x), x)

    @property
    def promised(self) -> float:
        """Drop of the misfit that is still to be had, by the linear model."""
        return max(self._drop(self.best.mean), 0.0)

    def _propose(self) -> None:
        """Choose the next point, or end."""
        self.best, self.trial = self._fitted(), self._fitted(self.radius).mean
        if self.promised < self.settings.settled:
            self.done = self.converged = True
        elif self.steps >= self.limit or self.radius < self.settings.trust_smallest:
            self.done = True

    def accept(self, answers: Sequence[Array]) -> None:
        """Take the simulations at the trial point."""
        computed = dict(zip(self.gap.fitted, answers, strict=True))
        sd = self._prior[0]
        step = self.trial - self.x
        reach = float(np.abs(step / sd).max(initial=0.0))
        self.steps += 1
        if not all(np.isfinite(one).all() for one in answers):
            # No tyre can be like that.
            self.radius = self.settings.trust_shorter * reach
            self._propose()
            return
        r = np.concatenate([self.gap.residual(i, computed[i]) for i in self.gap.fitted])
        missed = (self.r - self.J @ step) - r
        promised, gained = self._drop(self.trial), self.misfit(self.r, self.x) - self.misfit(r, self.trial)
        if reach > 0:
            # Broyden: the smallest change of J (in units of the priors) that would have predicted this simulation.
            self.J = self.J + np.outer(missed, step / sd**2) / float(((step / sd) ** 2).sum())
        first, self.simulated = not self.simulated, True
        if gained < 0 and not first:
            self.radius = self.settings.trust_shorter * reach
            self._learn() if self.moved and self._may_learn else self._propose()
            return
        limited = bool((np.abs(step / sd) > 0.99 * self.radius).any())
        if limited and gained > promised / 2:
            self.radius *= self.settings.trust_wider
        self.x, self.r, self.computed, self.moved = self.trial, r, computed, True
        if first:
            self._new_tangents(())
            return
        now = self.misfit(r, self.x)
        slow = self.matters and now > max(self.settings.far_off * len(r), self.settings.slow * (now + gained))
        if (
            (self.shapes or float(np.linalg.norm(missed)) > self.settings.predicted_astray)
            and self._may_learn
            and not slow
        ):
            self._learn()
            return
        self._propose()
        if not limited and np.linalg.norm(missed) < self.settings.predicted_close:
            self.done = self.converged = True
        self.done = self.done or slow
        if self.converged and self.matters and self.moved and self._may_learn and self._poor:
            # Corrected step by step, tangents may say that nothing is left to gain where much is.
            self.done = self.converged = False
            self._learn()

    @property
    def _poor(self) -> bool:
        """Would noise seldom make a misfit like this?"""
        return float(chi2.sf(self.misfit(self.r, self.x), len(self.r))) < self.settings.seldom

    @property
    def _may_learn(self) -> bool:
        return self.tangents > 0 and self.steps < self.limit

    def _learn(self) -> None:
        self.tangents -= 1
        self._new_tangents(self.shapes)

    def _new_tangents(self, shapes: Sequence[Unknown]) -> None:
        """Ask for tangents at this point; with an amplitude at hand, the parameters that shape it are fitted too."""
        self.unknowns = [*self.unknowns, *shapes]
        self.x = np.concatenate([self.x, np.zeros(len(shapes))])
        self.shapes = [one for one in self.shapes if one not in shapes]
        self.moved, self.wants_tangents = False, True

    def carried_on(self) -> Refinement:
        """A fit that begins here with tangents and takes some more steps; this one stays as it is."""
        further = copy.copy(self)
        further.unknowns, further.shapes = list(self.unknowns), list(self.shapes)
        further.computed = dict(self.computed)
        further.done, further.matters = False, True
        further.tangents, further.limit = self.settings.more_tangents - 1, self.steps + self.settings.more_steps
        further.radius = max(self.radius, 1.0)
        further._new_tangents(further.shapes)
        return further

    def take(self, answers: Sequence[Array]) -> None:
        """Take tangents where they are wanted, else the simulations at the trial point."""
        if not self.wants_tangents:
            self.accept(answers)
            return
        trials = self.gap.lab.bench.trials
        self.J = np.vstack([trials[i].whitened(J) for i, J in zip(self.gap.fitted, answers, strict=True)])
        self.wants_tangents = False
        self._propose()


def refined(
    gap: Gap,
    sets: Sequence[Members],
    tick: Callable[[], None] | None = None,
    starts: Mapping[Members, Explained] | None = None,
) -> list[Explained]:
    """Fit every set with the full model; the simulations of all sets are asked for together.

    These are first fits, in few steps: see `polished`. ``starts``: the fit of a part of a set to begin with; else the
    study as it is.
    """
    return _run(gap, [Refinement(gap, members, (starts or {}).get(members)) for members in sets], tick)


def polished(gap: Gap, fits: Sequence[Explained], tick: Callable[[], None] | None = None) -> list[Explained]:
    """First fits carried on to convergence with tangents at where they are, their shape parameters fitted too."""
    return _run(gap, [fit.refinement.carried_on() for fit in fits], tick)


def _run(gap: Gap, running: Sequence[Refinement], tick: Callable[[], None] | None) -> list[Explained]:
    predicted, fitted = gap.predicted, gap.fitted
    while active := [one for one in running if not one.done]:
        for tangents in (False, True):
            asking = [one for one in active if one.wants_tangents == tangents]
            answers = (
                predicted.jacobians(
                    [(one.members, tuple(one.unknowns), one.named(one.x)) for one in asking], fitted, tick
                )
                if tangents
                else predicted.predict([(one.members, one.point) for one in asking], fitted, tick)
            )
            for one, own in zip(asking, answers, strict=True):
                one.take(own)
    return [explained(gap, one) for one in running]
