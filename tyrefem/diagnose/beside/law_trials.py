"""Other strain laws in place of the study's: how much of the deviation each takes away, before anything is fitted."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.beside.discrepancy import Discrepancy, beside_law, with_courses
from tyrefem.diagnose.data.residual_tables import rms
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.forward.evaluations import Evaluations
from tyrefem.diagnose.forward.strain_law_study import mesh_of_law
from tyrefem.mechanics.strain_laws import strain_laws

Array = NDArray[np.float64]
#: Errors that neighbouring readings may share while laws are compared in the linear model, K: it is far from the data.
COARSE = 2.0
#: A law is diagnosed in place of the study's if its evidence is ahead by this in the linear model, nats.
AHEAD = 10.0
#: It must also bring the rms of measured - computed below this share of what it is by the study's law.
SMALLER = 0.8


@dataclass(frozen=True, eq=False)
class LawTrial(Brief):
    """Another strain law with the tyre's heat as in the study: nothing is fitted.

    Parameters
    ----------
    law : its name. level : ln of the factor that gives it the study's heat.
    stated_heat, heat : (n,) W by the study's law and by this one, in equal stretches from crown to bead.
    gain : ln evidence of no effect by the law minus that by the study's law, in the linear model about x = 0.
    stated_rms : K, of measured - computed by the study's law in the fitted runs.
    rms, held_out_rms : K, by this law in the fitted and the held-out runs; NaN without runs.
    """

    law: str
    level: float
    stated_heat: Array
    heat: Array
    gain: float
    stated_rms: float
    rms: float
    held_out_rms: float

    def _title(self) -> str:
        return f"{self.law}: {self.rms:.2g} K, {self.gain:+.3g} nats"

    @property
    def ratio(self) -> Array:
        """(n,) heat by this law over that by the study's; a heat below a thousandth of the largest counts as that."""
        least = 1e-3 * float(self.stated_heat.max())
        return np.asarray(self.heat / np.maximum(self.stated_heat, least))

    @property
    def promising(self) -> bool:
        """Whether the law is to be diagnosed in place of the study's: it takes much of the deviation away."""
        return self.gain > AHEAD and self.rms < SMALLER * self.stated_rms

    def to_dict(self) -> dict[str, Any]:
        """Plain data for ``verdict.json``."""
        return {
            "law": self.law,
            "heat_factor": math.exp(self.level),
            "rms_K": self.rms,
            "held_out_rms_K": self.held_out_rms,
            "log_evidence_gain": self.gain,
        }


@dataclass(frozen=True, eq=False)
class BetterLaw(Brief):
    """Another strain law that the data prefer to the study's.

    Parameters
    ----------
    stated : the study's law. trial : the better law with the study's heat, nothing fitted.
    log_odds : ln evidence by the better law minus that by the stated one, over all sets of effects and discrepancies.
    held_out_lead : how much better it predicts the held-out runs, nats; NaN without such runs.
    alone : True: with it noise and corrections explain the data, and no effect is missing.
    """

    stated: str
    trial: LawTrial
    log_odds: float
    held_out_lead: float
    alone: bool

    def _title(self) -> str:
        return f"{self.trial.law} in place of {self.stated}: {self.log_odds:+.3g} nats"

    def to_dict(self) -> dict[str, Any]:
        """Plain data for ``verdict.json``."""
        return {
            "stated": self.stated,
            **self.trial.to_dict(),
            "log_odds": self.log_odds,
            "held_out_lead": self.held_out_lead,
            "no_effect_missing": self.alone,
            "heat_ratio": self.trial.ratio,
        }


def law_trials(residuals: Residuals, evaluations: Evaluations) -> tuple[LawTrial, ...]:
    """Every other strain law that the study can run, the most probable first.

    A law that needs further inputs is not tried; one that presses the tyre on the road does so in linear motion.
    """
    stated = residuals.study.card.mechanics.strain
    laws = [name for name, law in strain_laws().items() if name != stated and law.compared]
    trials = [trial for law in laws if (trial := _trial(residuals, evaluations, law)) is not None]
    return tuple(sorted(trials, key=lambda trial: -trial.gain))


def _trial(residuals: Residuals, evaluations: Evaluations, law: str) -> LawTrial | None:
    first, mesh = residuals.fitted[0], mesh_of_law(law, residuals.settings.mesh_size)
    (heats,) = evaluations.of("heat_by_law", [(first, law, mesh)])
    stated, other = heats
    if not (np.isfinite(heats).all() and stated.sum() > 0 and other.sum() > 0):
        return None
    level = math.log(stated.sum() / other.sum())
    numbers = range(len(residuals.runs))
    changes = evaluations.of("change_by_law", [(number, law, level, mesh) for number in numbers])
    if not all(np.isfinite(change).all() for change in changes):
        return None
    computed = {number: _stated(residuals, number) + changes[number] for number in numbers}
    return LawTrial(
        law,
        level,
        stated,
        np.exp(level) * other,
        _evidence(residuals, beside_law(residuals, law, changes))
        - _evidence(residuals, beside_law(residuals, stated_law(residuals), ())),
        rms(residuals, {number: _stated(residuals, number) for number in numbers}, residuals.fitted),
        rms(residuals, computed, residuals.fitted),
        rms(residuals, computed, residuals.held_out),
    )


def _stated(residuals: Residuals, number: int) -> Array:
    """Block means of a run by the study as written, degC."""
    return residuals.corrected(number, residuals.computed[number])


def stated_law(residuals: Residuals) -> str:
    """The strain law of the study."""
    return str(residuals.study.card.mechanics.strain)


def _evidence(residuals: Residuals, discrepancy: Discrepancy) -> float:
    """ln evidence of no effect beside a law and coarse errors of the readings, in the linear model about x = 0."""
    coarse = with_courses(residuals, discrepancy, COARSE)
    beside = residuals.beside(coarse.nuisance, coarse.shared_error, coarse.offset)
    linear = beside.linear(beside.fitted)
    return linear.log_evidence(()) + linear.constant - beside.log_det
