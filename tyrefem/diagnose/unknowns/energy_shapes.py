"""Unknowns for another strain energy along the meridian: smooth factors on the heat."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.unknown import Unknown, of_effect
from tyrefem.effects import catalogue
from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]


#: The effect that changes the strain energy along the meridian.
SHAPE = "heat-shape"


def energy_shapes(study: StudyData, settings: DiagnosisSettings) -> tuple[Unknown, ...]:
    """Half waves of ln(factor) along the meridian, with independent priors; without those that the study has.

    ln(factor) has the standard deviation ``energy_sd``, on average over the meridian, and the spectrum of a Gaussian
    process of the Matern family that is alike over ``energy_length`` L, once differentiable: variance of n half waves
    ~ (2 - [n = 0]) / (1 + (n pi length)^2)^2.
    """
    effect = catalogue()[SHAPE]
    present = {tuple(each.choice.items()) for each in study.card.effects if each.name == SHAPE}
    shares = [
        (1 if n == 0 else 2) / (1 + (n * math.pi * settings.energy_length) ** 2) ** 2
        for n in range(settings.energy_modes)
    ]
    # cos^2 is one half on average.
    mean = shares[0] + sum(shares[1:]) / 2
    choices = [(("half_waves", str(n)),) for n in range(len(shares))]
    return tuple(
        of_effect(effect, choice, settings.energy_sd * math.sqrt(share / mean))[0]
        for choice, share in zip(choices, shares, strict=True)
        if choice not in present
    )


def courses(places: Array, unknowns: Sequence[Unknown]) -> Array:
    """(n, k) courses of ln(factor) of the unknowns at places from 0 (crown) to 1 (bead)."""
    half_waves = np.array([float(dict(unknown.choice)["half_waves"]) for unknown in unknowns])
    return np.asarray(np.cos(np.pi * np.outer(places, half_waves)))
