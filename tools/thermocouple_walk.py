"""Follow a thermocouple through a real diagnosis: from its column in a CSV file to the verdict.

One reading is a number that no other reading is. A module is on the walk where one of its functions hands on the text
of the file with it, an array, table or object that has it, or what is made of the readings: the classes of `MADE_OF`.
A search fits again and again; what counts is that everything is handed on forwards: to a module that stands later on
the walk, never back. `tyrefem.diagnose.workflow` calls the others in turn and makes the diagnosis of what they give,
so that it stands behind them. The room `tyrefem.api` counts as a whole: its modules only call, and change the class.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from graphlib import TopologicalSorter
from pathlib import Path
from typing import Any

import numpy as np
from hand_overs import Follower, Step, last_form, parts

STUDY = "nasa-22x5.5-8pr"
CHANGES = {"mesh.size": "16 mm", "drive.duration": "120 s"}
#: Candidates of the diagnosis: few, as each costs a simulation.
CANDIDATES = ("sun", "sensor-offset")
SENSORS = ("crown-inner", "crown-middle")
#: The reading, degC, and its number in the first column.
READING, NUMBER = 26.871337, 4
#: Classes of what is made of the readings.
MADE_OF = (
    "Residuals",
    "FittedSet",
    "ScoredSet",
    "RankedSet",
    "Ranking",
    "Judgement",
    "DiagnosisData",
    "Diagnosis",
)
#: The room of methods, on the walk as a whole.
METHODS = "tyrefem.api"
#: Longer lists are not looked into: no list of objects that hold readings is as long.
LONG = 200


@dataclass(frozen=True)
class ThermocoupleWalk:
    """Steps in their order."""

    steps: tuple[Step, ...]

    @property
    def modules(self) -> tuple[str, ...]:
        """Every module on the walk, each behind all that hand anything to it; else in the order of the first steps.

        Raises
        ------
        graphlib.CycleError : something is handed back to a module from which it has come.
        """
        first = list(dict.fromkeys(step.module for step in self.steps if step.module != step.taker))
        order = TopologicalSorter({module: self._givers(module) & set(first) for module in first})
        order.prepare()
        modules: list[str] = []
        ready: set[str] = set()
        while order.is_active():
            ready |= set(order.get_ready())
            modules.append(min(ready, key=first.index))
            ready.discard(modules[-1])
            order.done(modules[-1])
        return tuple(modules)

    def _givers(self, module: str) -> set[str]:
        return {step.module for step in self.steps if step.taker == module != step.module}

    def form(self, module: str) -> str:
        """What a module hands on to another one at last."""
        return last_form(self.steps, module)


def whole(module: str) -> str:
    """A module as it counts on the walk."""
    return METHODS if module.startswith(f"{METHODS}.") else module


def holds_reading(value: Any) -> bool:
    """Is it the reading, something that has it, or something made of the readings?"""
    return _holds(value, depth=2)


def _holds(value: Any, depth: int) -> bool:
    # The most frequent kinds first.
    if type(value) is float:
        return abs(value - READING) < 1e-9
    if type(value) is np.ndarray:
        return value.dtype.kind == "f" and bool((np.abs(value - READING) < 1e-9).any())
    if value is None or isinstance(value, bool | int):
        return False
    if type(value).__name__ in MADE_OF and type(value).__module__.startswith("tyrefem."):
        return True
    if isinstance(value, str):
        return f"{READING}" in value
    if isinstance(value, float):
        return bool(abs(value - READING) < 1e-9)
    if hasattr(value, "to_numpy"):
        value = value.to_numpy()
    if isinstance(value, np.ndarray):
        return value.dtype.kind == "f" and bool(np.any(np.abs(value - READING) < 1e-9))
    inside: Iterable[Any] = ()
    if isinstance(value, Mapping):
        inside = value.values() if len(value) < LONG else ()
    elif isinstance(value, list | tuple):
        inside = value if len(value) < LONG else ()
    elif depth > 0:
        depth, inside = depth - 1, parts(value)
    return any(_holds(part, depth) for part in inside)


def thermocouple_walk() -> ThermocoupleWalk:
    """Write a table as a logger would, diagnose the study with it, and follow the reading."""
    import pandas as pd

    import tyrefem as tf
    from tyrefem.diagnose.settings import DiagnosisSettings
    from tyrefem.effects import catalogue

    excluded = [name for name in catalogue() if name not in CANDIDATES]
    study = tf.study(STUDY, CHANGES | {"diagnosis.exclude": excluded})
    computed = study.run().readings
    times = np.arange(5.0, 120.0, 10.0)
    columns = {f"{name} [degC]": np.interp(times, computed["time_s"], computed[name]) for name in SENSORS}
    # All readings of the column are off alike, as an offset of the sensor explains: one alone would be heat of unknown
    # origin, and other strain laws would be tried.
    first = columns[f"{SENSORS[0]} [degC]"]
    first += READING - first[NUMBER]
    first[NUMBER] = READING
    settings = DiagnosisSettings(mesh_size=CHANGES["mesh.size"], largest=1, looks=1, readings_every=20.0)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "run.csv"
        pd.DataFrame({"time [s]": times, **columns}).to_csv(file, index=False)
        with Follower(holds_reading) as follower:
            study.diagnose(file, settings=settings, rerun=False, verdict_only=True)
    steps = (replace(step, module=whole(step.module), taker=whole(step.taker)) for step in follower.steps)
    return ThermocoupleWalk(tuple(steps))
