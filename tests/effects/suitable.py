"""A quick coarse study for every effect, in which it shows, and what must come out there."""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import Any

import numpy as np

import tyrefem as tf
from tyrefem.api import Result
from tyrefem.effects import Effect, catalogue
from tyrefem.effects.signature import SENSORS, STUDY, Signature

COARSE = {
    "mesh.size": "8 mm",
    "mesh.element": "P1",
    "numerics.tolerance": "0.2 delta_degC",
    "drive.phases.rolling.duration": "200 s",
    "drive.phases.cooling.duration": "40 s",
    "output": {"every": "30 s", "fields": 2},
    **SENSORS,
}
#: Every effect that a diagnosis may name.
NAMES = sorted(name for name, effect in catalogue().items() if not effect.calibration)


def signature(name: str) -> Signature:
    """What an effect says of how it shows."""
    return catalogue()[name].signature


def choice(name: str) -> dict[str, str]:
    """The variant of an effect that is tried: the one it says, else the first that its study has."""
    return dict(signature(name).choice or catalogue()[name].variants(suitable(name))[0])


@functools.cache
def suitable(name: str) -> tf.Study:
    """The coarse study in which an effect shows."""
    return tf.study(STUDY).replace({**COARSE, **signature(name).changes})


def entry(name: str, multiple: float) -> dict[str, Any]:
    """The effect's table in a study, its amplitudes at null plus a multiple of their scales."""
    amplitudes = [parameter for parameter in catalogue()[name].parameters() if parameter.prior.amplitude]
    values = {}
    for parameter in amplitudes:
        prior = parameter.prior
        unit = "" if prior.unit == "1" else prior.unit
        values[parameter.name] = f"{prior.null + multiple * prior.scale!r} {unit}"
    return {"name": name, **choice(name), **values}


def has_amplitude(effect: type[Effect]) -> bool:
    """Is there a number that says how strong the effect is?"""
    return any(parameter.prior.amplitude for parameter in effect.parameters())


@functools.cache
def _base(changes: str, name: str) -> Result:
    return suitable(name).run()


def base(name: str) -> Result:
    """The suitable study without the effect; run once for all effects that share it."""
    return _base(repr(signature(name).changes), _first(repr(signature(name).changes)))


@functools.cache
def _first(changes: str) -> str:
    return next(name for name in NAMES if repr(signature(name).changes) == changes)


@functools.cache
def result(name: str, multiple: float) -> Result:
    """The suitable study with the effect at a multiple of its scale."""
    study = suitable(name).replace({"effects": [entry(name, multiple)]})
    if catalogue()[name].only_measures():  # the tyre is the same; only what is read differs
        return replace(base(name), study=study)
    return study.run()


def change(name: str, multiple: float) -> np.ndarray:
    """What the effect does to the readings, (n_times, n_columns) K."""
    return (result(name, multiple).readings - base(name).readings).drop(columns="time_s").to_numpy()
