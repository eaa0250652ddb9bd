"""Training: modes and sample places from snapshots of a few full runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.reduced.model import ReducedModel
from tyrefem.reduced.modes import modes, places
from tyrefem.result import Result
from tyrefem.rolling import RollingTyre

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Fineness:
    """How fine a reduced model is.

    Parameters
    ----------
    modes_tolerance : rms of the temperature over the snapshots that the modes may leave out, K.
    source_tolerance : share of the heat sources that their modes may leave out.
    most_modes, most_sources : at most.
    fields : temperature fields taken of every run.
    """

    modes_tolerance: float = 2e-4
    source_tolerance: float = 2e-6
    most_modes: int = 70
    most_sources: int = 60
    fields: int = 40


@dataclass(frozen=True, eq=False)
class Snapshots:
    """What one full run teaches.

    Parameters
    ----------
    fields : (k, n) degC. sources : (k', all zones' nodes) W/m3, zone after zone.
    """

    fields: Array
    sources: Array


def snapshots(result: Result, count: int) -> Snapshots:
    """Fields and heat sources of a run, dense where temperatures change fast: after every start of a phase."""
    times, tyre = result.times, result.tyre
    spread = np.unique(np.round(np.linspace(0, len(times) - 1, count)).astype(int))
    early = [int(np.searchsorted(times, start)) + k for start in tyre.drive.starts for k in (0, 1, 2, 3)]
    numbers = np.unique(np.clip(np.concatenate([spread, early]), 0, len(times) - 1))
    sources = []
    for i in numbers:
        by_zone = result.heat_source(int(i))
        sources.append(np.concatenate([q for _, q in by_zone.values()]))
    return Snapshots(np.asarray(result.history.values)[numbers], np.array(sources))


def source_snapshots(tyre: RollingTyre, fields: Array) -> Array:
    """(phases x k, all zones' nodes) heat sources of another variant at fields that are known: no run is needed.

    A source is made by the variant's strain cycle and tan delta; the temperature only has to be a likely one.
    """
    ops, found = tyre.problem.operators, []
    for start, phase in zip(tyre.drive.starts, tyre.drive.phases, strict=True):
        for field in fields:
            parts = [
                source(ops.nodes(zone), start + phase.duration / 2, field[ops.dofs(zone)])
                for zone, source in tyre.sources.items()
            ]
            found.append(np.concatenate(parts))
    return np.array(found)


def trained(
    base: RollingTyre, learnt: Sequence[Snapshots], more_sources: Array | None = None, choice: Fineness | None = None
) -> ReducedModel:
    """A reduced model on a tyre's mesh.

    Parameters
    ----------
    learnt : of full runs of variants on that mesh. more_sources : from `source_snapshots`.
    """
    choice = choice or Fineness()
    ops = base.problem.operators
    V = modes(np.vstack([one.fields for one in learnt]), ops.mean_weight(), choice.modes_tolerance, choice.most_modes)
    heats = np.vstack([*(one.sources for one in learnt), *([] if more_sources is None else [more_sources])])
    largest = np.abs(heats).max(axis=1)
    # All of a like size: a slow variant's sources are to be met as well as a fast one's.
    heats = heats[largest > 0] / largest[largest > 0][:, None] if largest.any() else heats[:1] + 1.0
    chosen, everywhere = places(heats, choice.source_tolerance, choice.most_sources)
    zones = list(base.sources)
    ends = np.cumsum([0, *(len(ops.dofs(zone)) for zone in zones)])
    samples = {
        zone: chosen[(chosen >= a) & (chosen < b)] - a for zone, a, b in zip(zones, ends[:-1], ends[1:], strict=True)
    }
    return ReducedModel(base, V, samples, everywhere)
