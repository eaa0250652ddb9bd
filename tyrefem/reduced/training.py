"""Training: modes and sample places from snapshots of a few full runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.operators import Operators
from tyrefem.reduced.model import ReducedModel
from tyrefem.reduced.pod import modes, places
from tyrefem.simulation.result import ResultData
from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]
#: A node within this share of a region's range below its highest temperature may be the hottest; ranges below, K, are
#: those of an even field.
NEAR, EVEN = 0.005, 0.5


@dataclass(frozen=True)
class ReducedFineness:
    """How fine a reduced model is.

    Parameters
    ----------
    modes_tolerance : rms of the temperature over the snapshots that the modes may leave out, K.
    source_tolerance : share of the heat sources that their modes may leave out.
    most_modes, most_sources : at most.
    fields : temperature fields taken of every run.
    """

    modes_tolerance: float = 4e-4
    source_tolerance: float = 8e-6
    most_modes: int = 120
    most_sources: int = 120
    fields: int = 14

    @classmethod
    def of(cls, tolerance: float) -> ReducedFineness:
        """Fine enough for a tolerance, K: modes leave out a twenty-fifth of it."""
        return cls(0.04 * tolerance, 8e-4 * tolerance)


#: Parts of a phase at which a training run gives a field: dense where temperatures change fast.
PARTS = np.array([0.005, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0])


@dataclass(frozen=True, eq=False)
class Snapshots:
    """What one full run teaches.

    Parameters
    ----------
    fields : (k, n) degC. sources : (k', all zones' nodes) W/m3, zone after zone: fewer, as a source changes slowly.
    """

    fields: Array
    sources: Array


def snapshots(result: ResultData, count: int) -> Snapshots:
    """Fields and heat sources of a run, dense where temperatures change fast: after every start of a phase."""
    times, tyre = result.times, result.tyre
    spread = np.unique(np.round(np.linspace(0, len(times) - 1, count)).astype(int))
    early = [int(np.searchsorted(times, start)) + k for start in tyre.drive.starts for k in (0, 1, 2, 3)]
    numbers = np.unique(np.clip(np.concatenate([spread, early]), 0, len(times) - 1))
    sources = []
    for i in numbers[::3]:
        by_zone = result.heat_source(int(i))
        sources.append(np.concatenate([q for _, q in by_zone.values()]))
    return Snapshots(np.asarray(result.history.values)[numbers], np.array(sources))


def training_run(tyre: RollingTyre, tolerance: float) -> Snapshots:
    """Snapshots of a full run that is made for nothing else; ``tolerance``: K, of its time integration."""
    ends = [*tyre.drive.starts, tyre.drive.end]
    times = np.concatenate([[0.0], *(a + (b - a) * PARTS for a, b in pairwise(ends))])
    problem = tyre.problem
    history = problem.transient(times, tyre.drive.initial, tolerance, breakpoints=tyre.drive.starts[1:])
    ops, fields = problem.operators, np.asarray(history.values)
    # Seen from before: at the end of a phase, that phase still counts.
    when = times * (1 - 1e-9)
    return Snapshots(
        fields, np.array([sources_at(ops, tyre, float(when[i]), fields[i]) for i in range(1, len(times), 3)])
    )


def sources_at(ops: Operators, tyre: RollingTyre, t: float, field: Array) -> Array:
    """(all zones' nodes,) W/m3 at a time and a field, zone after zone."""
    return np.concatenate([source(ops.nodes(zone), t, field[ops.dofs(zone)]) for zone, source in tyre.sources.items()])


def trained(base: RollingTyre, learnt: Sequence[Snapshots], choice: ReducedFineness | None = None) -> ReducedModel:
    """A reduced model on a tyre's mesh, from what variants on that mesh have taught."""
    choice = choice or ReducedFineness()
    ops = base.problem.operators
    fields = np.vstack([snapshot.fields for snapshot in learnt])
    hot = hot_nodes(base, learnt)
    V = modes(fields, weight(base, hot), choice.modes_tolerance, choice.most_modes)
    heats = np.vstack([snapshot.sources for snapshot in learnt])
    largest = np.abs(heats).max(axis=1)
    # All of a like size: a slow variant's sources are to be met as well as a fast one's.
    heats = heats[largest > 0] / largest[largest > 0][:, None] if largest.any() else heats[:1] + 1.0
    chosen, everywhere = places(heats, choice.source_tolerance, choice.most_sources)
    zones = list(base.sources)
    ends = np.cumsum([0, *(len(ops.dofs(zone)) for zone in zones)])
    samples = {
        zone: chosen[(chosen >= a) & (chosen < b)] - a for zone, a, b in zip(zones, ends[:-1], ends[1:], strict=True)
    }
    return ReducedModel(base, V, samples, everywhere, hot)


def weight(base: RollingTyre, hot: Mapping[str, NDArray[np.intp]]) -> Array:
    """(n,) weights of the nodes: half by volume, every region counting alike, half where regions are the hottest.

    A bead is small, but its hottest place is asked for.
    """
    ops = base.problem.operators
    weights, ones = np.zeros(ops.size), np.ones(ops.size)
    for region in base.bodies:
        of_region = ops.matrix(ops.mass(region)) @ ones
        weights += of_region / of_region.sum()
        weights[hot[region]] += 1 / len(hot[region])
    return weights / weights.sum()


def hot_nodes(base: RollingTyre, learnt: Sequence[Snapshots]) -> dict[str, NDArray[np.intp]]:
    """Region -> the nodes that came near its highest temperature in any field."""
    ops = base.problem.operators
    fields, hot = np.vstack([snapshot.fields for snapshot in learnt]), {}
    for region in base.bodies:
        dofs = ops.dofs(region)
        of_region = fields[:, dofs]
        most, least = of_region.max(axis=1, keepdims=True), of_region.min(axis=1, keepdims=True)
        near = of_region >= most - NEAR * (most - least)
        # A field that is even says nothing.
        hot[region] = dofs[near[(most - least)[:, 0] > EVEN].any(axis=0)] if ((most - least) > EVEN).any() else dofs
    return hot
