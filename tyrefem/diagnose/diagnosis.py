"""What a diagnosis found: verdict, amended study, gap before and after."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.brief import Brief
from tyrefem.diagnose.candidates import SetPrior
from tyrefem.diagnose.numbers import percent
from tyrefem.diagnose.residual_tables import residual_table, rms

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.diagnose.amend import Change
    from tyrefem.diagnose.candidates import Candidate
    from tyrefem.diagnose.fits import FittedSet
    from tyrefem.diagnose.missing_heat import UnknownHeat
    from tyrefem.diagnose.residuals import Residuals
    from tyrefem.diagnose.verdict import Judgement
    from tyrefem.inputs.study import StudyData


@dataclass(frozen=True, eq=False)
class DiagnosisData(Brief):
    """What a diagnosis found.

    Parameters
    ----------
    original : the study that was held against the data. study : the amended one, ready to save and run.
    judgement : verdict, sets with their probabilities, reasons. gap : measured - computed, and how it
        changes with every unknown.
    null, best : the fits without any effect and with the most probable set. missing : heat of unknown origin.
    changes : what ``study`` has that ``original`` has not. before, after : trial -> block means, degC.
    next_experiment : what would tell the credible sets apart; empty where nothing needs telling.
    predictions : what predicted for the fits, with every certificate of a reduced model. seconds : wall time.
    again : what was found when the amended study was held against the same data.
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
        """This diagnosis and those of what was left."""
        return (self, *(self.again.looks if self.again else ()))

    @property
    def verdict(self) -> str:
        """identified, confounded, unexplained or no gap."""
        return self.judgement.verdict

    @functools.cached_property
    def where(self) -> pd.DataFrame:
        """Disagreement of the original study with the data by run, sensor and stretch of time."""
        return residual_table(self.gap, self.before)

    @functools.cached_property
    def where_after(self) -> pd.DataFrame:
        """The same for the amended study, at the same stretches of time."""
        return residual_table(self.gap, self.after, self.before)

    @functools.cached_property
    def prior(self) -> SetPrior:
        """ln of the prior probability of a set."""
        return SetPrior(self.candidates, self.original.card.diagnosis.effects_expected, self.gap.settings.size_shares)

    def rms(self, *, after: bool, held_out: bool) -> float:
        """Root mean square of measured - computed, K."""
        trials = self.gap.held_out if held_out else self.gap.fitted
        return rms(self.gap, self.after if after else self.before, trials)

    @property
    def noise(self) -> float:
        """Root mean square of the readings' noise, K."""
        sensors = [readings for trial in self.gap.trials for readings in trial.sensors]
        weights = np.array([len(readings.times) for readings in sensors], dtype=float)
        return float(np.sqrt(np.average([readings.noise**2 for readings in sensors], weights=weights)))
