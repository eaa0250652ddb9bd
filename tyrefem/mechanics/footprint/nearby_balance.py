"""A footprint in large motion that starts from a nearby one: another load, pressure or stiffness of the same tyre."""

from __future__ import annotations

import functools
from collections.abc import Hashable
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from tyrefem.cache import Cache, fingerprint
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.harmonic_balance import ON_THE_WAY, Balance
from tyrefem.mechanics.footprint.imbalance import Imbalance
from tyrefem.mechanics.footprint.large_motion import DeflectedState, LargeMotion
from tyrefem.mechanics.footprint.nearby_tread import NearbyPressing, ShortWaves
from tyrefem.mechanics.footprint.taut_tyre import TautTyre, tautened
from tyrefem.mechanics.footprint.tyre_on_road import TyreOnRoad
from tyrefem.mechanics.solid.body import Prestressed
from tyrefem.mechanics.solid.finite_law import FiniteLaw

Array = NDArray[np.float64]
#: Largest ratio of load or deflection to that of the start: its number of harmonics serves no further.
FAR = 2.0
#: Small motions of the latest tyre from whose footprints others started, by its state: loads of one tyre share them.
_LEADING: Cache[TautTyre] = Cache(size=1)
#: Short waves of the latest such footprints, at two loads.
_WAVES: Cache[ShortWaves] = Cache(size=2)
#: What the balances of the latest such footprints left.
_IMBALANCES: Cache[Imbalance] = Cache(size=2)
#: The latest tyre that started from a footprint, by its state.
_PRESSINGS: Cache[NearbyPressing] = Cache(size=1)


@dataclass(frozen=True, eq=False)
class NearbyFootprint(Footprint):
    """A footprint that started from a nearby one. Its stiffness is computed when it is used: strain cycles do without.

    ``law`` : stress, as in `Balance`. ``like`` : a footprint with the same motion.
    """

    law: FiniteLaw | None = None
    like: Footprint | None = None

    @functools.cached_property
    def amplitudes(self) -> Array:
        """(harmonics + 1, n_dofs) displacement amplitudes of the whole section, m."""
        return super().amplitudes if self.like is None else self.like.amplitudes

    @functools.cached_property
    def stiffness(self) -> float:
        """d load / d deflection at this deflection, N/m."""
        if self.like is not None:
            return self.like.stiffness
        assert self.balanced is not None
        assert isinstance(self.pressing, Pressing)
        moment = DeflectedState(self.deflection, self.balanced, self.grid, self.forces, self.load, self.rate)
        return LargeMotion(self.pressing, self.law).stiffness(moment)


def nearby_balance(
    balance: Balance, near: Footprint, *, deflection: float | None = None, load: float | None = None
) -> Footprint | None:
    """The footprint with the harmonics of a nearby one, by Newton's method from there: a third of the time of load
    steps. Where only the stiffness differs, it keeps what the nearby balance left (`Imbalance`).

    Parameters
    ----------
    balance : the tyre to press. near : a footprint of a tyre with the same mesh, within about a tenth in load,
        pressure and stiffness; its ``error`` is kept.
    deflection, load : m or N; one of them.

    Returns None where ``near`` is linear, has another mesh, or is too far away: load steps then find the balance.

    >>> from tyrefem.mechanics.footprint.contact import Pressing
    >>> from tyrefem.mechanics.footprint.example_tyre import PlainTyre
    >>> tyre = Balance(Pressing(PlainTyre().state(along=6)), 12)
    >>> footprint = nearby_balance(tyre, tyre.at_deflection(0.004), load=300.0)
    >>> footprint.load
    300.0
    """
    pressing = _pressing(balance.pressing, near)
    if near.balanced is None or near.balanced.shape[1] != pressing.harmonics.elements.n_dofs:
        return None
    if len(near.grid.tread.nodes) != len(pressing.tread.nodes):
        return None
    wanted, solved = (deflection, near.deflection) if load is None else (load, near.load)
    if wanted is not None and not solved / FAR <= wanted <= FAR * solved:
        return None
    unmoved = wanted is None or abs(wanted - solved) <= balance.tolerance * solved
    alike = balance.law is None and near.pressing.road == pressing.road
    if unmoved and alike and _as_stiff(near.pressing.state, pressing.state):
        return NearbyFootprint(**{**_fields(near), "pressing": pressing, "like": near})
    motion = LargeMotion(pressing, balance.law, balance.before_rim, _leading(near))
    moment = DeflectedState(near.deflection, near.balanced, near.grid, near.forces, near.load, near.rate)
    moment = motion.refined(moment, moment.harmonics, near.harmonics)
    stiffer = unmoved and alike and near.pressing.state.pressure == pressing.state.pressure
    kept = _imbalance(near) if stiffer else None
    target = near.deflection if deflection is None else deflection
    # A loose balance at a deflection first: pressure and stiffness may have changed. Then the load.
    for tolerance, carried in ((ON_THE_WAY, None), (balance.tolerance, load)):
        reached = motion.balance(moment, target, tolerance, carried, kept)
        if reached is None and carried is not None and moment.rate is not None:
            reached = motion.balance(replace(moment, rate=None), target, tolerance, carried, kept)
        if reached is None or (carried is None and reached.deflection != target):
            return None
        moment, target = reached, reached.deflection
    return NearbyFootprint(**{**_fields(motion.footprint(moment)), "error": near.error, "law": balance.law})


def _fields(footprint: Footprint) -> dict[str, Any]:
    return {part.name: getattr(footprint, part.name) for part in fields(Footprint)}


def _leading(near: Footprint) -> TautTyre:
    """The tyre of a footprint in small motions: it leads the search for all footprints that start from this tyre."""
    return _LEADING.get(_content(near.pressing), lambda: TautTyre(near.pressing))


def _content(tyre: TyreOnRoad) -> Hashable:
    """What small motions of an inflated tyre depend on, equal for copies of one tyre from several files."""
    state = tyre.state
    support = () if state.support is None else sp.find(state.support)
    numbers = fingerprint(state.mesh.p, state.mesh.t, state.stress, state.bulk, tautened(state).tangent, *support)
    return numbers, state.pressure, state.fixed, state.pressurised, state.tread, state.symmetric


def _pressing(tyre: Pressing, near: Footprint) -> NearbyPressing:
    """A tyre to be pressed from a nearby footprint; if it was pressed from another one, its factors are there."""
    waves = _waves(near)
    like = _PRESSINGS.get(tyre.state, lambda: NearbyPressing(tyre.state, tyre.road, waves=waves))
    return NearbyPressing(tyre.state, tyre.road, waves=waves, like=like)


def _imbalance(near: Footprint) -> Imbalance:
    """What the balance of a footprint left: those of the same tyre with another stiffness keep it."""
    return _IMBALANCES.get(near, lambda: Imbalance.of(near))


def _waves(near: Footprint) -> ShortWaves:
    """The short waves of a footprint: those of all footprints that start from it are computed from them."""
    return _WAVES.get(near, lambda: ShortWaves(near))


def _as_stiff(state: Prestressed, other: Prestressed) -> bool:
    """Whether two inflated tyres differ in nothing but their loss."""
    if state.pressure != other.pressure or not np.array_equal(state.mesh.p, other.mesh.p):
        return False
    pairs = [(state.stress, other.stress), (state.bulk, other.bulk)]
    pairs += [(tautened(state).tangent, tautened(other).tangent)]
    return all(np.array_equal(this, that) for this, that in pairs)
