"""The simulations of a comparison: every drive as it is, and with one uncertain input changed."""

from __future__ import annotations

import functools
import pickle
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from tyrefem.compare.interface import Computed, arrays_of, computed_from, computed_of
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.uncertain_numbers import uncertain_number
from tyrefem.mechanics.cycle_schedule import CycleSchedule, same_cycles
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.output import versions
from tyrefem.reduced.training import Snapshots, snapshots
from tyrefem.simulation.result import ResultData
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.run import run
from tyrefem.simulation.simulate import simulate
from tyrefem.variants.answer_store import AnswerStore, digest, effects_source, plain
from tyrefem.variants.task import Bundle, bundle, unpacked

#: Drive and changed input; None: as the study has it.
Key = tuple[str, str | None]
#: Fields taken of a full run to learn from.
FIELDS = 30
#: Names under which runs are kept: with what a reduced model learns of them, without, and those of such a model.
TAUGHT, FULL, REDUCED = "taught", "full", "reduced"


@dataclass(frozen=True, eq=False)
class PackedDrive:
    """A drive as it is, for any process: its changed runs share its mesh, operators and strain cycles.

    Parameters
    ----------
    packed : its study. first : the drive whose mesh all share; None: this one. cycles : file with its strain cycles, if
        they take long to solve; where it cannot be read they are solved again.
    """

    packed: Bundle
    first: PackedDrive | None = None
    cycles: str = ""

    @property
    def tyre(self) -> RollingTyre:
        """Its tyre, made once in a process."""
        if self.name not in _TYRES:
            like = None if self.first is None else self.first.tyre
            study = unpacked(self.packed)
            _TYRES[self.name] = RollingTyre(
                study if like is None else study.replace({}, like.study), like, self._read()
            )
        return _TYRES[self.name]

    @property
    def name(self) -> str:
        """Of this drive among those that a process has met."""
        return self.packed.digest + self.cycles

    def _read(self) -> CycleSchedule | None:
        # Written by the process that gave the work, see `Runs.begin`.
        with suppress(OSError):
            cycles: CycleSchedule | None = pickle.loads(Path(self.cycles).read_bytes()) if self.cycles else None
            return cycles
        return None


#: Tyres of drives in this process.
_TYRES: dict[str, RollingTyre] = {}


@dataclass(frozen=True, eq=False)
class Work:
    """A drive with some of its study's numbers changed, by dotted names; none: as it is."""

    drive: PackedDrive
    changes: Mapping[str, Any] = field(default_factory=dict)

    @property
    def tyre(self) -> RollingTyre:
        """The tyre; what it has in common with its drive's is shared."""
        base = self.drive.tyre
        if not self.changes:
            return base
        study = base.study.replace(self.changes, base.study)
        return RollingTyre(study, base, base.cycles if same_cycles(study, base.study) else None)

    def result(self) -> ResultData:
        """Simulate it."""
        tyre = self.tyre
        return simulate(tyre) if tyre.study.card.mechanics.feedback is None else run(tyre.study)


def _computed(result: ResultData) -> Computed:
    # The study need not travel: who gave the work has it.
    return replace(computed_of(result), study=None)


def driven(packed: Bundle) -> tuple[Computed, Snapshots, CycleSchedule | None]:
    """Done in a worker: a drive as it is, and its strain cycles if they took long."""
    result = run(unpacked(packed))
    return _computed(result), snapshots(result, FIELDS), _dear(result)


def _dear(result: ResultData) -> CycleSchedule | None:
    dear = strain_law(result.study).by_elements and result.study.card.mechanics.feedback is None
    return result.tyre.schedule if dear else None


def taught(work: Work) -> tuple[Computed, Snapshots]:
    """Done in a worker: a full run, and what a reduced model learns of it."""
    result = work.result()
    return _computed(result), snapshots(result, FIELDS)


def full(work: Work) -> Computed:
    """Done in a worker: a full run."""
    return _computed(work.result())


def store_key(study: StudyData) -> str:
    """Digest of what decides the runs of a study and its uncertain numbers."""
    return digest([versions(), effects_source(), plain(study)])


@dataclass(eq=False)
class Runs:
    """Makes the runs of a comparison, in this process or in several, and keeps what is finished; a context manager.

    Parameters
    ----------
    studies : (drive, input) -> study; input None: the drive as it is, else with the input one sd higher.
    keys : input -> its relative standard deviation. known : drive -> its result, where it is at hand.
    executor : makes runs side by side. store : keeps them, opened. done : called with how many are made.
    """

    studies: Mapping[Key, StudyData]
    keys: Mapping[str, float]
    known: Mapping[str, ResultData] = field(default_factory=dict)
    executor: Executor | None = None
    store: AnswerStore | None = None
    done: Callable[[int], None] = lambda count: None
    #: (drive, input) -> its run, as far as made; what a reduced model learns of those made to learn from.
    computed: dict[Key, Computed] = field(default_factory=dict)
    learnt: list[Snapshots] = field(default_factory=list)

    def __enter__(self) -> Runs:
        self._folder = tempfile.TemporaryDirectory(prefix="tyrefem-")
        self._drives: dict[str, PackedDrive] = {}
        return self

    def __exit__(self, *_: object) -> None:
        for drive in self._drives.values():
            _TYRES.pop(drive.name, None)
        self._folder.cleanup()

    @property
    def drives(self) -> list[str]:
        """All drives."""
        return [drive for drive, name in self.studies if name is None]

    @property
    def changed(self) -> list[Key]:
        """All runs with a changed input."""
        return [key for key in self.studies if key[1] is not None]

    def workload(self, *, model: bool) -> str:
        """How many simulations there are, in a sentence. ``model``: a reduced one is tried."""
        drives, changed = len(self.drives), self.changed
        parts = [f"{drives} drive{'' if drives == 1 else 's'} as driven"]
        if changed:
            fewer = ", fewer if a reduced model holds" if model else ""
            parts.append(f"{len(changed)} with one uncertain input changed{fewer}")
        if self._by_elements:
            parts.append(f"strain cycles to be solved by finite elements: {drives + self._moved}")
        # The drives themselves are run again, for their meshes, unless nothing else is left to do.
        kept = len(self.computed) or sum(self._has(key) for key in changed)
        if kept:
            parts.append(f"{kept} are taken up from an interrupted comparison")
        return f"{len(self.studies)} simulations: {'; '.join(parts)}"

    @property
    def cost(self) -> list[str]:
        """For the notes: what the changed inputs cost, where strain cycles take longer than a run."""
        if not self.changed or not self._by_elements:
            return []
        return [
            f"Note: {len(self.changed)} runs with a changed input; {self._moved} of them change the strain cycle, "
            "which finite elements solve anew"
        ]

    @property
    def _by_elements(self) -> bool:
        return strain_law(self.studies[self.drives[0], None]).by_elements

    @functools.cached_property
    def _moved(self) -> int:
        return sum(not same_cycles(self.studies[key], self.studies[key[0], None]) for key in self.changed)

    def work(self, key: Key, *, lowered: bool = False) -> Work:
        """How a run is made, after `begin`; ``lowered``: with the input one standard deviation lower instead."""
        drive, name = key
        if name is None:
            return Work(self._drives[drive])
        factor = 1.0 + self.keys[name]
        number = uncertain_number(self.studies[drive, None], name)
        return Work(self._drives[drive], number.changes(1 / factor if lowered else factor))

    def each(self, function: Callable[[Any], Any], work: Iterable[Any]) -> Iterator[Any]:
        """The function's answers, in order."""
        return map(function, work) if self.executor is None else self.executor.map(function, work)

    def begin(self) -> None:
        """Run every drive as it is; its strain cycles are solved once for all its changed runs."""
        cycles = {drive: _dear(result) for drive, result in self.known.items()}
        packed = {drive: bundle(self.studies[drive, None]) for drive in self.drives}
        for drive, result in self.known.items():
            self._add((drive, None), computed_of(result), snapshots(result, FIELDS))
        left = [drive for drive in self.drives if drive not in self.known]
        answers = self._answers(driven, [packed[drive] for drive in left], [(drive, None) for drive in left])
        for drive, (computed, lesson, cycles[drive]) in zip(left, answers, strict=True):
            self._add((drive, None), computed, lesson)
            self._keep(FULL, (drive, None), arrays_of(computed))
            self.done(len(self.computed))
        first: PackedDrive | None = None
        for number, drive in enumerate(self.drives):
            path = Path(self._folder.name) / f"{number}.pickle"
            if cycles[drive] is not None:
                path.write_bytes(pickle.dumps(cycles.pop(drive)))
            self._drives[drive] = PackedDrive(packed[drive], first, str(path) if path.exists() else "")
            first = first or self._drives[drive]

    def teach(self, keys: Sequence[Key]) -> None:
        """Full runs, which are learnt from too."""
        left = []
        for key in keys:
            arrays = self._kept(TAUGHT, key)
            if arrays is None:
                left.append(key)
            else:
                self._add(key, computed_from(arrays[:-2], None), Snapshots(*arrays[-2:]))
        answers = self._answers(taught, [self.work(key) for key in left], left)
        for key, (computed, lesson) in zip(left, answers, strict=True):
            self._add(key, computed, lesson)
            self._keep(TAUGHT, key, (*arrays_of(computed), lesson.fields, lesson.sources))
            self.done(len(self.computed))

    def fill(self) -> None:
        """Full runs of all that are not made yet."""
        self._take_up(self.changed, (FULL, TAUGHT))
        # The same change at one drive after the other: what takes long to find for a change, its drives may share.
        order = {name: number for number, name in enumerate(self.keys)}
        left = sorted((key for key in self.changed if key not in self.computed), key=lambda key: order[str(key[1])])
        answers = self._answers(full, [self.work(key) for key in left], left)
        for key, computed in zip(left, answers, strict=True):
            self._record(key, computed)
            self._keep(FULL, key, arrays_of(computed))
            self.done(len(self.computed))

    def take(self, reduced: Mapping[Key, Computed]) -> None:
        """Runs of a reduced model that was found good."""
        for key, computed in reduced.items():
            self._record(key, computed)
            self._keep(REDUCED, key, arrays_of(computed))
        self.done(len(self.computed))

    def take_up_all(self, *, reduced: bool) -> bool:
        """Take up everything; False, and nothing is taken: some of it is missing. ``reduced``: such runs too."""
        for drive, result in self.known.items():
            self._record((drive, None), computed_of(result))
        self._take_up(list(self.studies), (FULL, TAUGHT, REDUCED) if reduced else (FULL, TAUGHT))
        if len(self.computed) == len(self.studies):
            return True
        self.computed.clear()
        return False

    def note(self, verdict: Any) -> None:
        """Keep what became of the reduced model: numbers, or why there is none."""
        self._keep(REDUCED, "verdict", np.array(verdict))

    @property
    def noted(self) -> Any:
        """What `note` has kept; None: nothing."""
        return self._kept(REDUCED, "verdict")

    def _take_up(self, keys: Sequence[Key], names: Sequence[str]) -> None:
        for key in keys:
            for name in names:
                arrays = None if key in self.computed else self._kept(name, key)
                if arrays is not None:
                    self._record(key, computed_from(arrays[:5], None))
        self.done(len(self.computed))

    def _answers(self, function: Callable[[Any], Any], work: Sequence[Any], keys: Sequence[Key]) -> Iterator[Any]:
        """Of work for these runs: errors name the study's file."""
        answers = iter(self.each(function, work))
        for key in keys:
            try:
                yield next(answers)
            except InputError as error:
                raise error if error.file else error.within(file=self.studies[key].file) from None

    def _record(self, key: Key, computed: Computed) -> None:
        self.computed[key] = replace(computed, study=self.studies[key])

    def _add(self, key: Key, computed: Computed, lesson: Snapshots) -> None:
        self._record(key, computed)
        self.learnt.append(lesson)

    def _has(self, key: Key) -> bool:
        return self.store is not None and any(self.store.has(name, key) for name in (FULL, TAUGHT))

    def _kept(self, name: str, key: Any) -> Any:
        return None if self.store is None else self.store.known(name, key)

    def _keep(self, name: str, key: Any, arrays: Any) -> None:
        if self.store is not None:
            self.store.keep(name, key, arrays)
