"""Constant or linear in temperature: which slopes the readings ask for, by evidence."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.rig.noise import Normal, log_evidence
from tyrefem.rig.parameters import SLOPE, Parameters

Array = NDArray[Any]
#: A simpler model is kept unless the evidence for the better one is e times larger.
MARGIN = 1.0
#: Up to so many slopes every combination is weighed; beyond it, at most two at a time.
_ALL = 8


@dataclass(frozen=True, eq=False)
class Selection(Brief):
    """Every combination of linear properties, weighed.

    Attributes
    ----------
    chosen : slopes that are fitted; the others are held at the card's guess (usually 0).
    log_evidence : combination -> ln evidence relative to that with no slope.
    probability : slope -> probability that it belongs into the model, all combinations being as likely beforehand.
    mean, covariance : of all coordinates, averaged over the combinations by their probability (about `mean`).
    """

    chosen: tuple[str, ...]
    log_evidence: Mapping[tuple[str, ...], float]
    probability: Mapping[str, float]
    mean: Array
    covariance: Array


def combinations(slopes: Sequence[str]) -> list[tuple[str, ...]]:
    """Sets of slopes, the empty one first.

    >>> combinations(["a", "b"])
    [(), ('a',), ('b',), ('a', 'b')]
    """
    most = len(slopes) if len(slopes) <= _ALL else 2
    return [found for n in range(most + 1) for found in itertools.combinations(slopes, n)]


def select(parameters: Parameters, eq: Normal, x: Array) -> Selection:
    """Weigh every combination with the problem linearised at x, where `parameters` has every slope free.

    The Laplace evidence integrates each slope over its prior, so a slope that explains nothing costs its Occam factor.
    """
    slopes = [one.name for one in parameters.free if one.group == SLOPE]
    place = {name: i for i, name in enumerate(parameters.names)}
    right = eq.right + eq.matrix @ x
    sets = combinations(slopes)
    logs, means, covariances = [], [], []
    for found in sets:
        kept = np.array([i for name, i in place.items() if name not in slopes or name in found])
        logs.append(log_evidence(eq, x, kept))
        block = np.linalg.inv(np.eye(kept.size) + eq.matrix[np.ix_(kept, kept)])
        mean, covariance = np.zeros(x.size), np.zeros((x.size, x.size))
        mean[kept] = block @ right[kept]
        covariance[np.ix_(kept, kept)] = block
        means.append(mean)
        covariances.append(covariance)
    values = np.array(logs)
    weight = np.exp(values - values.max())
    weight /= weight.sum()
    centre = np.tensordot(weight, np.array(means), 1)
    spread = sum(w * (c + np.outer(m - centre, m - centre)) for w, m, c in zip(weight, means, covariances, strict=True))
    probable = {n: float(sum(w for w, found in zip(weight, sets, strict=True) if n in found)) for n in slopes}
    good = [i for i in range(len(sets)) if values[i] > values.max() - MARGIN]
    simplest = min(good, key=lambda i: (len(sets[i]), -values[i]))
    relative = {found: float(v - values[0]) for found, v in zip(sets, values, strict=True)}
    return Selection(sets[simplest], relative, probable, centre, np.asarray(spread))
