"""Harmonic balance: the footprint in large motion, without linearisation about the inflated state."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace

import numpy as np

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.footprint import QUICK_LOOK, Footprint
from tyrefem.mechanics.footprint.large_motion import BEFORE_RIM, STIFFNESS, DeflectedState, LargeMotion
from tyrefem.mechanics.solid.finite_law import FiniteLaw

#: Harmonics of the load steps, and the numbers that then refine the last step.
COARSE, LADDER = 10, (16, 24)
#: Harmonics of the contact, on the way and at the end: those above the motion's are linear.
CONTACT_ON_THE_WAY, CONTACT = 48, 120
#: Tolerance of the load steps, and distance to the target at which they end.
ON_THE_WAY, NEAR = 1e-2, 0.15
#: A deflection is reached within this, relatively: sums of steps are rounded.
ROUNDING = 1e-12
#: Tolerance of the numbers of harmonics before the last.
BEFORE_LAST = 5e-3
#: Smallest load step over the total, and largest number of steps.
SMALLEST, MOST = 1e-3, 60
#: A tyre in large motion is stiffer than at a small load by about this factor: slope of the second step's guess.
STIFFENS = 1.3


@dataclass(frozen=True, eq=False)
class Balance:
    """Footprints in large motion: the stress at every angle (`NonlinearForces`) balances the road's pressure.

    Deflections grow from the free tyre in load steps with few harmonics. Each step ends with Newton iterations
    (`LargeMotion`); more harmonics refine the last step.

    Parameters
    ----------
    pressing : the tyre and its road.
    harmonics : highest harmonic in large motion.
    contact : highest harmonic of the contact; those above ``harmonics`` move linearly about the inflated state. Their
        step pi R / N is what length and area are resolved to.
    tolerance : last relative change of motion and load.
    law : stress; by default that of the state's compounds and cords, or linear in Green's strain without these.
    steps : largest number of load steps. before_rim : largest deflection over that at which the crown meets the rim.

    >>> from tyrefem.mechanics.footprint.example_tyre import PlainTyre
    >>> footprint = Balance(Pressing(PlainTyre().state(along=6)), 12, 12).at_deflection(0.004)
    >>> footprint.balanced.shape == footprint.amplitudes.shape, 0 < footprint.load < 400
    (True, True)
    """

    pressing: Pressing
    harmonics: int = LADDER[-1]
    contact: int = CONTACT
    tolerance: float = 1e-3
    law: FiniteLaw | None = None
    steps: int = MOST
    before_rim: float = BEFORE_RIM
    #: (deflection, load), m and N, of the load steps, with the tolerance `ON_THE_WAY`; every solution starts a new
    #: list.
    path: list[tuple[float, float]] = field(default_factory=list, init=False, repr=False)
    #: Highest harmonic in large motion of each load step of `path`.
    path_harmonics: list[int] = field(default_factory=list, init=False, repr=False)

    @functools.cached_property
    def motion(self) -> LargeMotion:
        """Solver of a balance from a nearby balance."""
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
        """The footprint with the number of harmonics that the tolerance of `Pressing.solve` needs, at most
        ``harmonics``; its ``error`` is the last change.

        Raises
        ------
        InputError : both or neither of deflection and load; an impossible one; no balance: the message gives the last
        one.
        """
        if (deflection is None) == (load is None):
            raise InputError("give exactly one of 'deflection' and 'load'")
        self.pressing.check_harmonics(self.harmonics)
        self.pressing.check_harmonics(self.contact)
        ladder = (*(n for n in LADDER if n < self.harmonics), self.harmonics)
        moment = self._load_steps(deflection, load, min(COARSE, ladder[0]))
        passed: list[Footprint] = []
        for count in ladder:
            start = self.motion.refined(moment, count, self._contact(count))
            accuracy = self.tolerance if count == ladder[-1] else max(self.tolerance, BEFORE_LAST)
            balanced = self._balanced(start, accuracy, load)
            if balanced is None:
                start = self._load_steps(deflection, load, count)
                balanced = self._balanced(start, accuracy, load)
            if balanced is None:
                raise self._no_balance_error(start, deflection, load, f" with {count} harmonics")
            moment = balanced
            passed.append(self.motion.footprint(moment))
            if len(passed) > 1 and passed[-1].compared(passed[-2]).error <= tolerance:
                break
        if accuracy > self.tolerance:
            balanced = self._balanced(moment, self.tolerance, load)
            if balanced is None:
                raise self._no_balance_error(moment, deflection, load, f" within {self.tolerance:g}")
            moment = balanced
            passed[-1] = self.motion.footprint(moment)
        footprint = passed[-1].compared(passed[-2]) if len(passed) > 1 else passed[-1]
        return replace(footprint, known_stiffness=self.motion.stiffness(moment, min(STIFFNESS, 5 * self.tolerance)))

    def _contact(self, harmonics: int) -> int:
        """Highest harmonic of the contact for one of the motion."""
        wanted = self.contact if harmonics >= self.harmonics else min(self.contact, CONTACT_ON_THE_WAY)
        return max(wanted, harmonics)

    def _balanced(self, start: DeflectedState, tolerance: float, load: float | None) -> DeflectedState | None:
        """The balance from a nearby one with the same harmonics; None without one."""
        balanced = self.motion.balance(start, start.deflection, tolerance, load)
        if balanced is None and start.rate is not None:
            balanced = self.motion.balance(replace(start, rate=None), start.deflection, tolerance, load)
        return balanced

    def _load_steps(self, deflection: float | None, load: float | None, harmonics: int) -> DeflectedState:
        """Load steps from the free tyre to near a deflection or a load; the motion limits their size."""
        pressing, motion = self.pressing, self.motion
        if deflection is not None:
            pressing.check(deflection)
            if deflection > motion.largest_deflection:
                raise InputError(
                    f"a deflection of {deflection * 1e3:.5g} mm is too near {pressing.bottoming * 1e3:.5g} mm, where "
                    f"{pressing.end}: large motion reaches {motion.largest_deflection * 1e3:.5g} mm",
                    field="deflection",
                )
            total, slope = deflection, 1.0
        else:
            assert load is not None
            if not load > 0:
                raise InputError(f"the load must be positive, not {load:g} N", field="load")
            total = self._guess(load, harmonics)
            slope = load / total
        now, step = motion.free(harmonics, self._contact(harmonics), total), total
        self.path[:], self.path_harmonics[:] = [(0.0, 0.0)], [harmonics]
        for _ in range(self.steps):
            left = total - now.deflection if load is None else (load - now.load) / slope
            if abs(left) <= (ROUNDING if load is None else NEAR) * total:
                return now
            next_deflection = min(now.deflection + max(-step, min(left, step)), motion.largest_deflection)
            if next_deflection == now.deflection:
                raise InputError(
                    f"the tyre cannot carry {load:.5g} N: {pressing.end} at {now.load:.5g} N "
                    f"({now.deflection * 1e3:.4g} mm)",
                    field="load",
                )
            reached = motion.balance(now, next_deflection, ON_THE_WAY)
            if reached is None:
                step = abs(next_deflection - now.deflection) / 2
                if step < SMALLEST * total:
                    break
                continue
            made = reached.deflection - now.deflection
            if load is not None and reached.load and made:
                steeper = (reached.load - now.load) / made if now.load else STIFFENS * reached.load / reached.deflection
                slope = max(steeper, 0.1 * slope)
            now, step = reached, 1.25 * abs(made)
            self.path.append((now.deflection, now.load))
            self.path_harmonics.append(harmonics)
        raise self._no_balance_error(now, deflection, load, "")

    def _guess(self, load: float, harmonics: int) -> float:
        """Deflection, m, whose footprint carries the load by the pressure alone, load = p b L, L^2 = 8 R D; at least
        one that the harmonics resolve."""
        pressing = self.pressing
        if not pressing.state.pressure:
            return pressing.at_load(load, harmonics).deflection
        width = np.ptp(pressing.tread.places[1]) * (2 if pressing.tread.half else 1)
        length = load / (pressing.state.pressure * width)
        resolved = 2 * np.pi * pressing.reach / harmonics
        return float(min(max(length, resolved) ** 2 / (8 * pressing.reach), 0.5 * pressing.bottoming))

    @staticmethod
    def _no_balance_error(now: DeflectedState, deflection: float | None, load: float | None, how: str) -> InputError:
        target = f"{load:.5g} N" if deflection is None else f"{deflection * 1e3:.4g} mm of deflection"
        return InputError(
            f"the balance in large motion reaches {now.deflection * 1e3:.4g} mm ({now.load:.5g} N), not {target}{how}; "
            f"{QUICK_LOOK} and needs none",
            field="load" if deflection is None else "deflection",
        )
