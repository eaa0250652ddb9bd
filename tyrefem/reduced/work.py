"""Variants of a reduced model as work for any process: the model travels as arrays."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.reduced.model import ReducedModel
from tyrefem.rolling import RollingTyre
from tyrefem.sweep.bundle import Bundle

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Packed:
    """A reduced model without its operators: who unpacks it assembles them once on the same mesh.

    Parameters
    ----------
    base : the study it was made for. V, samples, nodes_from_samples : as `ReducedModel` has them.
    """

    base: Bundle
    V: Array
    samples: Mapping[str, Array]
    nodes_from_samples: Array

    @functools.cached_property
    def digest(self) -> str:
        """Of study and modes."""
        return hashlib.sha256(self.base.digest.encode() + self.V.tobytes()).hexdigest()[:16]

    def unpacked(self) -> ReducedModel:
        """The model again, once per process."""
        if self.digest not in _MODELS:
            from tyrefem.sweep.task import unpacked

            _MODELS.clear()
            base = RollingTyre(unpacked(self.base))
            _MODELS[self.digest] = ReducedModel(base, self.V, self.samples, self.nodes_from_samples)
        return _MODELS[self.digest]


_MODELS: dict[str, ReducedModel] = {}


@dataclass(frozen=True, eq=False)
class ReducedTask:
    """Variants to be marched side by side: their changes, in order."""

    model: Packed
    changes: Sequence[Mapping[str, Any]]
    time_to: float | None = None


def perform_reduced(task: ReducedTask) -> dict[str, Any]:
    """``{"outcomes": [...]}``, one per variant: ``answers``, ``failure`` or ``not_reducible``."""
    from tyrefem.reduced.surrogate import reduced_answers

    model = task.model.unpacked()
    found: list[dict[str, Any]] = [{} for _ in task.changes]
    studies, places = [], []
    for place, changes in enumerate(task.changes):
        try:
            studies.append(model.base.study.replace(changes))
            places.append(place)
        except InputError as error:
            found[place] = {"failure": str(error)}
    for place, outcome in zip(places, reduced_answers(model, studies, task.time_to), strict=True):
        found[place] = outcome
    return {"outcomes": found}
