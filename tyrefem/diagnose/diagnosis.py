"""The result of a diagnosis: verdict, amended study, residuals before and after."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.brief import Brief
from tyrefem.diagnose.data.residual_tables import residual_table, rms
from tyrefem.diagnose.numbers import percent
from tyrefem.diagnose.unknowns.candidates import SetPrior
from tyrefem.diagnose.verdicts.prior_sensitivity import PriorChange, prior_sensitivity
from tyrefem.diagnose.verdicts.verdict import IDENTIFIED, PARTLY

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.diagnose.amend import Change
    from tyrefem.diagnose.beside.law_trials import BetterLaw, LawTrial
    from tyrefem.diagnose.beside.robustness import Robustness
    from tyrefem.diagnose.data.residuals import Residuals
    from tyrefem.diagnose.data.runs import MeasuredSensor
    from tyrefem.diagnose.fitting.fits import FittedSet
    from tyrefem.diagnose.fitting.materiality import Movement
    from tyrefem.diagnose.fitting.support import Support
    from tyrefem.diagnose.heat.missing_heat import UnknownHeat
    from tyrefem.diagnose.law.search import HeatLaw
    from tyrefem.diagnose.law.signatures import LawSignature
    from tyrefem.diagnose.layout.conformal import ConformalCalibration
    from tyrefem.diagnose.unknowns.candidates import Candidate
    from tyrefem.diagnose.verdicts.verdict import Judgement
    from tyrefem.inputs.study import StudyData


@dataclass(frozen=True, eq=False)
class DiagnosisData(Brief):
    """The result of a diagnosis.

    Parameters
    ----------
    original : the study that was compared with the data. study : the amended study, ready to save and run.
    judgement : verdict, sets with their probabilities, reasons. gap : measured - computed, and its sensitivities to
        every unknown.
    null, best : the fits without any effect and with the most probable set. missing : heat of unknown origin.
    changes : changes from ``original`` to ``study``. before, after : number of the run -> block means, degC.
    next_experiment : sensors and drives that separate the credible sets; empty unless the verdict is "confounded".
    predictions : numbers of model evaluations and the certificates of reduced models. seconds : wall time.
    again : diagnosis of the amended study with the same data; None if there was no further look.
    movements : effect of the best set -> largest change of a reading by it.
    law : law of the missing heat over the runs; None if heat was not missing, or at no clear place. signatures : what
        effects and mechanisms would do beside it.
    robustness : effects beside discrepancy models; None if there is no gap. supports : named effect -> its
        probability with each sensor and run left out.
    law_trials : other strain laws, if the study does not explain the data. better_law : the one in place of the
        study's; judgement, fits and amended study are then by this law, ``original`` and ``before`` by the study's.
    notes : candidates that were left out, and why. conformal : calibration of the layout, if one was given.
    """

    original: StudyData
    study: StudyData
    judgement: Judgement
    gap: Residuals
    candidates: tuple[Candidate, ...]
    null: FittedSet
    best: FittedSet
    missing: UnknownHeat
    changes: tuple[Change, ...]
    before: dict[int, Any]
    after: dict[int, Any]
    next_experiment: Mapping[str, Any]
    predictions: Mapping[str, Any]
    seconds: float
    again: DiagnosisData | None = None
    notes: tuple[str, ...] = ()
    movements: Mapping[Candidate, Movement] = field(default_factory=dict)
    law: HeatLaw | None = None
    signatures: tuple[LawSignature, ...] = ()
    robustness: Robustness | None = None
    conformal: ConformalCalibration | None = None
    supports: Mapping[Candidate, Support] = field(default_factory=dict)
    law_trials: tuple[LawTrial, ...] = ()
    better_law: BetterLaw | None = None

    def _title(self) -> str:
        return f"of {self.original.name}: {self.verdict}"

    def _facts(self) -> Mapping[str, Any]:
        sets = [f"{entry.key} ({percent(entry.probability)})" for entry in self.judgement.ranking[:3]]
        facts: dict[str, Any] = {
            "most probable": ", ".join(sets),
            "reasons": " ".join(self.judgement.reasons),
            "changes": [entry.unknown.key for entry in self.changes],
            "measured - computed": f"{self.rms(after=False, held_out=False):.2f} K rms before, "
            f"{self.rms(after=True, held_out=False):.2f} K after; noise {self.noise:.2f} K",
        }
        if self.gap.held_out:
            before, after = (self.rms(after=then, held_out=True) for then in (False, True))
            facts["held-out runs"] = f"{before:.2f} K rms before, {after:.2f} K after"
        return facts | {
            "candidates": f"{len(self.candidates)}",
            "looks": [entry.verdict for entry in self.looks],
            "wall time": f"{self.seconds:.0f} s",
        }

    @property
    def looks(self) -> tuple[DiagnosisData, ...]:
        """This diagnosis and the further diagnoses of the amended studies."""
        return (self, *(self.again.looks if self.again else ()))

    @property
    def verdict(self) -> str:
        """identified, partly identified, confounded, unexplained or no gap."""
        return self.judgement.verdict

    @property
    def named_effects(self) -> tuple[str, ...]:
        """Keys of the effects that the verdict names."""
        named = self.best.members if self.verdict in (IDENTIFIED, PARTLY) else ()
        return tuple(member.key for member in named)

    @functools.cached_property
    def where(self) -> pd.DataFrame:
        """Residuals of the original study by run, sensor and stretch of time."""
        return residual_table(self.gap, self.before)

    @functools.cached_property
    def where_after(self) -> pd.DataFrame:
        """Residuals of the amended study for the same stretches of time as `where`."""
        return residual_table(self.gap, self.after, self.before)

    @functools.cached_property
    def prior(self) -> SetPrior:
        """ln of the prior probability of a set."""
        expected, settings = self.original.card.diagnosis.effects_expected, self.gap.settings
        return SetPrior(self.candidates, expected, settings.size_shares, settings.odd_run_share)

    @functools.cached_property
    def prior_sensitivity(self) -> tuple[PriorChange, ...]:
        """The verdict with priors of the leading effects three times as large, and a third."""
        replaced = self.better_law is not None
        return prior_sensitivity(self.judgement, self.gap, self.null, self.best, self.robustness, law_replaced=replaced)

    def rms(self, *, after: bool, held_out: bool) -> float:
        """Root mean square of measured - computed, K."""
        runs = self.gap.held_out if held_out else self.gap.fitted
        return rms(self.gap, self.after if after else self.before, runs)

    @property
    def noise(self) -> float:
        """Root mean square of the readings' noise as the diagnosis uses it, K."""
        return self._mean_noise(lambda readings: readings.noise)

    @property
    def stated_noise(self) -> float:
        """Root mean square of the stated noise, K."""
        return self._mean_noise(lambda readings: readings.origin.stated if readings.origin else readings.noise)

    @property
    def noise_of_data(self) -> float:
        """Root mean square of the noise that the readings' scatter shows, K; NaN with too few readings."""
        return self._mean_noise(lambda readings: readings.origin.from_data if readings.origin else math.nan)

    @property
    def correlated_noise(self) -> bool:
        """Whether neighbouring readings share noise, so that their scatter shows only a part of it."""
        origins = [readings.origin for run in self.gap.runs for readings in run.sensors]
        return any(origin.correlated for origin in origins if origin is not None)

    def _mean_noise(self, noise_of: Callable[[MeasuredSensor], float]) -> float:
        """Root mean square over all readings, K; series without a number do not count."""
        sensors = [readings for run in self.gap.runs for readings in run.sensors]
        values = np.array([noise_of(readings) for readings in sensors])
        weights = np.array([len(readings.times) for readings in sensors], dtype=float)
        known = np.isfinite(values)
        return float(np.sqrt(np.average(values[known] ** 2, weights=weights[known]))) if known.any() else math.nan
