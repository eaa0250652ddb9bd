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
from tyrefem.reduced.answers import reduced_answers
from tyrefem.reduced.model import ReducedModel
from tyrefem.rolling import RollingTyre
from tyrefem.sweep.bundle import Bundle

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Packed:
    """A reduced model without its operators: who unpacks it assembles them once on the same mesh.

    Parameters
    ----------
    base : the study it was made for. V, samples, nodes_from_samples, hot : as `ReducedModel` has them.
    """

    base: Bundle
    V: Array
    samples: Mapping[str, Array]
    nodes_from_samples: Array
    hot: Mapping[str, NDArray[np.intp]]

    @functools.cached_property
    def digest(self) -> str:
        """Of study and modes."""
        return hashlib.sha256(self.base.digest.encode() + self.V.tobytes()).hexdigest()[:16]

    def unpacked(self) -> ReducedModel:
        """The model again, once per process."""
        if self.digest not in _MODELS:
            _MODELS.clear()
            _MODELS[self.digest] = ReducedModel(
                base_of(self.base), self.V, self.samples, self.nodes_from_samples, self.hot
            )
        return _MODELS[self.digest]


def base_of(packed: Bundle) -> RollingTyre:
    """The tyre of a study, whose mesh and operators serve all its variants; once per process."""
    if packed.digest not in _BASES:
        from tyrefem.sweep.task import unpacked

        remember(packed, RollingTyre(unpacked(packed)))
    return _BASES[packed.digest]


def remember(packed: Bundle, base: RollingTyre) -> None:
    """Let this tyre be the one that `base_of` gives here."""
    _BASES.clear()
    _BASES[packed.digest] = base


def pack(model: ReducedModel, base: Bundle) -> Packed:
    """A model to be sent to other processes; ``base`` is the study it was made for."""
    return Packed(base, model.V, model.samples, model.nodes_from_samples, model.hot)


_MODELS: dict[str, ReducedModel] = {}
_BASES: dict[str, RollingTyre] = {}


@dataclass(frozen=True, eq=False)
class ReducedTask:
    """Variants to be marched side by side: their changes, in order."""

    changes: Sequence[Mapping[str, Any]]
    time_to: float | None = None


def perform_reduced(task: ReducedTask, packed: Packed) -> dict[str, Any]:
    """``{"outcomes": [...]}``, one per variant: ``answers``, ``failure`` or ``not_reducible``."""
    model = packed.unpacked()
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
