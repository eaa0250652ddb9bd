"""Estimate of memory and time of a run, before mesh, mechanics or readings are computed."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from tyrefem.errors import InputError
from tyrefem.estimates import memory
from tyrefem.estimates import work as estimate
from tyrefem.estimates.work import Estimate
from tyrefem.geometry.meshing.expected import QUADRATIC, expected_nodes
from tyrefem.inputs.motion import motion_in
from tyrefem.inputs.wheel_state import wheel_state
from tyrefem.mechanics.footprint.footprint import QUICK_LOOK
from tyrefem.mechanics.footprint.pressed_tyre import element_size
from tyrefem.mechanics.solved_cases import changes_cycle, ramp_knots
from tyrefem.mechanics.strain_laws import strain_law

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.inputs.study_card import MeshChoice

#: Typical number of runs of a feedback (2 to 7 in docs/evidence/two-way.md).
USUAL_RUNS = 5
#: Largest number of additional readings in a phase with slip.
SLIP_READINGS = 24
#: s of strain cycles in large motion that are stated before the work begins.
WORTH_TELLING = 20.0


@dataclass(frozen=True, eq=False)
class RunEstimate:
    """Estimate of one run of a study; ``mesh`` replaces the study's mesh settings."""

    study: StudyData
    mesh: MeshChoice

    @classmethod
    def of(cls, study: StudyData) -> RunEstimate:
        """Estimate of an unchanged study."""
        return cls(study, study.card.mesh)

    @functools.cached_property
    def unknowns(self) -> float:
        """Number of unknowns of the heat conduction; 0 for a mesh file, whose size is unknown before it is read."""
        choice = self.mesh
        if choice.file is not None:
            return 0.0
        nodes = expected_nodes(self.study.section, choice.size, mesher=choice.mesher, through=choice.through)
        return nodes * (QUADRATIC if choice.element == "P2" else 1)

    @property
    def readings(self) -> float:
        """Number of times at which temperatures are kept."""
        drive, output = self.study.card.drive, self.study.card.output
        slides = sum(phase.slides for phase in drive.phases)
        return drive.end / output.every + len(drive.phases) + SLIP_READINGS * slides + output.fields

    @functools.cached_property
    def mechanics(self) -> Estimate:
        """Estimate of the strain cycles."""
        card = self.study.card
        if not strain_law(self.study).by_elements or self.mesh.file is not None:
            return Estimate()
        loads, pressures = set(), set()
        for number, phase in enumerate(card.drive.phases):
            carried = phase.load or phase.deflection
            assert carried is not None
            for fraction in ramp_knots(changes_cycle(self.study, number)):
                pressures.add(phase.pressure.at(fraction))
                speed = motion_in(phase, fraction).speed if card.mechanics.rolling else 0.0
                wheel = wheel_state(phase, fraction) if card.boundaries.sliding.rolls and not phase.stands else None
                loads.add((phase.pressure.at(fraction), carried.at(fraction), phase.drum_diameter, speed, wheel))
        feedback = card.mechanics.feedback
        again = 1 if feedback is None else self._runs * feedback.knots
        nodes = QUADRATIC * expected_nodes(
            self.study.section, element_size(self.study.section, self.mesh.size), through=1
        )
        rolled = len({case for case in loads if case[-1] is not None})
        return estimate.mechanics(
            nodes, len(pressures) * again, len(loads) * again, large=self._presses_in_large_motion
        ) + estimate.rolling(nodes, len(pressures) * again if rolled else 0, rolled * again)

    @property
    def _presses_in_large_motion(self) -> bool:
        return strain_law(self.study).presses and self.study.card.mechanics.motion == "large"

    @property
    def _runs(self) -> int:
        feedback = self.study.card.mechanics.feedback
        return 1 if feedback is None else min(USUAL_RUNS, feedback.iterations)

    @property
    def transient_run(self) -> Estimate:
        """Estimate of the temperatures in one run."""
        card = self.study.card
        return estimate.transient_run(
            self.unknowns, self.readings, len(card.drive.phases), card.numerics.tolerance, card.output.fields
        )

    @property
    def total(self) -> Estimate:
        """Estimate of the whole study."""
        transient_run = self.transient_run
        return self.mechanics + Estimate(transient_run.memory, transient_run.time * self._runs)

    def check(self, workers: int = 1) -> None:
        """Refuse a study if ``workers`` simultaneous runs do not fit in the free memory.

        Raises
        ------
        InputError : names the number of the mesh or output that needs the memory, and a value that would fit.
        """
        needed = self.total.memory
        if needed < estimate.SMALL:
            return
        free = memory.free_memory() / workers
        if needed <= free:
            return
        kept = estimate.history(self.unknowns, self.readings)
        blamed = self._output(free) if kept > needed / 2 else None
        field, what, fits = blamed if blamed and blamed[2] else self._meshed(free)
        try:
            estimate.raise_memory_error(needed, free, what, fits, workers)
        except InputError as error:
            raise error.within(field=field, file=self.study.file) from None

    def announce(self) -> None:
        """Refuse a run that does not fit (see `check`); warn of a long run."""
        self.check()
        card = self.study.card
        many = estimate.steps(len(card.drive.phases), card.numerics.tolerance)
        parts = [f"{self.unknowns:,.0f} unknowns", f"{many:,.0f} time steps", f"{self.readings:,.0f} readings"]
        if self.mechanics.time > self.total.time / 2:
            parts.append("most of it strain cycles by finite elements")
        what = f"a run of {self.study.name} ({', '.join(parts)})"
        estimate.warn_if_long(self.total.time, what, lambda: self.quick_look(lambda run: run.total.time))

    @property
    def beginning(self) -> str:
        """What a run does before its first time step, if that takes long: footprints in large motion."""
        time = self.mechanics.time
        if time < WORTH_TELLING or not self._presses_in_large_motion:
            return ""
        return f", first its strain cycles in large motion: about {estimate.duration(time)}"

    def quick_look(self, time: Callable[[RunEstimate], float]) -> str:
        """What work takes with a linear footprint; empty if that does not halve it. ``time``: s of the work."""
        if not self._presses_in_large_motion:
            return ""
        linear = time(RunEstimate(self.study.replace({"mechanics.motion": "linear"}), self.mesh))
        return f"; {QUICK_LOOK}: {estimate.duration(linear)}" if linear < time(self) / 2 else ""

    def _output(self, free: float) -> tuple[str, str, str]:
        """Too many readings: the field, their number, and a value that would fit."""
        output, end = self.study.card.output, self.study.card.drive.end
        left = free - (self.total.memory - estimate.history(self.unknowns, self.readings))
        room = left / estimate.history(self.unknowns, 1)
        if output.fields > end / output.every:
            most = int(room - end / output.every)
            fits = f"{most} or fewer would fit" if most >= 2 else ""
            return "output.fields", f"{output.fields:,} fields of {self.unknowns:,.0f} unknowns", fits
        others = self.readings - end / output.every
        every = estimate.smallest(lambda every: end / every + others <= room, output.every, max(end, output.every))
        fits = f"{every:g} s or more would fit" if every else ""
        return "output.every", f"{output.every:g} s makes {self.readings:,.0f} readings", fits

    def _meshed(self, free: float) -> tuple[str, str, str]:
        """Too fine a mesh: the field, the number of unknowns, and a value that would fit."""
        mesh = self.mesh

        def needed(**changes: float) -> float:
            return replace(self, mesh=mesh.model_copy(update=changes)).total.memory

        if needed(through=1) <= min(free, self.total.memory / 2):
            most = max((n for n in range(1, mesh.through) if needed(through=n) <= free), default=1)
            return "mesh.through", f"{mesh.through} makes {self.unknowns:,.0f} unknowns", f"{most} would fit"
        size = estimate.smallest(
            lambda coarser: needed(size=coarser) <= free, mesh.size, self.study.section.line.length / 4
        )
        fits = f"{size * 1e3:g} mm or more would fit" if size else ""
        return "mesh.size", f"{mesh.size * 1e3:g} mm makes {self.unknowns:,.0f} unknowns", fits
