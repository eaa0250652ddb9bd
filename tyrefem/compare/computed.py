"""What a comparison needs of a result; unlike a result, small enough to come from another process."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from tyrefem.compare.interface import PhaseLike, ResultLike

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class Computed:
    """Readings and their gradients of a run, see `ResultLike`."""

    study: Any
    readings: pd.DataFrame
    gradient_at_sensors: pd.DataFrame
    phases: Sequence[PhaseLike]


def computed_of(result: ResultLike) -> Computed:
    """The same of a whole result."""
    return Computed(result.study, result.readings, result.gradient_at_sensors, result.phases)
