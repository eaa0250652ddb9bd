"""A drive of a comparison for any process, and its runs with one changed input."""

from __future__ import annotations

import pickle
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.cycle_schedule import CycleSchedule, cycle_schedule, same_cycles
from tyrefem.mechanics.nearby_cycles import NearbyCycles, SolvedCycles
from tyrefem.mechanics.point_energies import PointEnergies
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.plugins.kind import is_ours
from tyrefem.simulation.result import ResultData
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.run import run
from tyrefem.simulation.simulate import simulate
from tyrefem.variants.task import Bundle, unpacked


@dataclass(frozen=True, eq=False)
class PackedDrive:
    """An unchanged drive for any process; its changed runs share its mesh, operators and strain cycles.

    Parameters
    ----------
    packed : the study. first : the drive whose mesh all drives share; None: this drive. cycles : file with strain
        cycles that are costly to solve; if it cannot be read they are solved again. changed : folder of strain cycles
        with one changed input, which drives of the same tyre share; if there is none they are solved again.
    """

    packed: Bundle
    first: PackedDrive | None = None
    cycles: str = ""
    changed: str = ""

    @property
    def tyre(self) -> RollingTyre:
        """The tyre of the drive, made once in a process."""
        if self.name not in _TYRES:
            like = None if self.first is None else self.first.tyre
            study, cycles = unpacked(self.packed), self._read()
            study = study if like is None else study.replace({}, like.study)
            _TYRES[self.name] = RollingTyre(study, like, cycles, self._near(study, cycles))
        return _TYRES[self.name]

    @property
    def name(self) -> str:
        """Unique name of the drive in a process."""
        return self.packed.digest + self.cycles

    def forget(self) -> None:
        """Forget the tyre of the drive in this process."""
        _TYRES.pop(self.name, None)

    def _read(self) -> CycleSchedule | None:
        # The file is written by the main process, see `Runs.begin`.
        with suppress(OSError):
            cycles: CycleSchedule | None = pickle.loads(Path(self.cycles).read_bytes()) if self.cycles else None
            return cycles
        return None

    def _near(self, study: StudyData, cycles: CycleSchedule | None) -> NearbyCycles | None:
        if cycles is None or not all(
            isinstance(getattr(cycle, "energies", None), PointEnergies) for each in cycles.cycles for cycle in each
        ):
            return None
        folder = Path(self.changed) if self.changed and Path(self.changed).is_dir() else None
        return NearbyCycles(study, SolvedCycles(folder), cycles)


#: Tyres of drives in this process.
_TYRES: dict[str, RollingTyre] = {}


@dataclass(frozen=True, eq=False)
class Work:
    """A run: a drive with ``changes`` of its study by dotted names; empty: unchanged."""

    drive: PackedDrive
    changes: Mapping[str, Any] = field(default_factory=dict)

    @property
    def tyre(self) -> RollingTyre:
        """The tyre; it shares mesh, operators and, if unchanged, strain cycles with the tyre of its drive.

        Changed strain cycles by finite elements start from those of the drive (`NearbyCycles`).
        """
        base = self.drive.tyre
        if not self.changes:
            return base
        study = base.study.replace(self.changes, base.study)
        if same_cycles(study, base.study):
            return RollingTyre(study, base, base.cycles)
        if base.near is not None and study.section != base.study.section:
            # Energies of another section have other places.
            return RollingTyre(study, base, cycle_schedule(study))
        return RollingTyre(study, base)

    def result(self) -> ResultData:
        """The simulated run."""
        tyre = self.tyre
        return simulate(tyre) if tyre.study.card.mechanics.feedback is None else run(tyre.study)


def solve_cycles(changed: Sequence[Work]) -> None:
    """In a worker: solve the strain cycles of changed runs, for all processes. Errors appear in the run itself."""
    for work in changed:
        with suppress(InputError):
            _ = work.tyre.schedule


def nearby_cycles(study: StudyData, base: StudyData) -> bool:
    """Whether the strain cycles of a changed study start from those of the unchanged one, ``base``."""
    law = strain_law(study)
    feedback = base.card.mechanics.feedback is not None
    return law.by_elements and is_ours(type(law)) and not feedback and study.section == base.section


def same_tyre(study: StudyData, other: StudyData) -> bool:
    """Whether two studies differ in their drives only, as far as strain cycles see."""
    return (
        study.section == other.section
        and study.card.mesh == other.card.mesh
        and study.data.get("mechanics") == other.data.get("mechanics")
        and study.card.boundaries.sliding == other.card.boundaries.sliding
        and dict(study.materials) == dict(other.materials)
    )
