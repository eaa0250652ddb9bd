"""How well a set of effects explains the data: what a search compares, beside the prior of the set."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from tyrefem.diagnose.candidates import Members
from tyrefem.diagnose.fits import FittedSet
from tyrefem.diagnose.linear_model import LinearModel


class Criterion(Protocol):
    """ln p(data | set) or an approximation to it, nats: differences of two sets count, larger is better."""

    def of_fit(self, fit: FittedSet) -> float:
        """Of a set fitted with the full model."""
        ...

    def of_linear(self, model: LinearModel, members: Members) -> float:
        """Of a set in a linear model, without the constant -|d|^2/2 that all its sets share."""
        ...


@dataclass(frozen=True)
class LogEvidence:
    """ln of the evidence: the likelihood with every unknown integrated out under its prior and bounds.

    Of a fit in Laplace's approximation about its best point.
    """

    def of_fit(self, fit: FittedSet) -> float:
        """Of a set fitted with the full model."""
        return fit.log_evidence

    def of_linear(self, model: LinearModel, members: Members) -> float:
        """Of a set in a linear model, without the constant -|d|^2/2 that all its sets share."""
        return model.log_evidence(members)


@dataclass(frozen=True)
class BIC:
    """-BIC/2 = -misfit/2 - k ln(n)/2 for k fitted parameters of effects and n readings (blocks).

    The misfit holds the priors of base numbers and sensors, which belong to every set and are not counted in k. Needs
    no prior of an amplitude to be right, and takes every parameter for equally well determined.

    Source: Schwarz, The Annals of Statistics 6 (1978) 461-464.
    """

    def of_fit(self, fit: FittedSet) -> float:
        """Of a set fitted with the full model."""
        effects = {unknown for member in fit.members for unknown in member.unknowns}
        k = sum(unknown in effects for unknown in fit.unknowns)
        return -fit.misfit / 2 - k * math.log(fit.readings) / 2

    def of_linear(self, model: LinearModel, members: Members) -> float:
        """Of a set in a linear model, without the constant -|d|^2/2 that all its sets share."""
        k = sum(len(member.amplitudes) for member in members)
        return -model.least_misfit(members) / 2 - model.constant - k * math.log(len(model.data)) / 2
