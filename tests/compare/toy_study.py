"""A study small enough to know its answer: each sensor warms as T0 + rise (1 - exp(-t / tau))."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd

from tyrefem.measured import MeasuredRun

RISES = {"crown": 40.0, "shoulder": 60.0, "contained-air": 15.0}
AMBIENT, TAU = 25.0, 300.0


@dataclass(frozen=True)
class Sensor:
    position_sd: float = 0.0
    noise: float = 0.5
    accuracy: float = 0.0
    lag: float = 0.0


@dataclass(frozen=True)
class Phase:
    name: str
    start: float
    end: float


@dataclass(frozen=True)
class Entry:
    table: Path
    drive: dict = field(default_factory=dict)
    run: str | None = None
    hold_out: bool = False
    noise: float | None = None
    time_offset: float = 0.0
    rename: dict = field(default_factory=dict)
    ignore: tuple = ()


@dataclass(frozen=True)
class Study:
    """``heat`` scales the rise, ``air`` shifts every temperature; ``speed`` of the drive scales the rise too."""

    name: str = "toy"
    sensors: dict = field(default_factory=lambda: {"crown": Sensor(), "shoulder": Sensor()})
    measured: tuple = ()
    uncertainty: dict = field(default_factory=dict)
    tolerance: float = 0.0
    numerical_sd: float = 0.1
    heat: float = 1.0
    air: float = 25.0
    speed: float = 1.0
    gradient: float = 0.0
    end: float = 1200.0
    rising: bool = True
    runs: list = field(default_factory=list, compare=False)

    def scaled(self, key, factor):
        return replace(self, **{key: getattr(self, key) * factor})

    def with_drive(self, drive):
        return replace(self, **{key.removeprefix("drive."): value for key, value in drive.items()})

    def run(self):
        self.runs.append((self.heat, self.air, self.speed))
        return Result(self)

    def at(self, sensor, times):
        shape = 1.0 - np.exp(-np.asarray(times) / TAU) if self.rising else np.ones_like(times)
        return self.air + RISES[sensor] * self.heat * self.speed * shape


@dataclass(frozen=True)
class Result:
    study: Study

    @property
    def phases(self):
        return (Phase("heating", 0.0, 600.0), Phase("holding", 600.0, self.study.end))

    @cached_property
    def readings(self):
        times = np.arange(0.0, self.study.end + 0.5, 1.0)
        return pd.DataFrame({"time_s": times, **{name: self.study.at(name, times) for name in RISES}})

    @property
    def gradient_at_sensors(self):
        times = self.readings["time_s"]
        held = {name: np.full(len(times), self.study.gradient) for name in self.study.sensors}
        return pd.DataFrame({"time_s": times, **held, "contained-air": np.nan})


def measured_from(study, times, *, name="run-1", bias=0.0, noise=0.0, delay=0.0, sensors=("crown", "shoulder")):
    """The run that a study would give, with a bias (computed - measured), noise, and a late clock."""
    rng = np.random.default_rng(7)
    times = np.asarray(times, dtype=float)
    frame = pd.DataFrame(
        {name: study.at(name, times - delay) - bias + noise * rng.normal(size=len(times)) for name in sensors}
    )
    return MeasuredRun(name, times, frame)
