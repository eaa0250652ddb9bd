"""What a comparison needs of a result; unlike a result, small enough to come from another process, or from a file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.compare.interface import PhaseLike, ResultLike

if TYPE_CHECKING:
    import pandas as pd

Arrays = tuple[NDArray[Any], ...]


@dataclass(frozen=True, eq=False)
class Computed:
    """Readings and their gradients of a run, see `ResultLike`."""

    study: Any
    readings: pd.DataFrame
    gradient_at_sensors: pd.DataFrame
    phases: Sequence[PhaseLike]


@dataclass(frozen=True)
class Stretch:
    """A phase as far as a comparison knows it: ``start`` and ``end`` in s."""

    name: str
    start: float
    end: float


def computed_of(result: ResultLike) -> Computed:
    """The same of a whole result."""
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
    """The run of a study again; raises ValueError if these are not its arrays."""
    import pandas as pd

    columns, readings, gradients, names, spans = arrays
    tables = [pd.DataFrame(values, columns=[str(name) for name in columns]) for values in (readings, gradients)]
    stretches = [Stretch(str(name), float(a), float(b)) for name, (a, b) in zip(names, spans, strict=True)]
    return Computed(study, tables[0], tables[1], stretches)
