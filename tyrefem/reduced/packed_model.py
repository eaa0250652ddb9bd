"""A reduced model as arrays for worker processes, which assemble its operators once, and variants computed with it."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache
from tyrefem.errors import InputError
from tyrefem.geometry.meshing.mapped import Counts
from tyrefem.reduced.answers import ReducedOutcome, learnt_outcomes, reduced_answers
from tyrefem.reduced.learnt_cycles import LearntCycles
from tyrefem.reduced.learnt_inputs import LearntInputs
from tyrefem.reduced.model import ReducedModel
from tyrefem.reduced.shape_operators import ShapeOperators
from tyrefem.reduced.shapes import tyre_of
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.variants.outcomes import Failed
from tyrefem.variants.task import Bundle, unpacked

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PackedModel:
    """A reduced model without its operators; the receiving process assembles them once on the same mesh.

    Parameters
    ----------
    base : the study that it was made for. V, samples, nodes_from_samples, hot, shapes, further, cycles : as in
        `ReducedModel`.
    inputs : as in `ReducedModel`.
    counts : rows and gaps of the mesh that all shapes of the section share; None: the section does not vary.
    """

    base: Bundle
    V: Array
    samples: Mapping[str, Array]
    nodes_from_samples: Array
    hot: Mapping[str, NDArray[np.intp]]
    counts: Counts | None = None
    shapes: ShapeOperators | None = None
    further: Array | None = None
    cycles: LearntCycles | None = None
    inputs: LearntInputs | None = None

    @functools.cached_property
    def digest(self) -> str:
        """Digest of the study and the modes."""
        without = [part is None for part in (self.shapes, self.further, self.cycles)]
        text = f"{self.base.digest} {self.counts} {without} {self.inputs and self.inputs.digest}"
        return hashlib.sha256(text.encode() + self.V.tobytes()).hexdigest()[:16]

    def unpacked(self) -> ReducedModel:
        """The reduced model, unpacked once per process."""
        return _models.get(
            self.digest,
            lambda: ReducedModel(
                base_of(self.base, self.counts),
                self.V,
                self.samples,
                self.nodes_from_samples,
                self.hot,
                self.shapes,
                self.further,
                self.cycles,
                self.inputs,
            ),
        )


def base_of(packed: Bundle, counts: Counts | None = None) -> RollingTyre:
    """The tyre of a study, built once per process; all variants use its mesh, or its topology (``counts``)."""
    return _bases.get((packed.digest, counts), lambda: tyre_of(unpacked(packed), counts))


def remember(packed: Bundle, base: RollingTyre) -> None:
    """Make `base_of` return this tyre in this process, unless it has a tyre of the same study."""
    _bases.get((packed.digest, _counts(base)), lambda: base)


def _counts(base: RollingTyre) -> Counts | None:
    return None if base.topology is None else base.topology.counts


def pack(model: ReducedModel, base: Bundle) -> PackedModel:
    """A model packed for other processes; ``base``: the study that it was made for."""
    arrays = (model.V, model.samples, model.nodes_from_samples, model.hot)
    return PackedModel(base, *arrays, _counts(model.base), model.shapes, model.further, model.cycles, model.inputs)


#: Models and tyres that a process keeps: two sweeps may run on threads of one worker.
KEPT = 2
_models: Cache[ReducedModel] = Cache(KEPT)
_bases: Cache[RollingTyre] = Cache(KEPT)


@dataclass(frozen=True, eq=False)
class ReducedTask:
    """Variants for the reduced model: their changes, in order. ``time_to``: see `answers`."""

    changes: Sequence[Mapping[str, Any]]
    time_to: float | None = None


def perform_reduced(task: ReducedTask, packed: PackedModel) -> tuple[ReducedOutcome, ...]:
    """Run in a worker: the outcome of every variant, in the order of the task."""
    model = packed.unpacked()
    learnt = learnt_outcomes(model, task.changes, task.time_to)
    if learnt is not None:
        return tuple(learnt)
    outcomes: dict[int, ReducedOutcome] = {}
    studies, places = [], []
    for place, changes in enumerate(task.changes):
        try:
            studies.append(model.base.study.replace(changes))
            places.append(place)
        except InputError as error:
            outcomes[place] = Failed(str(error))
    outcomes |= dict(zip(places, reduced_answers(model, studies, task.time_to), strict=True))
    return tuple(outcomes[place] for place in range(len(task.changes)))
