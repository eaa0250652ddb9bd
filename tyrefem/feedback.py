"""Two ways: temperatures change pressure and moduli, these the strain cycles and so the heat, until both agree."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from tyrefem.warm_cycles import WarmCycles
from tyrefem.warmth import Warmth

if TYPE_CHECKING:
    from tyrefem.heating import CycleSchedule
    from tyrefem.loading import LoadCase
    from tyrefem.result import Result
    from tyrefem.rolling import RollingTyre
    from tyrefem.studies import Study

#: A run that leaves more than this share of the last one's disagreement makes the next one go half as far.
SLOW, LEAST = 0.7, 1 / 16


@dataclass(frozen=True)
class Contact:
    """Gauge pressure, Pa, and deflection, m, at a time, s."""

    time: float
    pressure: float
    deflection: float

    def __str__(self) -> str:
        return f"{self.deflection * 1e3:.1f} mm at {self.pressure / 1e3:.0f} kPa"


@dataclass(frozen=True)
class FeedbackOutcome:
    """Whether strain cycles and temperatures agree, and what the feedback did.

    Attributes
    ----------
    changes : K, of every run: largest difference between the temperatures that it found and those of its strain
        cycles, over contained air and mean of every region that softens, at every knot; infinite of a run that was
        interrupted, for which nobody knows.
    start, end : pressure and deflection there. softened : region -> modulus of its compound at the end over the card's.
    """

    tolerance: float
    changes: tuple[float, ...]
    start: Contact
    end: Contact
    softened: dict[str, float]

    @property
    def iterations(self) -> int:
        """Runs of the whole drive."""
        return len(self.changes)

    @property
    def converged(self) -> bool:
        """Do they agree within the tolerance?"""
        return self.changes[-1] <= self.tolerance

    @property
    def warnings(self) -> tuple[str, ...]:
        """One line, if they do not agree."""
        if self.converged or math.isinf(self.changes[-1]):
            return ()
        return (
            f"the feedback of temperature on the strain cycle has not converged: after {self.iterations} runs "
            f"temperatures still differ by {self.changes[-1]:.2g} K from those of the strain cycles (tolerance "
            f"{self.tolerance:g} K); raise mechanics.feedback.iterations",
        )

    @property
    def words(self) -> str:
        """One line for people."""
        change = f"{self.changes[-1]:.2g} K"
        state = f"converged to {change}" if self.converged else f"NOT converged: {change}"
        runs = f"{self.iterations} run{'' if self.iterations == 1 else 's'}"
        if math.isinf(self.changes[-1]):
            state = "interrupted before the end of the drive"
        return f"{self.start} at the start, {self.end} at the end; {runs}, {state}"

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        contacts = {
            when: {"time_s": at.time, "gauge_pressure_Pa": at.pressure, "deflection_m": at.deflection}
            for when, at in (("start", self.start), ("end", self.end))
        }
        return {
            "converged": self.converged,
            "iterations": self.iterations,
            "change_K": list(self.changes),
            "tolerance_K": self.tolerance,
            **contacts,
            "relative_modulus_at_end": self.softened,
        }


def run(
    study: Study,
    progress: Callable[[float], None] | None = None,
    like: RollingTyre | None = None,
    start: Warmth | None = None,
    *,
    partial: bool = False,
) -> Result:
    """Simulate a study's drive again and again until its temperatures are those of its strain cycles.

    Every run takes its strain cycles at the temperatures of the one before (the first: ``start``, by default the
    drive's initial ones): T_(k+1) = run(cycles(T_k)). Where that converges slowly or not, steps are halved. What has
    not converged after the iterations allowed is returned all the same, and warns. ``partial``: as of
    `tyrefem.rolling.run`; the part is one of the latest run.

    Raises
    ------
    InputError : a pressure or modulus at which the section cannot take its load; names the phase.
    """
    from tyrefem.rolling import RollingTyre, simulate

    choice = study.card.mechanics.feedback
    assert choice is not None
    cycles = WarmCycles(study, choice, Warmth.even(study) if start is None else start)
    changes: list[float] = []
    share, first, wall_time = 1.0, like, 0.0
    while True:
        tyre = RollingTyre(study, first, cycles.schedule())
        result = simulate(tyre, progress, partial=partial)
        first, wall_time = first or tyre, wall_time + result.wall_time
        found = Warmth.of(result)
        changes.append(math.inf if result.history.interrupted else cycles.change(found))
        done = changes[-1] <= choice.tolerance or len(changes) == choice.iterations
        if done or result.history.interrupted:
            break
        if len(changes) > 1 and changes[-1] > SLOW * changes[-2]:
            share = max(share / 2, LEAST)
        cycles.update(found, share)
    end = float(result.times[-1])
    last = found.at(end)
    softened = {
        region: law(last.regions[region])
        for region in cycles.softening
        if (law := study.materials[region].softening) is not None
    }
    before, after = (_contact(tyre.schedule, t) for t in (0.0, end * (1 - 1e-12)))
    outcome = FeedbackOutcome(choice.tolerance, tuple(changes), before, after, softened)
    return replace(result, feedback=outcome, wall_time=wall_time)


def _contact(schedule: CycleSchedule, time: float) -> Contact:
    pressure, deflection = (schedule.mean(quantity, time) for quantity in (_pressure, _deflection))
    return Contact(time, pressure, deflection)


def _pressure(case: LoadCase) -> float:
    return case.pressure


def _deflection(case: LoadCase) -> float:
    return case.deflection
