"""Wear of the rings of a tread: depth per kilometre from the friction power of each."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.cache import read_only
from tyrefem.errors import InputError
from tyrefem.materials.wear import Wear

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.rolling.roll import RolledStudy

Array = NDArray[np.float64]
#: Region that wears.
TREAD = "tread"


@dataclass(frozen=True, eq=False)
class RingWear(Brief):
    """Wear of rings of a rolling tread.

    A ring passes the footprint once per revolution with the friction energy e = P 2 pi / (w A) per area, P its mean
    friction power and w the wheel's spin. It loses `Wear.of` (e) each time: depth per metre = depth / travel.
    Transverse grooves bear no friction: e is that of the rubber between them.

    Parameters
    ----------
    places : (2, m) r, z of the rings, m. widths : (m,) on the outline, m. power : (m,) W; negative values count as 0.
    spin : rad/s. travel : m per revolution. table : of the tread's card. rubber : share of a ring that is no groove.

    >>> wear = RingWear(np.array([[0.3], [0.0]]), np.array([0.01]), np.array([10.0]), 100.0, 1.9,
    ...     Wear.check({"depth": "5 nm", "source": "estimate: example"}))
    >>> round(float(wear.energy[0]), 3), bool(np.isclose(wear.depth_per_km[0], 5e-9 * wear.energy[0] / 1.9))
    (33.333, True)
    """

    places: Array
    widths: Array
    power: Array
    spin: float
    travel: float
    table: Wear
    rubber: float = 1.0

    def __post_init__(self) -> None:
        for name in ("places", "widths", "power"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    def _facts(self) -> Mapping[str, Any]:
        return {
            "mean": f"{self.mean * 1e6:.4g} mm per 1000 km",
            "most": f"{self.depth_per_km.max() * 1e6:.4g} mm per 1000 km",
            "friction power": f"{self.power.sum():.4g} W",
        }

    @property
    def areas(self) -> Array:
        """(m,) of the rings, with transverse grooves, m2."""
        return np.asarray(2 * np.pi * self.places[0] * self.widths)

    @property
    def energy(self) -> Array:
        """(m,) friction energy per area of rubber of one passing, J/m2."""
        return np.asarray(np.maximum(self.power, 0.0) * 2 * np.pi / (self.spin * self.rubber * self.areas))

    @property
    def negative(self) -> tuple[int, float]:
        """Number of rings whose friction power is negative, and their power, W: friction takes no power from the road,
        so there the mesh does not resolve the slip."""
        below = self.power[self.power < 0]
        return len(below), float(below.sum())

    @functools.cached_property
    def depth_per_km(self) -> Array:
        """(m,) depth worn per kilometre, m."""
        return read_only(self.table.of(self.energy) * 1e3 / self.travel)

    @property
    def mean(self) -> float:
        """Mean depth per kilometre over the tread's area, m."""
        return float((self.depth_per_km * self.areas).sum() / self.areas.sum())

    @property
    def volume_per_km(self) -> float:
        """Rubber worn off the whole tread per kilometre, m3."""
        return float(self.rubber * (self.depth_per_km * self.areas).sum())


def tread_table(study: StudyData) -> Wear:
    """The ``[wear]`` table of a study's tread.

    Raises
    ------
    InputError : no region ``tread``, or a card without the table.
    """
    card = study.materials.get(TREAD)
    if card is None:
        raise InputError(f"the section has no region '{TREAD}' to wear", field="section", file=study.file)
    if card.wear is None:
        message = "the card of region 'tread' has no table [wear]: give depth, energy and exponent with their source"
        raise InputError(message, field="materials.tread.wear", file=study.file)
    return card.wear


def rubber_share(study: StudyData) -> float:
    """Share of a ring of the tread that is no transverse groove."""
    section = study.section
    return 1.0 if section.pattern is None or section.patterned != TREAD else section.pattern.rubber


def ring_wear(rolled: RolledStudy) -> RingWear:
    """Wear of a rolling tyre by ring, at its undeformed places.

    Raises
    ------
    InputError : errors of `tread_table`.
    """
    table, state = tread_table(rolled.study), rolled.state
    influence, tyre = state.grid.influence, rolled.wheel.pressed.tyre
    nodes, _ = influence.source
    r, z = tyre.body.rings.nodes[:, influence.tread.nodes[nodes]]
    side = np.where(influence.places[1] < 0, -1.0, 1.0) if tyre.half else np.ones(len(z))
    return RingWear(
        np.stack([r, side * z]), influence.lengths, state.power_by_ring, state.spin, 2 * np.pi * state.travel, table,
        rubber_share(rolled.study),
    )  # fmt: skip
