"""The interface of studies and results that a comparison uses.

`Computed` is the part of a result that a comparison needs; it is small enough for other processes and for files.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas as pd


class SensorLike(Protocol):
    """Standard uncertainties of a sensor: position (m), noise (K), systematic accuracy (K)."""

    @property
    def position_sd(self) -> float: ...
    @property
    def noise(self) -> float: ...
    @property
    def accuracy(self) -> float: ...


class PhaseLike(Protocol):
    """A named stretch of the drive, start and end in s."""

    @property
    def name(self) -> str: ...
    @property
    def start(self) -> float: ...
    @property
    def end(self) -> float: ...


class MeasuredEntryLike(Protocol):
    """A ``[[measured]]`` entry of a study."""

    @property
    def table(self) -> str | Path: ...
    @property
    def drive(self) -> Mapping[str, Any]: ...
    @property
    def run(self) -> str | None: ...
    @property
    def hold_out(self) -> bool: ...
    @property
    def noise(self) -> float | None: ...
    @property
    def time_offset(self) -> float: ...
    @property
    def rename(self) -> Mapping[str, str]: ...
    @property
    def ignore(self) -> Sequence[str]: ...


class ResultLike(Protocol):
    """Computed readings (``time_s``, then degC per sensor), their gradients (K/m), the phases."""

    @property
    def readings(self) -> pd.DataFrame: ...
    @property
    def gradient_at_sensors(self) -> pd.DataFrame: ...
    @property
    def phases(self) -> Sequence[PhaseLike]: ...
    @property
    def study(self) -> Any: ...


class StudyLike(Protocol):
    """A study whose numbers and drive can be changed."""

    @property
    def name(self) -> str: ...
    @property
    def sensors(self) -> Mapping[str, SensorLike]: ...
    @property
    def measured(self) -> Sequence[MeasuredEntryLike]: ...
    @property
    def uncertainty(self) -> Mapping[str, float]: ...
    @property
    def tolerance(self) -> float: ...
    @property
    def numerical_sd(self) -> float: ...
    def scaled(self, key: str, factor: float) -> Self: ...
    def with_drive(self, drive: Any) -> Self: ...


Arrays = tuple[NDArray[Any], ...]


@dataclass(frozen=True, eq=False)
class Computed:
    """Readings and gradients of a run, see `ResultLike`."""

    study: Any
    readings: pd.DataFrame
    gradient_at_sensors: pd.DataFrame
    phases: Sequence[PhaseLike]


@dataclass(frozen=True)
class Stretch:
    """A phase of a drive with ``start`` and ``end`` in s."""

    name: str
    start: float
    end: float


def computed_of(result: ResultLike) -> Computed:
    """The readings, gradients and phases of a result."""
    return Computed(result.study, result.readings, result.gradient_at_sensors, result.phases)


def arrays_of(computed: Computed) -> Arrays:
    """A run as arrays: columns, readings, gradients, names of the phases, their starts and ends."""
    readings, phases = computed.readings, computed.phases
    return (
        np.array(readings.columns, dtype=str),
        readings.to_numpy(dtype=float),
        computed.gradient_at_sensors.to_numpy(dtype=float),
        np.array([phase.name for phase in phases], dtype=str),
        np.array([(phase.start, phase.end) for phase in phases], dtype=float).reshape(-1, 2),
    )


def computed_from(arrays: Arrays, study: Any) -> Computed:
    """The run of a study from its arrays, see `arrays_of`; raises ValueError for other arrays."""
    import pandas as pd

    columns, readings, gradients, names, spans = arrays
    tables = [pd.DataFrame(values, columns=[str(name) for name in columns]) for values in (readings, gradients)]
    stretches = [Stretch(str(name), float(a), float(b)) for name, (a, b) in zip(names, spans, strict=True)]
    return Computed(study, tables[0], tables[1], stretches)
