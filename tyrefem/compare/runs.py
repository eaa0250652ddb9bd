"""The simulations of a comparison: every drive unchanged, and with one changed uncertain input."""

from __future__ import annotations

import functools
import pickle
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from tyrefem.brief import counted
from tyrefem.compare.changed_cycles import ChangedCycles, Key
from tyrefem.compare.interface import Computed, arrays_of, computed_from, computed_of
from tyrefem.compare.packed_drive import PackedDrive, Work
from tyrefem.errors import InputError
from tyrefem.estimates import work as estimate
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.uncertain_numbers import uncertain_number
from tyrefem.mechanics.cycle_schedule import CycleSchedule, same_cycles
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.output import versions
from tyrefem.reduced.training import Snapshots, snapshots
from tyrefem.simulation.estimate import WORTH_TELLING, RunEstimate
from tyrefem.simulation.result import ResultData
from tyrefem.simulation.run import run
from tyrefem.variants.answer_store import AnswerStore, digest, effects_source, plain
from tyrefem.variants.task import Bundle, bundle, unpacked

#: Number of fields of a full run for training.
FIELDS = 30
#: Time of a footprint that starts from a nearby one, over that from the free tyre.
NEARBY = 0.2
#: Names under which runs are kept: full runs with training data, full runs, and reduced runs.
TRAINING, FULL, REDUCED = "taught", "full", "reduced"


def _computed(result: ResultData) -> Computed:
    # The main process has the study, so it is not sent back.
    return replace(computed_of(result), study=None)


def base_run(packed: Bundle) -> tuple[Computed, Snapshots, CycleSchedule | None]:
    """In a worker: an unchanged drive, its training data, and its strain cycles if they are costly."""
    result = run(unpacked(packed))
    return _computed(result), snapshots(result, FIELDS), _costly_cycles(result)


def _costly_cycles(result: ResultData) -> CycleSchedule | None:
    costly = strain_law(result.study).by_elements and result.study.card.mechanics.feedback is None
    return result.tyre.schedule if costly else None


def training_run(work: Work) -> tuple[Computed, Snapshots]:
    """In a worker: a full run and its training data."""
    result = work.result()
    return _computed(result), snapshots(result, FIELDS)


def full_run(work: Work) -> Computed:
    """In a worker: a full run."""
    return _computed(work.result())


def store_key(study: StudyData) -> str:
    """Digest of all inputs that affect the runs of a study."""
    return digest([versions(), effects_source(), plain(study)])


@dataclass(eq=False)
class Runs:
    """The runs of a comparison in one or several processes; finished runs are kept. It is a context manager.

    Parameters
    ----------
    studies : (drive, input) -> study with the input one sd higher; input None: unchanged drive.
    keys : input -> its relative standard deviation. known : drive -> its result, if it is available.
    executor : makes runs in parallel. store : store of finished runs. done : called with the number of finished runs.
    """

    studies: Mapping[Key, StudyData]
    keys: Mapping[str, float]
    known: Mapping[str, ResultData] = field(default_factory=dict)
    executor: Executor | None = None
    store: AnswerStore | None = None
    done: Callable[[int], object] = lambda count: None
    #: (drive, input) -> finished run; training data of a reduced model.
    computed: dict[Key, Computed] = field(default_factory=dict)
    training: list[Snapshots] = field(default_factory=list)

    def __enter__(self) -> Runs:
        self._folder = tempfile.TemporaryDirectory(prefix="tyrefem-")
        self._drives: dict[str, PackedDrive] = {}
        self._cycles = ChangedCycles(self.studies, Path(self._folder.name), self.each)
        self._shown = 0
        return self

    def __exit__(self, *_: object) -> None:
        for drive in self._drives.values():
            drive.forget()
        self._folder.cleanup()

    @property
    def drives(self) -> list[str]:
        """The drives."""
        return [drive for drive, name in self.studies if name is None]

    @property
    def changed(self) -> list[Key]:
        """All runs with a changed input."""
        return [key for key in self.studies if key[1] is not None]

    def workload(self, *, model: bool) -> str:
        """The number of simulations as text. ``model``: a reduced model is tried."""
        drives, changed = len(self.drives), self.changed
        parts = [f"{counted(drives, 'drive')} as driven"]
        if changed:
            fewer = ", fewer if a reduced model holds" if model else ""
            parts.append(f"{len(changed)} with one uncertain input changed{fewer}")
        if self._by_elements:
            parts.append(
                f"strain cycles to be solved by finite elements: {drives + self._changed_cycles}{self._cycles_time}"
            )
        # The unchanged drives are run again for their meshes, unless all runs are kept.
        kept = len(self.computed) or sum(self._is_kept(key) for key in changed)
        if kept:
            parts.append(f"{kept} are reused from an interrupted comparison")
        return f"{counted(len(self.studies), 'simulation')}: {'; '.join(parts)}"

    @property
    def cost(self) -> list[str]:
        """Note on the cost of changed inputs, if strain cycles are by finite elements."""
        if not self.changed or not self._by_elements:
            return []
        return [
            f"Note: {counted(len(self.changed), 'run')} with a changed input; {self._changed_cycles} of them change "
            "the strain cycle, which is solved from that of the drive"
        ]

    @property
    def _by_elements(self) -> bool:
        return strain_law(self.studies[self.drives[0], None]).by_elements

    @functools.cached_property
    def _changed_cycles(self) -> int:
        return sum(not same_cycles(self.studies[key], self.studies[key[0], None]) for key in self.changed)

    @property
    def _cycles_time(self) -> str:
        """Time of strain cycles in large motion; empty if it is short."""
        count = len(self.drives) + NEARBY * self._changed_cycles
        run = RunEstimate.of(self.studies[self.drives[0], None])
        time = count * run.mechanics.time
        if time < WORTH_TELLING or run.study.card.mechanics.motion == "linear":
            return ""
        return f", about {estimate.duration(time)}{run.quick_look(lambda run: count * run.mechanics.time)}"

    def work(self, key: Key, *, lowered: bool = False) -> Work:
        """The work of a run, after `begin`; ``lowered``: the input is one standard deviation lower, not higher."""
        drive, name = key
        if name is None:
            return Work(self._drives[drive])
        factor = 1.0 + self.keys[name]
        number = uncertain_number(self.studies[drive, None], name)
        return Work(self._drives[drive], number.changes(1 / factor if lowered else factor))

    def each(self, function: Callable[[Any], Any], work: Iterable[Any]) -> Iterator[Any]:
        """The results of the function, in the order of ``work``."""
        return map(function, work) if self.executor is None else self.executor.map(function, work)

    def begin(self, ahead: Sequence[Key] = ()) -> None:
        """Run every unchanged drive; its changed runs share its strain cycles.

        ``ahead``: changed runs whose strain cycles other processes begin as soon as their drives are there.
        """
        cycles = {drive: _costly_cycles(result) for drive, result in self.known.items()}
        packed = {drive: bundle(self.studies[drive, None]) for drive in self.drives}
        for drive, result in self.known.items():
            self._add((drive, None), computed_of(result), snapshots(result, FIELDS))
        left = [drive for drive in self.drives if drive not in self.known]
        answers = self._answers(base_run, [packed[drive] for drive in left], [(drive, None) for drive in left])
        waiting: list[Key] = []
        for number, drive in enumerate(self.drives):
            if drive not in self.known:
                computed, sample, cycles[drive] = next(answers)
                self._add((drive, None), computed, sample)
                self._keep(FULL, (drive, None), arrays_of(computed))
                self._show()
            self._pack(drive, packed[drive], cycles.pop(drive))
            waiting += [key for key in ahead if key[0] == drive]
            after = self.drives[number + 1 : number + 2]
            alone = len({of for of, _ in waiting}) == 1
            if not (alone and after and self._cycles.same_inflation(drive, after[0])):
                self._cycles.begin(waiting, self.work)
                waiting = []

    def _pack(self, drive: str, packed: Bundle, cycles: CycleSchedule | None) -> None:
        """Put a drive, with its costly strain cycles, where any process finds it."""
        first, number = next(iter(self._drives.values()), None), len(self._drives)
        if cycles is None:
            self._drives[drive] = PackedDrive(packed, first)
            return
        path = Path(self._folder.name) / f"{number}.pickle"
        path.write_bytes(pickle.dumps(cycles))
        self._drives[drive] = PackedDrive(packed, first, str(path), self._cycles.folder_of(drive, cycles))

    def solve_cycles(self, keys: Iterable[Key]) -> None:
        """Solve the changed strain cycles of runs, each once: drives with the same load cases share them."""
        self._cycles.begin(keys, self.work)
        for _ in self._cycles.finish():
            self._show()

    def run_for_training(self, keys: Sequence[Key]) -> None:
        """Full runs whose fields are training data too."""
        left = []
        for key in keys:
            arrays = self._kept(TRAINING, key)
            if arrays is None:
                left.append(key)
            else:
                self._add(key, computed_from(arrays[:-2], None), Snapshots(*arrays[-2:]))
        answers = self._answers(training_run, [self.work(key) for key in left], left)
        for key, (computed, sample) in zip(left, answers, strict=True):
            self._add(key, computed, sample)
            self._keep(TRAINING, key, (*arrays_of(computed), sample.fields, sample.sources))
            self._show()

    def fill(self) -> None:
        """Full runs of all inputs that have no run yet."""
        self._resume(self.changed, (FULL, TRAINING))
        # Drives with the same change follow each other, because they can share costly intermediate results.
        order = {name: number for number, name in enumerate(self.keys)}
        left = sorted((key for key in self.changed if key not in self.computed), key=lambda key: order[str(key[1])])
        self.solve_cycles(left)
        answers = self._answers(full_run, [self.work(key) for key in left], left)
        for key, computed in zip(left, answers, strict=True):
            self._record(key, computed)
            self._keep(FULL, key, arrays_of(computed))
            self._show()

    def take(self, reduced: Mapping[Key, Computed]) -> None:
        """Take the runs of a certified reduced model."""
        for key, computed in reduced.items():
            self._record(key, computed)
            self._keep(REDUCED, key, arrays_of(computed))
        self._show()

    def resume_all(self, *, reduced: bool) -> bool:
        """Resume all runs from the store, with ``reduced`` also reduced runs; False, and none, if a run is missing."""
        for drive, result in self.known.items():
            self._record((drive, None), computed_of(result))
        self._resume(list(self.studies), (FULL, TRAINING, REDUCED) if reduced else (FULL, TRAINING))
        if len(self.computed) == len(self.studies):
            return True
        self.computed.clear()
        return False

    def keep_verdict(self, verdict: Any) -> None:
        """Keep the outcome of the reduced model: numbers of its certificate, or the reason why there is none."""
        self._keep(REDUCED, "verdict", np.array(verdict))

    @property
    def kept_verdict(self) -> Any:
        """The outcome that `keep_verdict` has kept, or None."""
        return self._kept(REDUCED, "verdict")

    def _resume(self, keys: Sequence[Key], names: Sequence[str]) -> None:
        for key in keys:
            for name in names:
                arrays = None if key in self.computed else self._kept(name, key)
                if arrays is not None:
                    self._record(key, computed_from(arrays[:5], None))
        self._show()

    def _answers(self, function: Callable[[Any], Any], work: Sequence[Any], keys: Sequence[Key]) -> Iterator[Any]:
        """Results of the function for these runs; errors name the study's file."""
        answers = iter(self.each(function, work))
        for key in keys:
            try:
                yield next(answers)
            except InputError as error:
                raise error if error.file else error.within(file=self.studies[key].file) from None

    def _show(self) -> None:
        """Tell how many runs are finished; a solved strain cycle counts as its run until this is finished."""
        pending = len(self._cycles.solved - self.computed.keys())
        self._shown = max(self._shown, len(self.computed) + pending)
        self.done(self._shown)

    def _record(self, key: Key, computed: Computed) -> None:
        self.computed[key] = replace(computed, study=self.studies[key])

    def _add(self, key: Key, computed: Computed, sample: Snapshots) -> None:
        self._record(key, computed)
        self.training.append(sample)

    def _is_kept(self, key: Key) -> bool:
        return self.store is not None and any(self.store.has(name, key) for name in (FULL, TRAINING))

    def _kept(self, name: str, key: Any) -> Any:
        return None if self.store is None else self.store.known(name, key)

    def _keep(self, name: str, key: Any, arrays: Any) -> None:
        if self.store is not None:
            self.store.keep(name, key, arrays)
