"""A layout of sensors and runs as a linear model: probabilities of all sets of effects in milliseconds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from tyrefem.brief import Brief
from tyrefem.diagnose.data.sensitivities import Sensitivities
from tyrefem.diagnose.fitting.fits import FittedSet, predictive
from tyrefem.diagnose.fitting.gauss_newton import initial_state
from tyrefem.diagnose.fitting.selection import ScoredSet, sets_of
from tyrefem.diagnose.inference.linear_model import DesignMatrix, LinearModel
from tyrefem.diagnose.layout.amplitudes import Amplitudes
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Members, SetPrior, catalogue_candidates, in_single_runs, simulated
from tyrefem.diagnose.unknowns.heat_patches import patches
from tyrefem.diagnose.verdicts.verdict import Judgement, judge, ranked
from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]
#: Sets above this probability are fitted for a verdict, and so many of them.
LEAST, MOST = 0.01, 4


@dataclass(frozen=True, eq=False)
class LinearLayout(Brief):
    """Whitened readings d = J x + e of a layout, with all sets of effects and heat of unknown origin.

    Parameters
    ----------
    design : of the fitted runs, nuisance unknowns first. held_out : (m, k) the same columns in held-out runs.
    candidates, prior : the effects and ln of the prior probability of a set.
    heat, heat_sd : (n, p), (p,) columns of heat of unknown origin and prior sd. heat_held_out : (m, p).
    log_prior_heat : ln of the prior probability of a cause outside the catalogue; -inf: not considered.
    """

    design: DesignMatrix
    held_out: Array
    candidates: Members
    prior: SetPrior
    heat: Array
    heat_sd: Array
    heat_held_out: Array
    log_prior_heat: float = -math.inf
    settings: DiagnosisSettings = DEFAULT

    @cached_property
    def sets(self) -> tuple[Members, ...]:
        """No effect, single effects, pairs."""
        sizes = range(min(self.settings.largest, 2) + 1)
        return tuple(members for size in sizes for members in sets_of(self.candidates, size))

    @cached_property
    def log_prior(self) -> Array:
        """ln of the prior probability of every set, heat of unknown origin last; normalised."""
        values = np.array([*map(self.prior, self.sets), self.log_prior_heat])
        return np.asarray(values - np.logaddexp.reduce(values))

    def scores(self, data: Array) -> Array:
        """ln(prior x evidence) of every set, heat of unknown origin last, up to a constant of the data (n,)."""
        return self.log_prior + self._evidence(data)

    def probabilities(self, data: Array) -> Array:
        """Posterior probability of every set, heat of unknown origin last."""
        scores = self.scores(data)
        return np.asarray(np.exp(scores - np.logaddexp.reduce(scores)))

    def fit(self, data: Array, held_out: Array, members: Members) -> FittedSet:
        """The fit of a set, exact as the model is linear; ``held_out``: readings (m,) of held-out runs."""
        linear = LinearModel(self.design, data)
        state = initial_state(linear, {}, members, self.settings)
        solution = state.fitted()
        r = state.r - state.J @ solution.mean
        presence = self.design.columns([unknown for member in members for unknown in member.presence])
        held, p_held = math.nan, math.nan
        if len(held_out):
            columns = self.held_out[:, self.design.columns(state.unknowns)]
            rest = held_out - self.held_out[:, presence].sum(axis=1) - columns @ solution.mean
            held, p_held = predictive(rest, np.eye(len(rest)) + columns @ solution.covariance @ columns.T)
        done = replace(
            state, shapes=(), x=solution.mean, r=r, posterior=solution, done=True, converged=True, simulated=True
        )
        about = LinearModel(DesignMatrix(state.unknowns, len(state.unknowns), state.J), state.r)
        log_evidence = solution.log_evidence - float(state.r @ state.r) / 2
        return FittedSet(
            members, state.unknowns, solution, log_evidence, {}, done.misfit(r, solution.mean), len(r), held, p_held,
            about, done,
        )  # fmt: skip

    def judge(self, data: Array, held_out: Array) -> Judgement:
        """The verdict of a diagnosis on these readings, with the leading sets fitted."""
        scores = self.scores(data)
        order = np.argsort(-scores[:-1], kind="stable")
        shares = np.exp(scores - np.logaddexp.reduce(scores))
        fitted = {0, int(order[0]), *(int(place) for place in order[:MOST] if shares[place] > LEAST)}
        fits = {place: self.fit(data, held_out, self.sets[place]) for place in fitted}
        scored = [ScoredSet(float(scores[place]), self.sets[place], fits.get(int(place))) for place in order]
        outside = float(scores[-1]) if math.isfinite(self.log_prior_heat) else None
        return judge(ranked(scored, outside), lambda members: fits[0] if not members else None, self.settings)

    # -- evidence of all sets ----------------------------------------------------------------------------------------

    @cached_property
    def _projected(self) -> tuple[Array, Array]:
        """(k - nuisance, n) columns of effects with the nuisance integrated out, and their Gram matrix."""
        n, J = self.design.nuisance, self.design.jacobian
        gram, projection, _ = self.design.marginal
        return np.asarray(J[:, n:].T - projection @ J[:, :n].T), gram

    @cached_property
    def _of_heat(self) -> tuple[Array, tuple[Array, bool], float]:
        """Projected columns of heat times sd (p, n), factor of 1 + S G S, ln det of it / 2."""
        n, J = self.design.nuisance, self.design.jacobian[:, : self.design.nuisance]
        scaled = self.heat * self.heat_sd
        projected = (scaled - J @ (self.design.inverse @ (J.T @ scaled))).T
        factor = cho_factor(np.eye(scaled.shape[1]) + projected @ scaled, lower=True)
        assert n == J.shape[1]
        return np.asarray(projected), factor, float(np.log(np.diag(factor[0])).sum())

    @cached_property
    def _columns(self) -> tuple[Array, Array, NDArray[np.intp], NDArray[np.bool_]]:
        """By set: number of each of two members (-1: none), column of each candidate, whether it has an amplitude."""
        place = {candidate: number for number, candidate in enumerate(self.candidates)}
        members = np.full((len(self.sets), 2), -1)
        for number, each in enumerate(self.sets):
            members[number, : len(each)] = [place[member] for member in each]
        unknowns = [(*each.amplitudes, *each.presence) for each in self.candidates]
        columns = self.design.columns([each[0] for each in unknowns]) - self.design.nuisance
        return members[:, 0], members[:, 1], columns, np.array([bool(each.amplitudes) for each in self.candidates])

    @cached_property
    def _several(self) -> list[int]:
        """Numbers of the sets with a member of several amplitudes."""
        many = {each for each in self.candidates if len(each.amplitudes) + len(each.presence) > 1}
        return [number for number, members in enumerate(self.sets) if many.intersection(members)]

    def _amplitudes(self, data: Array) -> Amplitudes:
        """The amplitudes of all candidates, given data."""
        projected, gram = self._projected
        _, _, columns, fitted = self._columns
        unknowns = [(*each.amplitudes, *each.presence)[0] for each in self.candidates]
        sd, low, high = (np.array([getattr(each, name) for each in unknowns]) for name in ("sd", "low", "high"))
        overlap, rows = (projected @ data)[columns], self._bounded_nuisance[columns]
        return Amplitudes(overlap, gram[np.ix_(columns, columns)], sd, low, high, fitted, rows)

    def _evidence(self, data: Array) -> Array:
        """ln evidence of every set, heat last, relative to no effect; as `LinearModel.log_evidence`."""
        amplitudes = self._amplitudes(data)
        first, second, _, fitted = self._columns
        result = np.zeros(len(self.sets) + 1)
        # By set, effects of a set on the bounded base numbers and sensors: shift of their means, added variance.
        shift, spread = (np.zeros((len(self.sets) + 1, amplitudes.rows.shape[1])) for _ in range(2))
        alone = np.flatnonzero((first >= 0) & (second < 0))
        result[alone], shift[alone], spread[alone] = amplitudes.single(first[alone])
        two = np.flatnonzero(second >= 0)
        i, j = first[two], second[two]
        # A fixed signal is subtracted from the data; it comes first.
        swap = ~fitted[j]
        i, j = np.where(swap, j, i), np.where(swap, i, j)
        fixed = ~fitted[i]
        after, free = two[fixed], two[~fixed]
        result[after], shift[after], spread[after] = amplitudes.after_signal(i[fixed], j[fixed])
        result[free], shift[free], spread[free] = amplitudes.pair(i[~fixed], j[~fixed])
        if self._several:
            linear = LinearModel(self.design, data)
            none = linear.log_evidence(())
            for number in self._several:
                result[number] = linear.log_evidence(self.sets[number]) - none
        if math.isfinite(self.log_prior_heat):
            result[-1], shift[-1], spread[-1] = self._evidence_of_heat(data)
        masses = self._nuisance_mass(data, shift, spread)
        if self._several:
            # These have the mass in their evidence.
            masses[self._several] = masses[0]
        return result + masses - masses[0]

    def _evidence_of_heat(self, data: Array) -> tuple[float, Array, Array]:
        """ln evidence of heat of unknown origin; shift and variance of the bounded nuisance by it."""
        columns, factor, half = self._of_heat
        right = columns @ data
        z = cho_solve(factor, right)
        of_heat = self._bounded_nuisance_of_heat
        spread = np.einsum("pn,pn->n", of_heat, cho_solve(factor, of_heat))
        return float(right @ z) / 2 - half, of_heat.T @ z, spread

    @cached_property
    def _bounded_nuisance(self) -> Array:
        """(k - nuisance, n) change of the bounded base numbers and sensors by an effect."""
        return np.asarray(self.design.marginal[1][:, self.design.bounded])

    @cached_property
    def _bounded_nuisance_of_heat(self) -> Array:
        """(p, n) change of the bounded base numbers and sensors by heat of unknown origin, times its sd."""
        n, at = self.design.nuisance, self.design.bounded
        return np.asarray((self.heat * self.heat_sd).T @ self.design.jacobian[:, :n] @ self.design.inverse[:, at])

    def _nuisance_mass(self, data: Array, shift: Array, variance: Array) -> Array:
        """(n_sets,) ln of the mass of base numbers and sensors within their bounds, over that of their priors."""
        design, n = self.design, self.design.nuisance
        at = design.bounded
        mean = (design.inverse @ (design.jacobian[:, :n].T @ data))[at] - shift
        return design.nuisance_mass(mean, np.diag(design.inverse)[at] + variance)


def competing(
    study: StudyData, known: Sensitivities, settings: DiagnosisSettings = DEFAULT
) -> tuple[Members, Sensitivities]:
    """The candidates that a diagnosis of planned runs would have, and sensitivities to them."""
    everywhere = catalogue_candidates(study)
    runs = list(dict.fromkeys(known.drives[number].run for number in known.fitted))
    in_one_run = in_single_runs(study, everywhere, runs) if settings.odd_run_share else ()
    of_single_runs = [unknown for each in in_one_run for unknown in (*each.amplitudes, *each.presence)]
    known = known.in_single_runs(of_single_runs)
    candidates, _ = simulated((*everywhere, *in_one_run), known.failed)
    return candidates, known.without(known.failed)


def linear_layout(study: StudyData, known: Sensitivities, settings: DiagnosisSettings = DEFAULT) -> LinearLayout:
    """The linear layout of planned runs with known sensitivities, with the candidates that a diagnosis would have."""
    candidates, known = competing(study, known, settings)
    card = study.card.diagnosis
    prior = SetPrior(candidates, card.effects_expected, settings.size_shares, settings.odd_run_share)
    unknown_heat = patches(study, settings)
    sd = np.array([patch.sd for patch in unknown_heat])
    columns = [known.unknowns.index(patch) for patch in unknown_heat]
    p = len(columns)
    heat = _by_run([known.whitened[number][:, columns] for number in known.fitted], p)
    held_out = [known.whitened[number] for number in known.held_out]
    heat_held_out = _by_run([J[:, columns] for J in held_out], p)
    k = len(known.unknowns)
    # The runs' own parts of held-out runs are columns of their own, which no fitted run has.
    of_runs = len(known.fitted) * p
    heat_held_out = np.hstack([heat_held_out[:, :p], np.zeros((len(heat_held_out), of_runs)), heat_held_out[:, p:]])
    heat = np.hstack([heat, np.zeros((len(heat), len(known.held_out) * p))])
    return LinearLayout(
        known.design(known.fitted),
        np.vstack([np.zeros((0, k)), *held_out]),
        candidates,
        prior,
        heat,
        np.concatenate([sd, *[sd / 2] * len(known.drives)]),
        heat_held_out,
        math.log(card.effects_expected * settings.outside_share),
        settings,
    )


def _by_run(parts: Sequence[Array], p: int) -> Array:
    """``p`` columns that all runs share, then those of each run alone."""
    n = np.cumsum([0, *map(len, parts)])
    wide = np.zeros((n[-1], p * (1 + len(parts))))
    for number, part in enumerate(parts):
        rows = slice(n[number], n[number + 1])
        wide[rows, :p] = part
        wide[rows, p * (number + 1) : p * (number + 2)] = part
    return wide
