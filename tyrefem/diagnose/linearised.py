"""The gap between data and study: residuals of every run, and how they change with every unknown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.evaluations import Laboratory
from tyrefem.diagnose.evidence import Linear
from tyrefem.diagnose.forward_model import Response
from tyrefem.diagnose.multifidelity import Predictions
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns import Unknown

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Gap(Brief):
    """What is measured minus what the study says, and how it changes with every unknown.

    Parameters
    ----------
    lab : simulates. unknowns : nuisance first. nuisance : how many belong to every model.
    correction : per trial, what the study's own mesh adds to the coarse one. jacobians : per trial (n_blocks, k).
    responses : what these were sampled from; of use for other data at the same drives.
    predictions : who says what other points read; None: lean simulations.
    """

    lab: Laboratory
    unknowns: tuple[Unknown, ...]
    nuisance: int
    correction: tuple[Array, ...]
    computed: tuple[Array, ...]
    jacobians: tuple[Array, ...]
    responses: tuple[Response, ...] = ()
    predictions: Predictions | None = None
    settings: DiagnosisSettings = DEFAULT

    @cached_property
    def predicted(self) -> Predictions:
        """Predictions and tangents of the trials."""
        return self.predictions or Predictions(self.lab)

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

        That was found at x = 0; the error of a mesh grows with the heat, so it is scaled by the rise above the start,
        all sensors together: one near the surface may hardly rise, and be far off for the gradient it sits in.
        """
        start, own = self._start[number], self.computed[number]
        before, after = (float(np.mean((values - start) ** 2)) for values in (own, computed))
        scale = np.clip(np.sqrt(after / before), *self.settings.mesh_error_scales) if before > 1.0 else 1.0
        return np.asarray(computed + self.correction[number] * scale)

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
