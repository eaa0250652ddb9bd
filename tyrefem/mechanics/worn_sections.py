"""A section that an effect wears, between amplitudes of the effect at which the tyre is solved."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from tyrefem.effects.effect import Prior
    from tyrefem.inputs.study import StudyData

#: Distance of solved amplitudes, in prior scales of the effect (a tenth of the tread's thickness).
STEP = 0.4


@dataclass(frozen=True)
class SectionWear:
    """The one effect that wears a study's section, and its amplitude.

    Parameters
    ----------
    effect, parameter : names. prior : of the amplitude. value : the amplitude, SI.
    """

    effect: str
    parameter: str
    prior: Prior
    value: float

    @classmethod
    def of(cls, study: StudyData) -> SectionWear | None:
        """The wear of a study's section; None if no effect, several effects or several amplitudes make it."""
        wearing = [effect for effect in study.card.acting_effects if effect.overrides("worn")]
        if len(wearing) != 1:
            return None
        (effect,) = wearing
        if len(effect.parameters()) != 1:
            return None
        (parameter,) = effect.parameters()
        return cls(effect.name, parameter.name, parameter.prior, effect.values[parameter.name])

    def at(self, study: StudyData, node: int) -> StudyData:
        """The study with the amplitude of a node; node 0 is the section without the effect."""
        entries = [dict(entry) for entry in study.data["effects"] if node or entry["name"] != self.effect]
        amplitude, unit = self._amplitude(node), self.prior.unit
        for entry in entries:
            if entry["name"] == self.effect:
                entry[self.parameter] = amplitude if unit == "1" else f"{amplitude!r} {unit}"
        return study.replace({"effects": entries})

    def _amplitude(self, node: int) -> float:
        return self.prior.null + node * STEP * self.prior.scale

    @property
    def nodes(self) -> dict[int, float]:
        """Number of a solved amplitude -> its weight in the cubic between them (Catmull & Rom).

        At the bounds of the amplitude it is the parabola through the three nearest ones.

        >>> from tyrefem.effects.effect import Prior
        >>> worn = Prior("1", "worn part", 0.25, 0.0, 0.8)
        >>> SectionWear("worn-tread", "fraction", worn, 0.2).nodes
        {2: 1.0}
        >>> {n: round(w, 2) for n, w in SectionWear("worn-tread", "fraction", worn, 0.15).nodes.items()}
        {0: -0.06, 1: 0.56, 2: 0.56, 3: -0.06}
        >>> {n: round(w, 3) for n, w in SectionWear("worn-tread", "fraction", worn, 0.05).nodes.items()}
        {0: 0.375, 1: 0.75, 2: -0.125}
        """
        place = (self.value - self.prior.null) / (STEP * self.prior.scale)
        left = math.floor(place + 1e-9)
        part = max(place - left, 0.0)
        if part < 1e-9:
            return {left: 1.0}
        below, above = (self._allowed(left - 1), self._allowed(left + 2))
        parabolas = []
        if below:
            parabolas.append(_parabola((left - 1, left, left + 1), place))
        if above:
            parabolas.append(_parabola((left, left + 1, left + 2), place))
        if not parabolas:
            return {left: 1 - part, left + 1: part}
        shares = (1 - part, part) if len(parabolas) == 2 else (1.0,)
        weights: dict[int, float] = {}
        for share, parabola in zip(shares, parabolas, strict=True):
            for node, weight in parabola.items():
                weights[node] = weights.get(node, 0.0) + share * weight
        return weights

    def _allowed(self, node: int) -> bool:
        amplitude = self._amplitude(node)
        return self.prior.low - 1e-9 <= amplitude <= self.prior.high + 1e-9


def _parabola(nodes: Sequence[int], place: float) -> dict[int, float]:
    """Lagrange's weights of three nodes at a place."""
    at = np.array(nodes, dtype=float)
    weights = {}
    for node in nodes:
        others: NDArray[np.float64] = at[at != node]
        weights[node] = float(np.prod((place - others) / (node - others)))
    return weights
