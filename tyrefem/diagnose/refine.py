"""The full model fitted to the data with sets of effects: Gauss-Newton with secant corrections."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from tyrefem.diagnose.evidence import Linear, Members
from tyrefem.diagnose.gauss import Fit, fit
from tyrefem.diagnose.laboratory import Laboratory, Response
from tyrefem.diagnose.unknowns import Unknown

Array = NDArray[np.float64]
#: The prediction of the linear model is good enough when it misses the simulation by this much (whitened norm); far
#: enough off to take new tangents when it misses it by the second.
CLOSE, ASTRAY = 1.0, 6.0
#: A fit has converged when the linear model about it promises no more than this drop of the misfit.
SETTLED = 0.5
#: A fit with a misfit of so many times the number of readings nearly explains them.
NEARLY = 1.3
#: With more than the first the fit is given up when a step leaves more than the second of the misfit.
FAR_OFF, SLOW = 3.0, 0.9
FIRST_STEPS, MORE_STEPS, MORE_TANGENTS = 4, 14, 4
#: Trust: no unknown moves by more than so many prior sd in the first step; a step that fails leaves this much of itself
#: as the next radius, a good one widens it; below the last the fit stays where it is.
RADIUS, SHORTER, WIDER, TINY = 3.0, 0.4, 2.0, 0.01


@dataclass(frozen=True, eq=False)
class Gap:
    """What is measured minus what the study says, and how it changes with every unknown.

    Parameters
    ----------
    lab : simulates. unknowns : nuisance first. nuisance : how many belong to every model.
    correction : per trial, what the study's own mesh adds to the coarse one. jacobians : per trial (n_blocks, k).
    responses : what these were sampled from; of use for other data at the same drives.
    """

    lab: Laboratory
    unknowns: tuple[Unknown, ...]
    nuisance: int
    correction: tuple[Array, ...]
    computed: tuple[Array, ...]
    jacobians: tuple[Array, ...]
    responses: tuple[Response, ...] = ()

    @property
    def fitted(self) -> list[int]:
        """Numbers of the trials that are fitted."""
        return [i for i, one in enumerate(self.lab.bench.trials) if not one.hold_out]

    @property
    def held_out(self) -> list[int]:
        """Numbers of the trials that are held out."""
        return [i for i, one in enumerate(self.lab.bench.trials) if one.hold_out]

    @cached_property
    def _start(self) -> tuple[float, ...]:
        bench = self.lab.bench
        return tuple(bench.driven(bench.study, i).card.drive.initial for i in range(len(bench.trials)))

    def corrected(self, number: int, computed: Array) -> Array:
        """Lean block means of a trial with what the study's own mesh adds.

        That was found at x = 0; the error of a mesh grows with the rise above the start, so it is scaled by the rises.
        """
        start, own = self._start[number], self.computed[number]
        rise = own - start
        ratio = np.where(np.abs(rise) > 1.0, (computed - start) / np.where(rise == 0, 1.0, rise), 1.0)
        return np.asarray(computed + self.correction[number] * np.clip(ratio, 0.2, 5.0))

    def residual(self, number: int, computed: Array) -> Array:
        """Whitened measured - computed of one trial, from lean block means."""
        trial = self.lab.bench.trials[number]
        return trial.whitened(trial.measured - self.corrected(number, computed))

    @cached_property
    def whitened(self) -> tuple[Array, ...]:
        """Whitened jacobian of every trial."""
        return tuple(one.whitened(J) for one, J in zip(self.lab.bench.trials, self.jacobians, strict=True))

    def linear(self, trials: Sequence[int]) -> Linear:
        """The linear model of some trials about x = 0."""
        data = np.concatenate([self.residual(i, self.computed[i]) for i in trials])
        return Linear(self.unknowns, self.nuisance, data, np.vstack([self.whitened[i] for i in trials]))


@dataclass(frozen=True, eq=False)
class Explained:
    """A set of effects fitted to the data.

    Parameters
    ----------
    members : the set. unknowns : everything fitted. fit : posterior. log_evidence : ln p(fitted data | set).
    computed : trial -> block means of the fitted model, corrected for the mesh. misfit : |r|^2 + |x/sd|^2.
    readings : number of fitted blocks. held_out : ln p(held-out data | fitted data, set). steps : simulations.
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
    refinement: _Refinement

    @property
    def close(self) -> bool:
        """Converged, and not far from a misfit that noise makes: a place to start a larger set from."""
        return self.converged and self.misfit < NEARLY * self.readings

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
        """Keys of the effects' amplitudes that ended on a bound."""
        own = {one for member in self.members for one in member.amplitudes}
        return tuple(one.key for one, held in zip(self.unknowns, self.fit.at_bound, strict=True) if held and one in own)


class _Refinement:
    """One set on its way: asks for simulations at its `point` and takes what they say.

    Gauss-Newton within a region of trust, a box of so many prior standard deviations about the last good point: a step
    that makes the fit worse, or leads to no possible tyre, shrinks it, and the next is proposed with what was learnt.
    """

    def __init__(self, gap: Gap, members: Members, start: Explained | None = None) -> None:
        self.gap, self.members = gap, members
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
        self.steps, self.radius, self.limit, self.tangents = 0, RADIUS, FIRST_STEPS, 0
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
        return self._named(self.trial)

    def _named(self, x: Array) -> dict[Unknown, float]:
        return dict(zip(self.unknowns, (float(one) for one in x), strict=True)) | dict.fromkeys(self.fixed, 1.0)

    @property
    def _prior(self) -> tuple[Array, Array, Array]:
        return tuple(np.array([getattr(one, what) for one in self.unknowns]) for what in ("sd", "low", "high"))  # type: ignore[return-value]

    def _fitted(self, radius: float = np.inf) -> Fit:
        """The linear model about x fitted, within a box about it."""
        sd, low, high = self._prior
        low, high = np.maximum(low, self.x - radius * sd), np.minimum(high, self.x + radius * sd)
        return fit(self.J.T @ self.J, self.J.T @ (self.r + self.J @ self.x), sd, low, high)

    def _misfit(self, r: Array, x: Array) -> float:
        return float(r @ r + ((x / self._prior[0]) ** 2).sum())

    def _drop(self, x: Array) -> float:
        """Drop of the misfit that the linear model promises at a point."""
        return self._misfit(self.r, self.x) - self._misfit(self.r - self.J @ (x - self.x), x)

    @property
    def promised(self) -> float:
        """Drop of the misfit that is still to be had, by the linear model."""
        return max(self._drop(self.best.mean), 0.0)

    def _propose(self) -> None:
        """Choose the next point, or end."""
        self.best, self.trial = self._fitted(), self._fitted(self.radius).mean
        if self.promised < SETTLED:
            self.done = self.converged = True
        elif self.steps >= self.limit or self.radius < TINY:
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
            self.radius = SHORTER * reach
            self._propose()
            return
        r = np.concatenate([self.gap.residual(i, computed[i]) for i in self.gap.fitted])
        missed = (self.r - self.J @ step) - r
        promised, gained = self._drop(self.trial), self._misfit(self.r, self.x) - self._misfit(r, self.trial)
        if reach > 0:
            # Broyden: the smallest change of J (in units of the priors) that would have predicted this simulation.
            self.J = self.J + np.outer(missed, step / sd**2) / float(((step / sd) ** 2).sum())
        first, self.simulated = not self.simulated, True
        if gained < 0 and not first:
            self.radius = SHORTER * reach
            self._learn() if self.moved and self._may_learn else self._propose()
            return
        limited = bool((np.abs(step / sd) > 0.99 * self.radius).any())
        if limited and gained > promised / 2:
            self.radius *= WIDER
        self.x, self.r, self.computed, self.moved = self.trial, r, computed, True
        if first:
            self._new_tangents(())
            return
        now = self._misfit(r, self.x)
        slow = self.matters and now > max(FAR_OFF * len(r), SLOW * (now + gained))
        if (self.shapes or float(np.linalg.norm(missed)) > ASTRAY) and self._may_learn and not slow:
            self._learn()
            return
        self._propose()
        if not limited and np.linalg.norm(missed) < CLOSE:
            self.done = self.converged = True
        self.done = self.done or slow

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

    def go_on(self) -> None:
        """Take tangents here and some more steps; for a fit that matters and has not converged."""
        self.done, self.matters = False, True
        self.tangents, self.limit, self.radius = MORE_TANGENTS - 1, self.steps + MORE_STEPS, max(self.radius, 1.0)
        self._new_tangents(self.shapes)

    def questions(self) -> tuple[str, list[tuple[Any, ...]]]:
        """The method of the bench to ask, and with what."""
        fitted = self.gap.fitted
        if self.wants_tangents:
            return "jacobian", [(i, tuple(self.unknowns), self._named(self.x)) for i in fitted]
        return "predict", [(i, self.point) for i in fitted]

    def take(self, answers: Sequence[Array]) -> None:
        """Take the answers to `questions`."""
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
    return _run(gap, [_Refinement(gap, members, (starts or {}).get(members)) for members in sets], tick)


def polished(gap: Gap, fits: Sequence[Explained], tick: Callable[[], None] | None = None) -> list[Explained]:
    """First fits carried on to convergence with tangents at where they are, their shape parameters fitted too."""
    for one in fits:
        one.refinement.go_on()
    return _run(gap, [one.refinement for one in fits], tick)


def _run(gap: Gap, running: Sequence[_Refinement], tick: Callable[[], None] | None) -> list[Explained]:
    while active := [one for one in running if not one.done]:
        for method in ("predict", "jacobian"):
            asking = [one for one in active if one.questions()[0] == method]
            answers = gap.lab.ask(method, [each for one in asking for each in one.questions()[1]], tick)
            width = len(gap.fitted)
            for number, one in enumerate(asking):
                one.take(answers[number * width : (number + 1) * width])
    return [_explained(gap, one) for one in running]


def _explained(gap: Gap, one: _Refinement) -> Explained:
    values = one._named(one.x)
    computed = {i: gap.corrected(i, one.computed[i]) for i in gap.fitted}
    log_held, p_held = 0.0, 1.0
    if gap.held_out:
        answers = gap.lab.ask("predict", [(i, values) for i in gap.held_out])
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
        Fit(one.x, one.best.covariance, one.best.log_evidence, one.best.at_bound),
        one.best.log_evidence - float(effective @ effective) / 2 - doubted,
        computed,
        one._misfit(one.r, one.x),
        len(one.r),
        log_held,
        p_held,
        one.steps,
        one.converged,
        effective,
        one.J,
        one,
    )


def _predictive(r: Array, J: Array, covariance: Array) -> tuple[float, float]:
    """ln N(r; 0, 1 + J C J^T) up to a constant, and the chi-squared probability of r."""
    spread = np.eye(len(r)) + J @ covariance @ J.T
    root = np.linalg.cholesky(spread)
    z = np.linalg.solve(root, r)
    square = float(z @ z)
    return float(-square / 2 - np.log(np.diag(root)).sum()), float(chi2.sf(square, len(r)))
