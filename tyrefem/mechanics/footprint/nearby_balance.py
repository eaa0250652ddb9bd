"""A footprint in large motion that starts from a nearby one: another load, pressure or stiffness of the same tyre."""

from __future__ import annotations

from dataclasses import replace

from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.harmonic_balance import ON_THE_WAY, Balance
from tyrefem.mechanics.footprint.large_motion import STIFFNESS, DeflectedState


def nearby_balance(
    balance: Balance, near: Footprint, *, deflection: float | None = None, load: float | None = None
) -> Footprint | None:
    """The footprint with the harmonics of a nearby one, by Newton's method from there: half the time of load steps.

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
    motion, pressing = balance.motion, balance.pressing
    if near.balanced is None or near.balanced.shape[1] != pressing.harmonics.elements.n_dofs:
        return None
    if len(near.grid.tread.nodes) != len(pressing.tread.nodes):
        return None
    moment = DeflectedState(near.deflection, near.balanced, near.grid, near.forces, near.load)
    moment = motion.refined(moment, moment.harmonics, near.harmonics)
    target = near.deflection if deflection is None else deflection
    # A loose balance at a deflection first: pressure and stiffness may have changed. Then the load.
    for tolerance, carried in ((ON_THE_WAY, None), (balance.tolerance, load)):
        reached = motion.balance(moment, target, tolerance, carried)
        if reached is None or (carried is None and reached.deflection != target):
            return None
        moment, target = reached, reached.deflection
    stiffness = motion.stiffness(moment, min(STIFFNESS, 5 * balance.tolerance))
    return replace(motion.footprint(moment), stiffness=stiffness, error=near.error)
