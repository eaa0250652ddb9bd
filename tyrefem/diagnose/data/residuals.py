"""Measured minus computed temperatures of every run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.data.runs import MeasuredDrive
from tyrefem.diagnose.data.sensitivities import Sensitivities
from tyrefem.diagnose.forward.drive_response import DriveResponse
from tyrefem.diagnose.inference.linear_model import DesignMatrix, LinearModel
from tyrefem.diagnose.inference.shared_error import SharedError
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Residuals(Brief):
    """Measured minus computed temperatures, run by run.

    Parameters
    ----------
    study : the study. runs : the measured runs. sensitivities : computed block means and their derivatives.
    shared_error : error of the model that the readings share; None: none beyond each sensor's own.
    offset : by run (n_blocks,) K, a known error of the computed temperatures, which is added; empty: none.
    """

    study: StudyData
    runs: tuple[MeasuredDrive, ...]
    sensitivities: Sensitivities
    settings: DiagnosisSettings = DEFAULT
    shared_error: SharedError | None = None
    offset: tuple[Array, ...] = ()

    def beside(
        self, nuisance: Sequence[Unknown], shared_error: SharedError | None, offset: tuple[Array, ...] = ()
    ) -> Residuals:
        """The residuals with further unknowns in every set, an error that readings share and a known error."""
        sensitivities = self.sensitivities.with_nuisance(nuisance) if nuisance else self.sensitivities
        return replace(self, sensitivities=sensitivities, shared_error=shared_error, offset=offset)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """All unknowns that may be fitted, nuisance unknowns first."""
        return self.sensitivities.unknowns

    @property
    def nuisance(self) -> int:
        """Number of unknowns that belong to every model."""
        return self.sensitivities.nuisance

    @property
    def computed(self) -> tuple[Array, ...]:
        """By run (n_blocks,) degC on the coarse mesh at x = 0."""
        return self.sensitivities.computed

    @property
    def whitened(self) -> tuple[Array, ...]:
        """By run (n_blocks, k): whitened sensitivities."""
        return self.sensitivities.whitened

    @property
    def responses(self) -> tuple[DriveResponse, ...]:
        """Responses of the drives, reusable for other data at the same drives."""
        return self.sensitivities.responses

    @property
    def fitted(self) -> list[int]:
        """Numbers of the fitted runs."""
        return self.sensitivities.fitted

    @property
    def held_out(self) -> list[int]:
        """Numbers of the held-out runs."""
        return self.sensitivities.held_out

    def driven(self, number: int) -> StudyData:
        """The study at the drive of a run, with the effects that act in it."""
        return self.study.at_run(self.runs[number].run, self.runs[number].drive)

    @cached_property
    def _start(self) -> tuple[float, ...]:
        return tuple(self.driven(number).card.drive.initial for number in range(len(self.runs)))

    def corrected(self, number: int, computed: Array) -> Array:
        """Block means of a run on the coarse mesh plus the correction to the study's mesh.

        The correction is known at x = 0. The error of a mesh grows with the heat, so the correction is scaled with the
        rise above the initial temperature, rms over all sensors. The rise of a single sensor is no measure: near the
        surface it is small, while the gradient and the error are large.
        """
        start, origin = self._start[number], self.computed[number]
        before, after = (float(np.mean((values - start) ** 2)) for values in (origin, computed))
        scale = np.clip(np.sqrt(after / before), *self.settings.mesh_error_scales) if before > 1.0 else 1.0
        return np.asarray(computed + self.sensitivities.correction[number] * scale)

    def residual(self, number: int, computed: Array) -> Array:
        """Whitened measured - computed of a run, from block means on the coarse mesh."""
        run = self.runs[number]
        off = self.offset[number] if self.offset else 0.0
        return run.whitened(run.measured - self.corrected(number, computed) - off)

    def joined(self, parts: Sequence[Array]) -> Array:
        """Whitened rows of the fitted runs, one run after the other; a shared error is whitened too."""
        rows = np.concatenate(parts)
        return rows if self.shared_error is None else self.shared_error.whitened(rows)

    @property
    def log_det(self) -> float:
        """ln of the volume that a shared error adds to the readings' scatter; 0 without one."""
        return 0.0 if self.shared_error is None else self.shared_error.log_det

    @cached_property
    def design(self) -> DesignMatrix:
        """The design matrix of the fitted runs about x = 0."""
        return DesignMatrix(self.unknowns, self.nuisance, self.joined([self.whitened[i] for i in self.fitted]))

    def linear(self, runs: Sequence[int]) -> LinearModel:
        """The linear model of some runs about x = 0; a shared error counts for the fitted runs only."""
        parts = [self.residual(number, self.computed[number]) for number in runs]
        if self.shared_error is None or list(runs) != self.fitted:
            return LinearModel(self.sensitivities.design(runs), np.concatenate(parts))
        return LinearModel(self.design, self.joined(parts))


def residuals_of(
    study: StudyData,
    runs: tuple[MeasuredDrive, ...],
    sensitivities: Sensitivities,
    settings: DiagnosisSettings = DEFAULT,
) -> Residuals:
    """The residuals of measured runs.

    Raises
    ------
    InputError : the runs and the sensitivities have different drives.
    """
    if [run.size for run in runs] != [drive.size for drive in sensitivities.drives]:
        raise InputError("the times of the measured runs differ from those of the sensitivities")
    return Residuals(study, runs, sensitivities, settings)
