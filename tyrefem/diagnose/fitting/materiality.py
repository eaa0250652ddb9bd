"""What an effect moves at the sensors, in kelvins."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tyrefem.brief import Brief
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.forward.multifidelity import Predictions
from tyrefem.diagnose.forward.sampling import DriveSampling
from tyrefem.diagnose.unknowns.candidates import Candidate


@dataclass(frozen=True)
class Movement(Brief):
    """The largest change of a reading (mean of a block) by an effect, K, with its sign; its sensor and run."""

    kelvin: float
    sensor: str
    run: str

    def _title(self) -> str:
        return self.words

    @property
    def words(self) -> str:
        """The change with sensor and run; infinite if no tyre is possible without the effect."""
        if not math.isfinite(self.kelvin):
            return f"cannot be left out, as no tyre can be computed without it ({self.run})"
        decimals = 1 if abs(self.kelvin) >= 1 else 2
        return f"moves readings by up to {self.kelvin:+z.{decimals}f} K ({self.sensor}, {self.run})"


Movements = Mapping[Candidate, Movement]


def movements(residuals: Residuals, predictions: Predictions, fit: FittedSet) -> dict[Candidate, Movement]:
    """What every member of a fitted set moves in all runs: the fit, minus the fit without the member."""
    numbers = list(range(len(residuals.runs)))
    questions = []
    for member in fit.members:
        others = tuple(each for each in fit.members if each != member)
        left = {unknown: x for unknown, x in fit.values.items() if unknown not in member.unknowns}
        questions.append((others, left))
    result = {}
    for member, answers in zip(fit.members, predictions.predict(questions, numbers), strict=True):
        changes = [fit.computed[i] - residuals.corrected(i, answer) for i, answer in zip(numbers, answers, strict=True)]
        result[member] = largest_change(residuals.runs, changes)
    return result


def largest_change(drives: Sequence[DriveSampling], changes: Sequence[np.ndarray]) -> Movement:
    """The largest of the changes by run (n_blocks,), K; infinite if the tyre is impossible without the effect."""
    best = Movement(0.0, "", "")
    for drive, change in zip(drives, changes, strict=True):
        for sensor, place in drive.parts().items():
            part = change[place]
            if not np.isfinite(part).all():
                return Movement(math.inf, sensor, drive.name)
            most = float(part[np.abs(part).argmax()])
            if abs(most) > abs(best.kelvin) or not best.sensor:
                best = Movement(most, sensor, drive.name)
    return best
