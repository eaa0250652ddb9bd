"""Sets of effects ranked again beside a discrepancy model: the leading ones are fitted with its unknowns."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.special import expit

from tyrefem.brief import Brief
from tyrefem.diagnose.beside.discrepancy import (
    Discrepancy,
)
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.fitting.fits import FittedSet, continued, first_fits, fitted_beside, linear_about, state_beside
from tyrefem.diagnose.fitting.gauss_newton import FitState, initial_state
from tyrefem.diagnose.fitting.selection import ScoredSet, SelectionProblem, rivals_of_names
from tyrefem.diagnose.inference.linear_model import LinearModel
from tyrefem.diagnose.inference.set_evidences import SetEvidences
from tyrefem.diagnose.unknowns.candidates import Candidate, Members, separate

#: A set whose linear estimate is this far below the best is not fitted beside a discrepancy, nats.
FAR = 60.0
#: A fit with half waves beyond so many prior standard deviations asks for wider priors; fits that are continued there.
STRAIN, RENEWED = 2.5, 2
#: So many rivals of the best set have their fits continued to convergence.
UNFINISHED = 2
#: A strain law whose fits keep a misfit above this times the number of readings is not searched for further sets.
NEAR = 10.0
#: Sensitivities are taken again where a fit has changed the readings by more than this share of their rise.
CHANGED = 0.15
#: Beside a discrepancy of this size noise explains the misfit, so that no larger one is tried.
USUAL_P = 0.01


@dataclass(eq=False)
class RankedBeside(Brief):
    """Sets beside one discrepancy model: those fitted beside it, and estimates ln(prior) + ln evidence of others.

    ``open``: effects that may be named; if there are any, of the sets with all of them only the best one is fitted.
    ``left_out``: effects that do not compete. ``renewed``: residuals with sensitivities to effects at the best fit, if
    they were taken.
    """

    problem: SelectionProblem
    discrepancy: Discrepancy
    open: Members = ()
    left_out: Members = ()
    fits: dict[Members, FittedSet] = field(default_factory=dict)
    estimates: dict[Members, float] = field(default_factory=dict)
    renewed: Residuals | None = None

    def _title(self) -> str:
        return f"{self.discrepancy.name}, {len(self.fits)} fits"

    @property
    def residuals(self) -> Residuals:
        """The residuals beside the discrepancy."""
        return self.renewed or self._at_origin

    @functools.cached_property
    def candidates(self) -> Members:
        """The effects that compete: those that the discrepancy does not allow for by itself."""
        further = set(self.discrepancy.further)
        competing = (each for each in self.problem.candidates if each not in self.left_out)
        return tuple(each for each in competing if not further & set(each.unknowns))

    @functools.cached_property
    def _at_origin(self) -> Residuals:
        of = self.discrepancy
        return self.problem.residuals.beside(of.nuisance, of.shared_error, of.offset)

    @property
    def best(self) -> FittedSet:
        """The fitted set with the highest score."""
        return self.fits[max(self.fits, key=self.score)]

    @property
    def strained(self) -> bool:
        """Whether the best fit needs much more of the discrepancy than its prior expects."""
        fit, nuisance = self.best, set(self.discrepancy.nuisance)
        return any(abs(fit.values[unknown]) > STRAIN * unknown.sd for unknown in fit.unknowns if unknown in nuisance)

    @property
    def far(self) -> bool:
        """Whether the fits lie far from the study, where sensitivities differ from those at x = 0: priors are wide."""
        return self._by_itself and self.discrepancy.width > 1.0

    @property
    def _by_itself(self) -> bool:
        """Whether the discrepancy has unknowns, and no errors of the readings."""
        return bool(self.discrepancy.nuisance) and self.discrepancy.size == 0.0

    @property
    def change(self) -> float:
        """Root mean square of what the best fit has changed in the readings, as a share of that of their rise."""
        before = [self.residuals.computed[number] for number in self.residuals.fitted]
        after = [self.best.computed[number] for number in self.residuals.fitted]
        change = np.concatenate([(there - here).ravel() for there, here in zip(after, before, strict=True)])
        rise = np.concatenate([(here - np.min(here)).ravel() for here in before])
        return float(np.linalg.norm(change) / np.linalg.norm(rise))

    @property
    def near(self) -> bool:
        """Whether some fit is so near the data that other sets may explain them; else the discrepancy is refuted."""
        fit = min(self.fits.values(), key=lambda fit: fit.misfit)
        return fit.misfit < NEAR * fit.readings

    def score(self, members: Members) -> float:
        """ln(prior) + ln evidence of a fitted set."""
        return self.problem.prior(members) + self.fits[members].log_evidence

    @property
    def p_value(self) -> float:
        """Largest probability of the misfit of a fitted set."""
        return max((fit.p_value for fit in self.fits.values()), default=0.0)

    def begin(self, fits: Mapping[Members, FittedSet], most: int | None = None) -> None:
        """Fit the leading sets beside the discrepancy, from their fits without it; no effect first.

        ``most``: largest number of leading sets; default: as in the settings.
        """
        residuals, problem = self.residuals, self.problem
        estimates = {
            members: problem.prior(members) + evidence(state_beside(residuals, fit), residuals.log_det)
            for members, fit in fits.items()
            if set(members) <= set(self.candidates)
        }
        # Without the discrepancy, the fit of no effect may have distorted base numbers.
        linear = residuals.linear(residuals.fitted)
        computed = {number: residuals.computed[number] for number in residuals.fitted}
        origin = initial_state(linear, computed, (), residuals.settings)
        of_origin = problem.prior(()) + evidence(origin, residuals.log_det)
        from_origin = of_origin > estimates.get((), -math.inf)
        estimates[()] = max(of_origin, estimates.get((), -math.inf))
        ahead = sorted(estimates, key=lambda members: -estimates[members])
        near = [members for members in ahead if estimates[members] > estimates[ahead[0]] - FAR]
        chosen = self._deciding(near)[: most or residuals.settings.beside_sets]
        if () not in chosen:
            chosen.append(())
        restarted = [()] if from_origin else []
        self._take(
            fitted_beside(
                problem.predictions,
                [(fits[members], residuals) for members in chosen if members not in restarted],
                problem._count,
            )
        )
        self._take(first_fits(residuals, problem.predictions, restarted, None, problem._count))
        self.estimates |= {members: value for members, value in estimates.items() if members not in self.fits}
        if self.far and self.renewed is None:
            self._renew()
        self._estimate()
        if self.p_value <= USUAL_P:
            self._continue_ended(parts=False)

    def _renew(self) -> None:
        """Continue the best fits with sensitivities at their points; take those of all effects at the best one."""
        problem = self.problem
        leading = sorted(self.fits, key=self.score)[-RENEWED:]
        self._take(
            continued(self.residuals, problem.predictions, [self.fits[part] for part in leading], problem._count)
        )
        unknowns = [unknown for each in self.candidates for unknown in (*each.amplitudes, *each.presence)]
        point = problem.ordered(self.best.members), tuple(unknowns), self.best.state.current_values
        numbers = self.residuals.fitted
        (columns,) = problem.predictions.jacobians([point], numbers, problem._count)
        sensitive = self.residuals.sensitivities.with_columns(unknowns, dict(zip(numbers, columns, strict=True)))
        self.renewed = replace(self.residuals, sensitivities=sensitive)

    def further(self) -> None:
        """Fit the best estimated sets and estimate from them: twice, and once more if a better one was found last.

        Rivals of the best set are then continued; if one of them gets ahead, once more. At last every effect that
        would be named is held against the best set without it.

        Estimates from sensitivities at x = 0 do not count where the fits have changed the readings much: beside energy
        modes of 26 % that of a tread's slip was 20 nats below its fit.
        """
        if self._by_itself and self.renewed is None and self.near and self.change > CHANGED:
            self._renew()
            self.estimates.clear()
            self._estimate()
        self._search()
        leading = self.best.members
        if self._continue_ended() and self.best.members != leading:
            self._search()
        for _ in range(self.problem.settings.name_rounds):
            leading = self.best.members
            starts = rivals_of_names(self.scored(), self.problem.settings)
            starts = {members: start or self._start(members) for members, start in starts.items()}
            known = {members: start for members, start in starts.items() if start is not None}
            if not known:
                break
            self._take(first_fits(self.residuals, self.problem.predictions, list(known), known, self.problem._count))
            self._estimate()
            if self.best.members != leading:
                self._search()

    def _continue_ended(self, *, parts: bool = True) -> bool:
        """Continue fits that ended on their way: the best one, no effect, and the best one's parts.

        A set that is far from its own best point does not show that the data ask for another effect. The parts begin
        where the best fit ends; the best fit without a member counts as one. True if there were any.
        """
        best = self.best
        to_end = {self.problem.ordered(best.members), ()}
        ended = self._hidden_rivals() if parts else []
        for member in best.members if parts else ():
            to_end.add(max((members for members in self.fits if member not in members), key=self.score, default=()))
            part = self.fits.get(tuple(each for each in self.problem.ordered(best.members) if each != member))
            if not member.presence and (part is None or not is_good(part)):
                ended.append(best.without([member]))
        # A part that begins where the best fit ends needs no second start.
        to_end -= {self.problem.ordered(fit.members) for fit in ended}
        ended += [self.fits[members] for members in to_end if members in self.fits and not is_good(self.fits[members])]
        if parts:
            ended += [fit for fit in self._unfinished_rivals() if fit not in ended]
        if not ended:
            return False
        self._take(continued(self.residuals, self.problem.predictions, ended, self.problem._count))
        self._estimate()
        return True

    def _unfinished_rivals(self) -> list[FittedSet]:
        """The best sets that lack an effect of the best one and whose fits have not converged.

        Noise may explain what such a fit leaves while its best point is far better: two swapped channels had ended 100
        above the misfit of a displaced thermocouple that imitates them.
        """
        best, top = set(self.best.members), self.score(self.problem.ordered(self.best.members))
        unfinished = [
            members
            for members, fit in self.fits.items()
            if members and not fit.converged and not best <= set(members) and self.score(members) > top - FAR
        ]
        return [self.fits[members] for members in sorted(unfinished, key=self.score)[-UNFINISHED:]]

    def _hidden_rivals(self) -> list[FittedSet]:
        """Starts for sets near the best one whose own fits ended far from their best points.

        A leading fit shows it: without one of its effects, its linear model predicts a score that is more than
        ``near_score`` above that of the set's own fit.
        """
        settings, top = self.problem.settings, max(map(self.score, self.fits))
        starts: dict[Members, tuple[float, FittedSet]] = {}
        for members, fit in self.fits.items():
            if self.score(members) < top - settings.far_score or fit is self.best:
                continue
            for member in members:
                part = tuple(each for each in members if each != member)
                if (known := self.fits.get(part)) is None or is_good(known):
                    continue
                value = self.problem.prior(part) + evidence_without(fit, member, self.residuals.log_det)
                promising = value > max(self.score(part) + settings.near_score, top - settings.leading_score)
                if promising and value > starts.get(part, (-math.inf,))[0]:
                    starts[part] = value, fit.without([member])
        return [start for _, start in starts.values()]

    def _search(self) -> None:
        settings, top = self.problem.settings, -math.inf
        for again in range(3):
            before, top = top, max(map(self.score, self.fits))
            if again == 2 and top == before:
                return
            ahead = [
                members
                for members, value in sorted(self.estimates.items(), key=lambda item: -item[1])
                if value > top - settings.near_score and self._start(members) is not None
            ]
            near = self._deciding(ahead)[: settings.beside_sets]
            if not near:
                return
            starts = {members: start for members in near if (start := self._start(members)) is not None}
            self._take(first_fits(self.residuals, self.problem.predictions, near, starts, self.problem._count))
            self._estimate()

    def _deciding(self, ahead: Sequence[Members]) -> list[Members]:
        """The sets that can change whether the open effects are named; ``ahead``: best first."""
        every = [members for members in ahead if self.open and set(self.open) <= set(members)]
        return [members for members in ahead if members not in every[1:]]

    def _take(self, fits: Sequence[FittedSet]) -> None:
        for fit in fits:
            members = self.problem.ordered(fit.members)
            known = self.fits.get(members)
            # A fit beside a law far from the data may end worse than it began.
            if known is None or fit.log_evidence > known.log_evidence:
                self.fits[members] = fit
            self.estimates.pop(members, None)

    def _start(self, members: Members) -> FittedSet | None:
        """The best fit of a part of a set; else the best one that has more effects, without these."""
        return nearest({part: fit for part, fit in self.fits.items() if part != members}, members, self.score)

    def _estimate(self) -> None:
        """Estimate sets with one effect more, one less or another one than a good fit, in the linear model about it."""
        top, settings = max(map(self.score, self.fits)), self.problem.settings
        for members, fit in self.fits.items():
            if self.score(members) < top - settings.far_score:
                continue
            for member in members:
                part = tuple(each for each in members if each != member)
                value = self.problem.prior(part) + evidence_without(fit, member, self.residuals.log_det)
                self._better(part, value)
            self._estimate_others(members, fit)

    def _estimate_others(self, members: Members, fit: FittedSet) -> None:
        """Estimate sets with a further effect, and with another effect in place of a member."""
        problem = self.problem
        others = [each for each in self.candidates if each not in members]
        about = linear_about(
            self.residuals, fit, [unknown for each in others for unknown in (*each.amplitudes, *each.presence)]
        )
        of_fit = about.log_evidence(()) + problem.prior(members) - self.score(members)

        def estimate(model: LinearModel, kept: Members) -> None:
            further = [each for each in others if separate(each, kept)]
            evidences = SetEvidences(model.design, [(each,) for each in further]).log_evidence(model.overlap).tolist()
            for candidate, evidence in zip(further, evidences, strict=True):
                other = problem.ordered((*kept, candidate))
                self._better(other, evidence + problem.prior(other) - of_fit)

        if len(members) < problem.settings.largest:
            estimate(about, members)
        for member in members:
            if not member.presence:
                estimate(about.without(member.unknowns), tuple(each for each in members if each is not member))

    def _better(self, members: Members, value: float) -> None:
        members = self.problem.ordered(members)
        if members not in self.fits:
            self.estimates[members] = max(value, self.estimates.get(members, -math.inf))

    def allowed(self) -> dict[Candidate, tuple[float, float, float]]:
        """Effects that the discrepancy allows for by itself -> probability, x and its sd at the best fit.

        The odds that such an effect acts are its prior odds times the prior density over the posterior density of its
        amplitude at zero (Dickey 1971). x is linear, with the effect's sensitivities at zero.
        """
        of, fit = self.discrepancy, self.best
        shared = of.shared_error
        effects = {each.amplitudes[0]: each for each in self.problem.candidates if len(each.amplitudes) == 1}
        if shared is None or not any(unknown in effects for unknown in of.further):
            return {}
        mean, sd = shared.coefficients(fit.state.r, fit.state.J, fit.state.posterior.covariance)
        allowed = {}
        for unknown, c, s in zip(of.further, mean, np.maximum(sd, 1e-9), strict=False):
            if (candidate := effects.get(unknown)) is not None:
                odds = self.problem.prior((candidate,)) - self.problem.prior(())
                probability = float(expit(odds + math.log(s) + (c / s) ** 2 / 2))
                allowed[candidate] = probability, float(c) * unknown.sd, float(s) * unknown.sd
        return allowed

    def scored(self) -> list[ScoredSet]:
        """All sets, best first; estimates stay below the best fit."""
        rows = [ScoredSet(self.score(members), members, fit) for members, fit in self.fits.items()]
        highest = max(row.score for row in rows)
        rows += [ScoredSet(min(value, highest), members, None) for members, value in self.estimates.items()]
        return sorted(rows, key=lambda row: -row.score)


def evidence(state: FitState, log_det: float) -> float:
    """ln evidence of the linear model of a state."""
    data = state.r + state.J @ state.x
    return state.posterior.log_evidence - float(data @ data) / 2 - log_det


def evidence_without(fit: FittedSet, member: Candidate, log_det: float) -> float:
    """ln evidence of a fitted set without a member, in the linear model about the fit."""
    kept = [place for place, unknown in enumerate(fit.unknowns) if unknown not in member.unknowns]
    if member.presence or len(kept) == len(fit.unknowns):
        return -math.inf
    state = fit.state
    x = np.where(np.isin(np.arange(len(fit.unknowns)), kept), 0.0, state.x)
    part = replace(
        state,
        unknowns=tuple(state.unknowns[place] for place in kept),
        x=state.x[kept],
        r=state.r + state.J @ x,
        J=state.J[:, kept],
    )
    part = replace(part, posterior=part.fitted())
    return evidence(part, log_det)


def is_good(fit: FittedSet) -> bool:
    """Whether a fit got to its best point, or noise explains what it leaves."""
    return fit.converged or fit.p_value > USUAL_P


def nearest(fits: Mapping[Members, FittedSet], members: Members, score: Callable[[Members], float]) -> FittedSet | None:
    """The fit of a set, else the best one of a part of it, else the best one with further effects, without these."""
    if members in fits:
        return fits[members]
    if parts := [part for part in fits if set(part) < set(members)]:
        return fits[max(parts, key=score)]
    wholes = [whole for whole in fits if set(members) < set(whole)]
    # Without an effect that has no amplitude all sensitivities are other ones.
    wholes = [whole for whole in wholes if not any(each.presence for each in whole if each not in members)]
    if not wholes:
        return None
    whole = fits[max(wholes, key=score)]
    return whole.without([each for each in whole.members if each not in members])
