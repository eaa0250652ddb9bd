"""Harmonic balance: the footprint in large motion, not linear about the inflated state."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.large_motion import BEFORE_RIM, DeflectedState, LargeMotion
from tyrefem.mechanics.solid.finite_law import FiniteLaw

#: Numbers of harmonics: the way is gone with the first, the others refine what it leads to.
LADDER = (16, 24, 36)
#: Last change on the way, and how near it leads.
ON_THE_WAY, NEAR = 1e-2, 1e-2
#: Smallest step on the way over the whole of it, and steps in all.
SMALLEST, MOST = 1e-3, 60
#: A tyre in large motion stiffens from a small load on by about this factor: guess of the second step's slope.
STIFFENS = 1.3


@dataclass(frozen=True, eq=False)
class Balance:
    """Footprints in large motion: the stress at every angle (`NonlinearForces`) balances the road's pressure.

    Deflections grow from the free tyre's on with few harmonics; each step ends in Newton's (`LargeMotion`), and more
    harmonics refine the last.

    Parameters
    ----------
    pressing : the tyre and its road.
    harmonics : highest harmonic.
    tolerance : last change of motion and load, relative.
    law : stress; by default that of the state's own compounds and cords, or linear in Green's strain without these.
    steps : deflections on the way, at most. before_rim : share of the way to the rim at which deflections end.

    >>> from tyrefem.mechanics.footprint.example_tyre import PlainTyre
    >>> footprint = Balance(Pressing(PlainTyre().state(along=6)), 12).at_deflection(0.004)
    >>> footprint.balanced.shape == footprint.amplitudes.shape, 0 < footprint.load < 400
    (True, True)
    """

    pressing: Pressing
    harmonics: int = LADDER[-1]
    tolerance: float = 1e-3
    law: FiniteLaw | None = None
    steps: int = MOST
    before_rim: float = BEFORE_RIM
    #: (deflection, load), m and N, on the way, balanced to `ON_THE_WAY`; cleared by every solution.
    path: list[tuple[float, float]] = field(default_factory=list, init=False, repr=False)

    @functools.cached_property
    def motion(self) -> LargeMotion:
        """Balances near by one another."""
        return LargeMotion(self.pressing, self.law, self.before_rim)

    def at_deflection(self, deflection: float) -> Footprint:
        """The footprint at a deflection, m, with all harmonics; raises as `solve`."""
        return self.solve(deflection=deflection, tolerance=0.0)

    def at_load(self, load: float) -> Footprint:
        """The footprint under a load, N, with all harmonics; raises as `solve`."""
        return self.solve(load=load, tolerance=0.0)

    def solve(
        self, *, deflection: float | None = None, load: float | None = None, tolerance: float = 0.01
    ) -> Footprint:
        """The footprint with as many harmonics as the error measure of `Pressing.solve` asks for, at most
        ``harmonics``; its ``error`` is the last change.

        Raises
        ------
        InputError : not exactly one of deflection and load; one that is impossible; no balance: how far it got.
        """
        if (deflection is None) == (load is None):
            raise InputError("give exactly one of 'deflection' and 'load'")
        self.pressing.check_harmonics(self.harmonics)
        ladder = (*(n for n in LADDER if n < self.harmonics), self.harmonics)
        moment, footprint = self._way(deflection, load, ladder[0]), None
        for count in ladder:
            start = self.motion.refined(moment, count)
            settled = self.motion.settled(start, moment.deflection, self.tolerance, load)
            if settled is None:
                raise self._stuck(moment, deflection, load, f" with {count} harmonics")
            moment, before, footprint = settled, footprint, self.motion.footprint(settled)
            if before is not None:
                footprint = footprint.compared(before)
                if footprint.error <= tolerance:
                    break
        assert footprint is not None
        return replace(footprint, stiffness=self.motion.stiffness(moment))

    def _way(self, deflection: float | None, load: float | None, harmonics: int) -> DeflectedState:
        """From the free tyre to near a deflection or a load: steps as long as the motion allows."""
        pressing, motion = self.pressing, self.motion
        if deflection is not None:
            pressing.check(deflection)
            whole, slope = deflection, 1.0
        else:
            assert load is not None
            linear = pressing.at_load(load, harmonics)
            whole, slope = linear.deflection, load / linear.deflection
        now, step = motion.free(harmonics, whole), whole
        self.path[:] = [(0.0, 0.0)]
        for _ in range(self.steps):
            left = whole - now.deflection if load is None else (load - now.load) / slope
            if abs(left) <= NEAR * whole * (load is not None):
                return now
            ahead = min(now.deflection + max(-step, min(left, step)), motion.deepest)
            if ahead == now.deflection:
                raise InputError(
                    f"the tyre cannot carry {load:.5g} N: the crown meets the rim at {now.load:.5g} N "
                    f"({now.deflection * 1e3:.4g} mm)",
                    field="load",
                )
            reached = motion.settled(now, ahead, ON_THE_WAY)
            if reached is None:
                step = abs(ahead - now.deflection) / 2
                if step < SMALLEST * whole:
                    break
                continue
            made = reached.deflection - now.deflection
            if load is not None and reached.load:
                steeper = (reached.load - now.load) / made if now.load else STIFFENS * reached.load / reached.deflection
                slope = max(steeper, 0.1 * slope)
            now, step = reached, 2 * abs(made)
            self.path.append((now.deflection, now.load))
        raise self._stuck(now, deflection, load, "")

    @staticmethod
    def _stuck(now: DeflectedState, deflection: float | None, load: float | None, how: str) -> InputError:
        wanted = f"{load:.5g} N" if deflection is None else f"{deflection * 1e3:.4g} mm of deflection"
        return InputError(
            f"the balance in large motion reaches {now.deflection * 1e3:.4g} mm ({now.load:.5g} N), not {wanted}{how}",
            field="load" if deflection is None else "deflection",
        )
