"""Training: POD modes and sample nodes from snapshots of a few full runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.operators import Operators
from tyrefem.reduced.model import ReducedModel
from tyrefem.reduced.pod import further_modes, modes, sample_nodes
from tyrefem.simulation.result import ResultData
from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]
#: A node may be the hottest of a region if it is below its peak by at most this share of the region's range; a field
#: with a smaller range than this, K, counts as uniform.
NEAR, EVEN = 0.005, 0.5
#: Errors are estimated on modes that leave out so much less, and are at most so many times as many.
FURTHER, MOST_FURTHER = 0.1, 0.7


@dataclass(frozen=True)
class ReducedFineness:
    """Resolution of a reduced model.

    Parameters
    ----------
    modes_tolerance : rms error of the snapshots on the modes, K.
    source_tolerance : relative rms error of the heat sources on their modes.
    most_modes, most_sources : modes of temperature and of heat source, at most.
    fields : temperature fields taken from every run.
    """

    modes_tolerance: float = 4e-4
    source_tolerance: float = 8e-6
    most_modes: int = 140
    most_sources: int = 140
    fields: int = 14

    @classmethod
    def of(cls, tolerance: float) -> ReducedFineness:
        """The resolution for a tolerance, K: the modes' rms error is 1/25 of it."""
        return cls(0.04 * tolerance, 8e-4 * tolerance)


#: Parts of a phase at which a training run takes a snapshot: dense where temperatures change fast.
PARTS = np.array([0.005, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0])


@dataclass(frozen=True, eq=False)
class Snapshots:
    """Snapshots of a full run.

    Parameters
    ----------
    fields : (k, n) degC. sources : (k', all zones' nodes) W/m3, zone after zone; fewer, as a source changes slowly.
    """

    fields: Array
    sources: Array


def snapshots(result: ResultData, count: int) -> Snapshots:
    """Snapshots of a result's fields and heat sources, dense after the start of every phase."""
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
    """Snapshots of a full run made for training only; ``tolerance``: K, of its time integration."""
    ends = [*tyre.drive.starts, tyre.drive.end]
    times = np.concatenate([[0.0], *(a + (b - a) * PARTS for a, b in pairwise(ends))])
    problem = tyre.problem
    history = problem.transient(times, tyre.drive.initial, tolerance, breakpoints=tyre.drive.starts[1:])
    ops, fields = problem.operators, np.asarray(history.values)
    # Just before the times: the end of a phase belongs to that phase.
    when = times * (1 - 1e-9)
    return Snapshots(
        fields, np.array([sources_at(ops, tyre, float(when[i]), fields[i]) for i in range(1, len(times), 3)])
    )


def sources_at(ops: Operators, tyre: RollingTyre, t: float, field: Array) -> Array:
    """Heat sources at a time for a field, (all zones' nodes,) W/m3, zone after zone."""
    return np.concatenate([source(ops.nodes(zone), t, field[ops.dofs(zone)]) for zone, source in tyre.sources.items()])


def trained(
    base: RollingTyre, sets: Sequence[Snapshots], fineness: ReducedFineness | None = None, *, further: bool = False
) -> ReducedModel:
    """A reduced model on a tyre's mesh, from snapshots of variants on that mesh; ``further``: with estimated errors."""
    fineness = fineness or ReducedFineness()
    ops = base.problem.operators
    fields = np.vstack([snapshot.fields for snapshot in sets])
    hot = hot_nodes(base, sets)
    weights = weight(base, hot)
    V = modes(fields, weights, fineness.modes_tolerance, fineness.most_modes)
    beyond = (FURTHER * fineness.modes_tolerance, int(MOST_FURTHER * V.shape[1]))
    more = further_modes(V, fields, weights, *beyond) if further else None
    heats = np.vstack([snapshot.sources for snapshot in sets])
    largest = np.abs(heats).max(axis=1)
    # Normalised: the sources of slow variants count as much as those of fast ones.
    heats = heats[largest > 0] / largest[largest > 0][:, None] if largest.any() else heats[:1] + 1.0
    chosen, everywhere = sample_nodes(heats, fineness.source_tolerance, fineness.most_sources)
    zones = list(base.sources)
    ends = np.cumsum([0, *(len(ops.dofs(zone)) for zone in zones)])
    samples = {
        zone: chosen[(chosen >= a) & (chosen < b)] - a for zone, a, b in zip(zones, ends[:-1], ends[1:], strict=True)
    }
    return ReducedModel(base, V, samples, everywhere, hot, further=more)


def weight(base: RollingTyre, hot: Mapping[str, NDArray[np.intp]]) -> Array:
    """Weights (n,) of the nodes in the inner product, all positive.

    Half of the weight is by volume, the same for every region; half is on the nodes where regions are hottest. Small
    regions such as beads count too, as their peaks are answers. Corners of six-node triangles have no positive volume
    (the integral of their shape function is nearly zero): there the diagonal of the mass matrix takes its place.
    """
    ops = base.problem.operators
    weights, ones = np.zeros(ops.size), np.ones(ops.size)
    for region in base.bodies:
        mass = ops.matrix(ops.mass(region))
        of_region = mass @ ones
        if of_region[ops.dofs(region)].min() <= 0:
            of_region = mass.diagonal()
        weights += of_region / of_region.sum()
        weights[hot[region]] += 1 / len(hot[region])
    return weights / weights.sum()


def hot_nodes(base: RollingTyre, sets: Sequence[Snapshots]) -> dict[str, NDArray[np.intp]]:
    """Region -> the nodes that are near its highest temperature in any snapshot."""
    ops = base.problem.operators
    fields, hot = np.vstack([snapshot.fields for snapshot in sets]), {}
    for region in base.bodies:
        dofs = ops.dofs(region)
        of_region = fields[:, dofs]
        most, least = of_region.max(axis=1, keepdims=True), of_region.min(axis=1, keepdims=True)
        near = of_region >= most - NEAR * (most - least)
        # Uniform fields have no hottest node.
        hot[region] = dofs[near[(most - least)[:, 0] > EVEN].any(axis=0)] if ((most - least) > EVEN).any() else dofs
    return hot
