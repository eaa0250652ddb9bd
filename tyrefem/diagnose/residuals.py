"""Measured minus computed temperatures of every run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.linear_model import LinearModel
from tyrefem.diagnose.runs import Trial
from tyrefem.diagnose.sensitivities import DriveResponse, Sensitivities
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns import Unknown
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Residuals(Brief):
    """What is measured minus what the study computes, run by run.

    Parameters
    ----------
    study : the study. trials : the measured runs. sensitivities : what is computed, and how it changes with unknowns.
    """

    study: StudyData
    trials: tuple[Trial, ...]
    sensitivities: Sensitivities
    settings: DiagnosisSettings = DEFAULT

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Everything that may be fitted, nuisance first."""
        return self.sensitivities.unknowns

    @property
    def nuisance(self) -> int:
        """How many unknowns belong to every model."""
        return self.sensitivities.nuisance

    @property
    def computed(self) -> tuple[Array, ...]:
        """Per trial (n_blocks,) degC on the coarse mesh, with the study as it is."""
        return self.sensitivities.computed

    @property
    def whitened(self) -> tuple[Array, ...]:
        """Per trial (n_blocks, k): whitened sensitivities."""
        return self.sensitivities.whitened

    @property
    def responses(self) -> tuple[DriveResponse, ...]:
        """Of the drives; of use for other data at the same drives."""
        return self.sensitivities.responses

    @property
    def fitted(self) -> list[int]:
        """Numbers of the trials that are fitted."""
        return self.sensitivities.fitted

    @property
    def held_out(self) -> list[int]:
        """Numbers of the trials that are held out."""
        return self.sensitivities.held_out

    def driven(self, number: int) -> StudyData:
        """The study at the drive of a trial."""
        drive = self.trials[number].drive
        return self.study.with_drive(drive) if drive else self.study

    @cached_property
    def _start(self) -> tuple[float, ...]:
        return tuple(self.driven(number).card.drive.initial for number in range(len(self.trials)))

    def corrected(self, number: int, computed: Array) -> Array:
        """Block means of a trial on the coarse mesh with what the study's own mesh adds.

        That was found at x = 0; the error of a mesh grows with the heat, so it is scaled by the rise above the start,
        all sensors together: one near the surface may hardly rise, and be far off for the gradient it sits in.
        """
        start, origin = self._start[number], self.computed[number]
        before, after = (float(np.mean((values - start) ** 2)) for values in (origin, computed))
        scale = np.clip(np.sqrt(after / before), *self.settings.mesh_error_scales) if before > 1.0 else 1.0
        return np.asarray(computed + self.sensitivities.correction[number] * scale)

    def residual(self, number: int, computed: Array) -> Array:
        """Whitened measured - computed of one trial, from block means on the coarse mesh."""
        trial = self.trials[number]
        return trial.whitened(trial.measured - self.corrected(number, computed))

    def linear(self, trials: Sequence[int]) -> LinearModel:
        """The linear model of some trials about x = 0."""
        data = np.concatenate([self.residual(number, self.computed[number]) for number in trials])
        return LinearModel(self.sensitivities.design(trials), data)


def residuals_of(
    study: StudyData, trials: tuple[Trial, ...], sensitivities: Sensitivities, settings: DiagnosisSettings = DEFAULT
) -> Residuals:
    """The residuals of measured runs.

    Raises
    ------
    InputError : runs and sensitivities are of other drives.
    """
    if [trial.size for trial in trials] != [drive.size for drive in sensitivities.drives]:
        raise InputError("the measured runs are read at other times than the sensitivities")
    return Residuals(study, trials, sensitivities, settings)
