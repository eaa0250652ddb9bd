"""Which effects stay named whatever else is wrong: sets of effects ranked again beside every discrepancy model."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from tyrefem.brief import Brief
from tyrefem.diagnose.beside.discrepancy import NONE, Discrepancy
from tyrefem.diagnose.beside.free_heat import FreeHeat
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.unknowns.candidates import Candidate, Members
from tyrefem.diagnose.unknowns.unknown import Unknown

#: Amounts of an effect beside two discrepancy models agree within this many standard deviations of their difference.
APART = 3.0
#: An amount of an effect is none if it lies within so many of its standard deviations of it.
LEAST_AMOUNT = 2.0
#: The data exclude a discrepancy model of less probability if another one explains them: noise alone makes its misfit
#: with at least this probability.
EXCLUDED, EXPLAINS = 1e-6, 0.01
#: Smallest probability of the misfit beside the most probable discrepancy model.
LEAST_P = 1e-4


@dataclass(frozen=True, eq=False)
class UnderDiscrepancy(Brief):
    """Sets of effects beside one discrepancy model.

    Parameters
    ----------
    name, size, words : see `tyrefem.diagnose.beside.discrepancy.Discrepancy`.
    probability : of the model, given the data.
    named : candidate key -> probability that it acts. best : the most probable set.
    values : key of an effect's unknown -> (x, sd) in the best fitted set that contains the effect. totals : the same
        with the tolerance of a sensor's card, of the unknowns that have one (`FittedSet.total`).
    fits : set -> its fit beside the model. residuals : beside the model.
    discrepancy : the model itself; None: none. allowed : effects that it allows for by itself; ``named`` and ``values``
        have them, too. held_out_without : such an effect's key -> ln p of the held-out runs by the best set beside the
        model without it, if that was worked out.
    """

    name: str
    size: float
    words: str
    probability: float
    named: Mapping[str, float]
    best: Members
    values: Mapping[str, tuple[float, float]]
    fits: Mapping[Members, FittedSet]
    residuals: Residuals | None = None
    discrepancy: Discrepancy | None = None
    allowed: Members = ()
    held_out_without: Mapping[str, float] = field(default_factory=dict)
    totals: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def _title(self) -> str:
        return f"{self.name}: {self.probability:.3g}"

    def stated(self, key: str) -> tuple[float, float]:
        """(x, sd) of an effect's unknown as a study states it."""
        return self.totals.get(key, self.values[key])

    @property
    def effects(self) -> Members:
        """The effects of the fitted sets, and those that the model allows for by itself."""
        by_key = {member.key: member for members in self.fits for member in members}
        return tuple((by_key | {each.key: each for each in self.allowed}).values())

    def held_out(self, members: Members) -> tuple[float, float]:
        """ln p of the held-out runs by the best fitted set with all these effects, and by the best without one of them.

        -infinity if there is none; NaN if no run is held out.
        """
        wanted = {member for member in members if member not in self.allowed}
        with_them = [fit.held_out for part, fit in self.fits.items() if wanted <= set(part)]
        without = [fit.held_out for part, fit in self.fits.items() if not wanted <= set(part)]
        without += [self.held_out_without[member.key] for member in members if member.key in self.held_out_without]
        return max(with_them, default=-math.inf), max(without, default=-math.inf)

    def log_evidence(self, members: Members) -> float:
        """Largest ln evidence of a fitted set with all these effects, if the model does not allow for them by itself.

        -infinity if there is none.
        """
        wanted = {member for member in members if member not in self.allowed}
        return max((fit.log_evidence for part, fit in self.fits.items() if wanted <= set(part)), default=-math.inf)

    @property
    def p_value(self) -> float:
        """Largest probability, among the fitted sets, of a misfit at least as large if set and model are right."""
        return max((fit.p_value for fit in self.fits.values()), default=0.0)

    @property
    def explains(self) -> bool:
        """Whether noise explains what the model leaves, without errors that readings share."""
        return self.size == 0.0 and self.p_value > EXPLAINS

    @property
    def refuted(self) -> bool:
        """Whether noise cannot explain the misfit of any fitted set."""
        return bool(self.fits) and self.p_value < LEAST_P


@dataclass(frozen=True, eq=False)
class Robustness(Brief):
    """Probabilities of effects beside every discrepancy model.

    ``models``: the models, the most probable first. ``laws``: other strain laws that were tried, without a probability.
    ``untried``: other strain laws that were not tried. ``log_evidence``: ln evidence of the data, over all models and
    sets of effects with their priors. ``heat``: heat of unknown origin by itself; None if it was not fitted. ``idle``:
    effects that are not needed where all that are about to be named are fitted together.
    """

    models: tuple[UnderDiscrepancy, ...]
    laws: tuple[UnderDiscrepancy, ...] = ()
    untried: tuple[str, ...] = ()
    log_evidence: float = math.nan
    heat: FreeHeat | None = None
    idle: Members = ()

    def _title(self) -> str:
        return f"{len(self.models)} models, {self.models[0].name} first"

    @property
    def as_it_is(self) -> float:
        """Probability that the model is right but for the effects."""
        return sum(model.probability for model in self.models if model.name == NONE)

    @property
    def counted(self) -> tuple[UnderDiscrepancy, ...]:
        """The models that the data do not exclude, and the strain laws that they do not refute.

        All models count if the most probable one does not explain the data: more is wrong than they allow for.
        """
        explains = self.models[0].explains
        models = (model for model in self.models if not (explains and model.probability < EXCLUDED))
        return (*models, *(law for law in self.laws if not law.refuted))

    def least(self, key: str) -> float:
        """Smallest probability of an effect over the models and strain laws that count."""
        return min(model.named.get(key, 0.0) for model in self.counted)

    def mean(self, key: str) -> float:
        """Probability of an effect, averaged over the models by their probabilities."""
        return sum(model.probability * model.named.get(key, 0.0) for model in self.models)

    def interval(self, unknown: Unknown) -> tuple[float, float]:
        """Lowest x - 2 sd and highest x + 2 sd of an effect's unknown over the models that are not improbable.

        A shape parameter may be fitted beside improbable models only: then these count.
        """
        fitted = [model for model in self.models if unknown.key in model.values]
        probable = [model for model in fitted if model is self.models[0] or model.probability > 0.01]
        known = [model.stated(unknown.key) for model in probable or fitted]
        return min(x - 2 * sd for x, sd in known), max(x + 2 * sd for x, sd in known)

    def spread(self, fit: FittedSet) -> dict[Unknown, float]:
        """Unknown of a fit's effects -> standard deviation of x over the discrepancy models, at least that of the fit.

        With x_m and s_m beside model m, of probability p_m, and x the value of the fit: the root of
        (sum of p_m (s_m^2 + (x_m - x)^2)) / (sum of p_m). All are of the number that a study states, `FittedSet.total`.
        """
        wider = {}
        for unknown in (unknown for member in fit.members for unknown in member.unknowns if unknown in fit.values):
            known = [
                (model.probability, *model.stated(unknown.key)) for model in self.models if unknown.key in model.values
            ]
            total = sum(probability for probability, *_ in known)
            if total > 0:
                fitted, least = fit.total(unknown)
                square = sum(p * (sd**2 + (x - fitted) ** 2) for p, x, sd in known) / total
                wider[unknown] = max(least, math.sqrt(square))
        return wider

    def agrees(self, candidate: Candidate) -> bool:
        """Whether an effect has the same sign beside every model, and beside probable models like amounts (`APART`)."""
        if not self._one_sign(candidate):
            return False
        for unknown in candidate.amplitudes:
            known = [(model.probability, model.values[unknown.key]) for model in self.counted]
            first = known[0][1]
            for probability, other in known[1:]:
                if probability > 0.01 and abs(other[0] - first[0]) > APART * math.hypot(other[1], first[1]):
                    return False
        return True

    def _one_sign(self, candidate: Candidate) -> bool:
        """Whether every model has an amount of an effect, all of the same sign."""
        for unknown in candidate.amplitudes:
            amounts = [model.values.get(unknown.key, (0.0, 0.0))[0] for model in self.counted]
            if not (min(amounts) > 0 or max(amounts) < 0):
                return False
        return True

    def is_none(self, candidate: Candidate) -> bool:
        """Whether an effect's amount is none beside the most probable model (`LEAST_AMOUNT`), however probable it is.

        Evidence of a fit that has not reached its best point can ask for an effect without an amount.
        """
        values = self.models[0].values
        amounts = [values[unknown.key] for unknown in candidate.amplitudes if unknown.key in values]
        return bool(amounts) and all(abs(x) <= LEAST_AMOUNT * sd for x, sd in amounts)

    def open(self, probability: float) -> Members:
        """Effects that `robust` may still name when further models are added: probable, and of one sign, so far."""
        members = {member.key: member for model in self.models for fitted in model.fits for member in fitted}
        return tuple(each for each in members.values() if self.least(each.key) >= probability and self._one_sign(each))

    def robust(self, candidates: Iterable[Candidate], probability: float) -> Members:
        """Effects that act with at least this probability beside every model, with amounts that agree.

        None if noise cannot explain the misfit beside the most probable model: more is wrong than the models allow for.
        """
        if self.models[0].p_value < LEAST_P:
            return ()
        return tuple(each for each in candidates if self.least(each.key) >= probability and self.agrees(each))


def shares(scores: Sequence[float]) -> list[float]:
    """Probabilities of models from ln(prior probability) + ln evidence."""
    top = max(scores)
    total = math.fsum(math.exp(score - top) for score in scores)
    return [math.exp(score - top) / total for score in scores]
