"""Criteria by which a search compares sets of effects, in addition to the prior of a set."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.inference.linear_model import LinearModel
from tyrefem.diagnose.inference.set_evidences import SetEvidences
from tyrefem.diagnose.unknowns.candidates import Members

Array = NDArray[Any]


class Criterion(Protocol):
    """ln p(data | set) or an approximation of it, nats; only differences between sets count, larger is better."""

    def of_fit(self, fit: FittedSet) -> float:
        """Criterion of a set fitted with the full model."""
        ...

    def of_linear(self, model: LinearModel, sets: Sequence[Members]) -> Array:
        """(n_sets,) Criterion of sets in a linear model, without the constant -|d|^2/2 that all sets share."""
        ...


@dataclass(frozen=True)
class LogEvidence:
    """ln of the evidence: the likelihood with every unknown integrated out under its prior and bounds.

    For a fit it is Laplace's approximation about the best point.
    """

    def of_fit(self, fit: FittedSet) -> float:
        """Criterion of a set fitted with the full model."""
        return fit.log_evidence

    def of_linear(self, model: LinearModel, sets: Sequence[Members]) -> Array:
        """(n_sets,) Criterion of sets in a linear model, without the constant -|d|^2/2 that all sets share."""
        return SetEvidences(model.design, sets).log_evidence(model.overlap)


@dataclass(frozen=True)
class BIC:
    """-BIC/2 = -misfit/2 - k ln(n)/2 for k fitted parameters of effects and n readings (blocks).

    The misfit includes the priors of base numbers and sensors. These belong to every set and are not counted in k. BIC
    does not depend on the priors of the amplitudes; it treats all parameters as equally well determined.

    Source: Schwarz, The Annals of Statistics 6 (1978) 461-464.
    """

    def of_fit(self, fit: FittedSet) -> float:
        """Criterion of a set fitted with the full model."""
        effects = {unknown for member in fit.members for unknown in member.unknowns}
        k = sum(unknown in effects for unknown in fit.unknowns)
        return -fit.misfit / 2 - k * math.log(fit.readings) / 2

    def of_linear(self, model: LinearModel, sets: Sequence[Members]) -> Array:
        """(n_sets,) Criterion of sets in a linear model, without the constant -|d|^2/2 that all sets share."""
        k = np.array([sum(len(member.amplitudes) for member in members) for members in sets])
        misfits = np.array([model.least_misfit(members) for members in sets])
        return -misfits / 2 - model.constant - k * math.log(len(model.data)) / 2
