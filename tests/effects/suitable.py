"""A quick coarse study for every effect, in which it shows, and what must come out there."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

import tyrefem as tf
from tyrefem.api import Result
from tyrefem.effects import Effect, catalogue

COARSE = {
    "mesh.size": "8 mm",
    "mesh.element": "P1",
    "numerics.tolerance": "0.2 delta_degC",
    "drive.phases.rolling.duration": "200 s",
    "drive.phases.cooling.duration": "40 s",
    "output": {"every": "30 s", "fields": 2},
    "sensors.bead": {"s": "5.6 in", "depth": "0.3 in"},
    "sensors.surface": {"s": "0.30 in", "depth": "0.79 in"},
    "sensors.shoulder-edge": {"s": "1.80 in", "depth": "0.64 in"},
}
FAST = {"drive.phases.rolling.speed": "30 m/s"}
FULL = {"mesh.section": "full", "sensors.left": {"s": "-2.00 in", "depth": "0.07 in"}}


@dataclass(frozen=True)
class Case:
    """What a study needs for an effect to show, the choice of its variant, and the sign of what it does to columns.

    An effect without a case is tested all the same: in the coarse study, its first variant, whatever its sign.
    """

    signs: dict[str, int] = field(default_factory=dict)
    changes: dict[str, Any] = field(default_factory=dict)
    choice: dict[str, str] = field(default_factory=dict)


#: Effect at its prior's scale -> sign of the mean change of readings, as physics has it.
CASES = {
    "ambient-drift": Case({"sidewall-outer": 1, "shoulder-outer": 1, "contained-air": 1}),
    "bead-contact-resistance": Case({"bead": -1}, {"drive.rim_temperature": "90 degC"}),
    "belt-edge-shear": Case({"shoulder-inner": 1, "shoulder-outer": 1}),
    "brake-disc": Case(
        {"rim": 1, "bead": 1},
        {"boundaries.rim": {"law": "lumped", "mass": "9 kg", "cooling": "2 W/K", "air": "0.5 W/K"}},
    ),
    "brake-heat": Case({"bead": 1}),
    "brake-power": Case(
        {"rim": 1, "bead": 1},
        {"boundaries.rim": {"law": "lumped", "mass": "9 kg", "cooling": "2 W/K", "air": "0.5 W/K"}},
    ),
    "camber": Case({"shoulder-inner": 1, "sidewall-inner": 1, "left": -1}, FULL),
    "clock-offset": Case({"crown-inner": 1, "sidewall-outer": 1}, {"drive.phases.rolling.duration": "600 s"}),
    "conductivity-temperature": Case({"crown-inner": -1}, {"drive.initial": "100 degC"}),
    "cord-conduction": Case({"crown-inner": -1, "shoulder-inner": -1}),
    "gas-mass": Case({"contained-air": -1}, {"boundaries.contained_air": {"law": "report"}}),
    "gas-mixing": Case({"contained-air": 1, "crown-inner": -1}),
    "heat-capacity-temperature": Case({"crown-inner": -1, "shoulder-inner": -1}),
    "hot-road": Case({"shoulder-outer": 1, "crown-middle": 1}),
    "loss-speed-exponent": Case({"crown-inner": 1, "sidewall-inner": 1}, FAST),
    "loss-temperature-law": Case({"crown-inner": -1, "shoulder-inner": -1}),
    "outside-film-speed": Case({"sidewall-outer": -1}, FAST),
    "pressure-loss": Case({"crown-inner": 1, "sidewall-inner": 1}),
    "pressure-rise": Case({"crown-inner": -1, "sidewall-inner": -1}),
    "radiation": Case({"sidewall-outer": -1, "shoulder-outer": -1}),
    "road-film-speed": Case(
        {"surface": -1}, FAST | {"boundaries.road": {"law": "constant", "coefficient": "500 W/m**2/K"}}
    ),
    "sensor-lag": Case({"crown-inner": -1}, {"drive.phases.cooling.duration": "20 s"}, {"sensor": "crown-inner"}),
    "sensor-misplaced": Case({"crown-inner": -1}, choice={"sensor": "crown-inner"}),
    "sensor-offset": Case({"crown-inner": 1}, choice={"sensor": "crown-inner"}),
    "standing-wave": Case({"crown-inner": 1, "shoulder-inner": 1}, {"drive.phases.rolling.speed": "55 m/s"}),
    "sun": Case({"sidewall-outer": 1, "shoulder-outer": 1}),
    "swapped-channels": Case(
        {"crown-inner": -1, "sidewall-outer": 1}, choice={"sensor": "crown-inner", "other": "sidewall-outer"}
    ),
    "tread-slip": Case({"surface": 1, "shoulder-outer": 1}),
    "under-inflation-flexing": Case({"shoulder-inner": 1, "sidewall-inner": 1}, {"drive.load": "4000 lbf"}),
    "wet-road": Case({"surface": -1}, {"boundaries.road": {"law": "constant", "coefficient": "500 W/m**2/K"}}),
    "worn-tread": Case(
        {"shoulder-outer": -1, "shoulder-edge": -1},
        {"sensors.surface.depth": "0.55 in", "sensors.shoulder-edge.depth": "0.40 in"},
    ),
    "yaw": Case({"shoulder-edge": 1}, FULL, {"side": "right"}),
}  # fmt: skip
#: Every effect that a diagnosis may name.
NAMES = sorted(name for name, effect in catalogue().items() if not effect.calibration)


def case(name: str) -> Case:
    """What an effect needs to be tested."""
    return CASES.get(name, Case())


def choice(name: str) -> dict[str, str]:
    """The variant of an effect that is tested: of its case, else the first that its study has."""
    return case(name).choice or dict(catalogue()[name].variants(suitable(name))[0])


@functools.cache
def suitable(name: str) -> tf.Study:
    """The coarse study in which an effect shows."""
    return tf.study("example-validation").replace({**COARSE, **case(name).changes})


def entry(name: str, multiple: float) -> dict[str, Any]:
    """The effect's table in a study, its amplitudes at null plus a multiple of their scales."""
    amplitudes = [one for one in catalogue()[name].parameters() if one.prior.amplitude]
    values = {
        one.name: f"{one.prior.null + multiple * one.prior.scale!r} {'' if one.prior.unit == '1' else one.prior.unit}"
        for one in amplitudes
    }
    return {"name": name, **choice(name), **values}


def has_amplitude(effect: type[Effect]) -> bool:
    """Is there a number that says how strong the effect is?"""
    return any(one.prior.amplitude for one in effect.parameters())


@functools.cache
def _base(changes: str, name: str) -> Result:
    return suitable(name).run()


def base(name: str) -> Result:
    """The suitable study without the effect; run once for all effects that share it."""
    return _base(repr(case(name).changes), _first(repr(case(name).changes)))


@functools.cache
def _first(changes: str) -> str:
    return next(name for name in NAMES if repr(case(name).changes) == changes)


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
