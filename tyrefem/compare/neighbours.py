"""Runs with one uncertain input changed, by a reduced model of the drives' own runs, tried on full ones."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tyrefem.compare.computed import Computed, computed_of
from tyrefem.errors import InputError
from tyrefem.mechanics import BY_ELEMENTS, same_cycles
from tyrefem.reduced.answers import reduced_outcomes
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.residual import corrected
from tyrefem.reduced.school import HORIZONS
from tyrefem.reduced.train import Fineness, Snapshots, snapshots, trained
from tyrefem.reduced.variant import Variant
from tyrefem.reduced.work import Packed, pack, remember
from tyrefem.result import Result
from tyrefem.rolling import RollingTyre, run
from tyrefem.studies import Study
from tyrefem.sweep.bundle import bundle

#: K: a reading of a changed run may be off by this much, or by twice the time error that the study allows full runs,
#: as either of the two that are compared may be off by that.
FINEST = 0.02
#: Share of that which the fresh runs may take up.
SAFETY = 0.8
#: Fresh runs that a certificate needs at least; how often one is tried; fields taken of a full run.
FRESH, TRIALS, FIELDS = 3, 2, 30
#: Rounds of corrections before the first certificate, or as many as drives; the modes' share of the tolerance.
ROUNDS, FINER = 2, 0.25
#: With fewer changed runs a model is not worth its making.
WORTH = 12

#: Drive and changed input; None: as the study has it.
Key = tuple[str, str | None]
Each = Callable[..., Iterable[Any]]


@dataclass(frozen=True, eq=False)
class Certificate:
    """What full runs say of those of the reduced model.

    Parameters
    ----------
    worst : largest difference of any reading to ``cases`` full runs that it had not learnt from, K; ``tolerance`` is
        what was allowed. reduced, full : changed runs by either. corrections : that it learnt from besides full runs.
    """

    worst: float
    tolerance: float
    cases: int
    reduced: int
    full: int
    corrections: int

    @property
    def sentence(self) -> str:
        """For the notes of a comparison."""
        return (
            f"Note: {self.reduced} of {self.reduced + self.full} runs with a changed input are a reduced model's; "
            f"{self.cases} full ones differ from it by {self.worst:.2g} K at most"
        )


def taught(study: Study) -> tuple[Computed, Snapshots]:
    """Done in a worker: a full run, and what a reduced model learns of it."""
    result = run(study)
    return computed_of(result), snapshots(result, FIELDS)


def amended(work: tuple[Packed, Study, float]) -> Snapshots | None:
    """Done in a worker: what the full model makes of the reduced run of a study, over a horizon.

    None: no reduced model can follow it. It will be run in full, which says what is wrong, if anything is.
    """
    packed, study, share = work
    model = packed.unpacked()
    try:
        return corrected(model, RollingTyre(study.replace({}, model.base.study), model.base), share)[0]
    except InputError:
        return None


def followed(studies: Mapping[Key, Study]) -> dict[Key, Study]:
    """The runs that a reduced model is worth making for: of strain cycles that take longer than a run, those that have
    their drive's.

    What changes the strain cycle needs a solution of its own either way, and more of them to learn from.
    """
    return {
        (drive, name): study
        for (drive, name), study in studies.items()
        if study.card.mechanics.strain not in BY_ELEMENTS or name is None or same_cycles(study, studies[drive, None])
    }


@dataclass(eq=False)
class Neighbours:
    """Runs of some drives, and of each with one input changed.

    A changed run is its drive's full run plus what the reduced model says that the change does: what the model gets
    wrong in both drops out.

    Parameters
    ----------
    studies : (drive, input) -> study; input None: the drive as it is.
    lowered : the study of a drive with an input lowered instead, to learn from.
    known : drive -> its result, where it is at hand. each : `map`, or that of an executor.
    done : called with every full run that was added to ``found``, and with the reduced ones at last.
    """

    studies: Mapping[Key, Study]
    lowered: Callable[[str, str], Study]
    known: Mapping[str, Result]
    each: Each
    done: Callable[[int], None] = lambda count: None
    found: dict[Key, Computed] = field(default_factory=dict)
    learnt: list[Snapshots] = field(default_factory=list)
    rounds: int = 0
    corrections: int = 0

    def __post_init__(self) -> None:
        self.study = next(one for (_, name), one in self.studies.items() if name is None)
        if self.study.card.mechanics.feedback is not None:
            raise NotReducibleError("strain cycles that follow the temperature")
        if len(self.wanted) < WORTH:
            raise NotReducibleError(f"fewer than {WORTH} runs with a changed input")
        self.tolerance = max(FINEST, 2 * self.study.tolerance)
        self.packed = bundle(self.study)
        self.base = RollingTyre(self.study)
        remember(self.packed, self.base)

    @property
    def wanted(self) -> list[Key]:
        """All changed runs."""
        return [key for key in self.studies if key[1] is not None]

    def solve(self) -> Certificate:
        """Fill ``found`` with every run.

        Raises
        ------
        NotReducibleError : no model, or one that fresh runs do not bear out; ``found`` has the full runs made so far.
        """
        for drive, name in self.studies:
            if name is None and RollingTyre(self._beside(drive, name), self.base).mesh is not self.base.mesh:
                raise NotReducibleError(f"another mesh{f' at the drive {drive}' if drive else ''}")
        for drive, result in self.known.items():
            self.found[drive, None] = computed_of(result)
            self.learnt.append(snapshots(result, FIELDS))
        self._full([key for key in self.studies if key[1] is None and key not in self.found])
        if len({one.fields.shape[1] for one in self.learnt} | {self.base.problem.operators.size}) > 1:
            raise NotReducibleError("another mesh")
        model, worst = trained(self.base, self.learnt, self._fineness), np.inf
        for trial in range(TRIALS):
            for _ in range(1 if trial else max(ROUNDS, len(self.learnt))):
                model = self._round(model)
            reduced = self._reduced(model)
            fresh = self._fresh(reduced)
            if not fresh:
                break
            self._full(fresh)
            errors = [_difference(reduced[key], self.found[key]) for key in fresh if key in reduced]
            worst = max(errors, default=np.inf)
            if worst <= SAFETY * self.tolerance:
                return self._filled(reduced, worst, len(errors))
        raise NotReducibleError(
            f"full runs are off by {worst:.2g} K; allowed: {SAFETY:g} x {self.tolerance:g} K"
            if np.isfinite(worst)
            else "no run to certify with"
        )

    def _beside(self, drive: str, name: str | None) -> Study:
        """A study that shares with the model's what the two have in common: the section, for one."""
        return self.studies[drive, name].replace({}, self.study)

    @property
    def _fineness(self) -> Fineness:
        return Fineness.of(FINER * self.tolerance)

    def _filled(self, reduced: Mapping[Key, Computed], worst: float, cases: int) -> Certificate:
        """Take the reduced runs; what no reduced model can follow is run in full."""
        missing = [key for key in self.wanted if key not in self.found]
        self._full([key for key in missing if key not in reduced])
        taken = {key: reduced[key] for key in missing if key in reduced}
        self.found |= taken
        self.done(len(self.found))
        count = len(self.wanted) - len(taken)
        return Certificate(worst, self.tolerance, cases, len(taken), count, self.corrections)

    def _full(self, keys: Sequence[Key]) -> None:
        """Full runs, which are learnt too."""
        studies = [self.studies[key] for key in keys]
        for key, (computed, lesson) in zip(keys, self.each(taught, studies), strict=True):
            self.found[key] = computed
            self.learnt.append(lesson)
            self.done(len(self.found))

    def _round(self, model: ReducedModel) -> ReducedModel:
        """Corrections: every input lowered once, at one drive after the other; what is wanted raised stays untaught."""
        drives = [drive for drive, name in self.studies if name is None]
        inputs = dict.fromkeys(name for _, name in self.wanted if name is not None)
        packed, number, work = pack(model, self.packed), self.rounds, []
        for n, name in enumerate(inputs, number):
            # There may be no tyre with a number lowered: then it is not taught.
            with contextlib.suppress(InputError):
                # The model goes with each: an executor's map names no workers, nor need they read this machine's files.
                study = self.lowered(drives[n % len(drives)], name)
                work.append((packed, study, HORIZONS[n % len(HORIZONS)]))
        lessons = [lesson for lesson in self.each(amended, work) if lesson is not None]
        self.learnt += lessons
        self.rounds, self.corrections = number + 1, self.corrections + len(lessons)
        return trained(self.base, self.learnt, self._fineness)

    def _fresh(self, reduced: Mapping[Key, Computed]) -> list[Key]:
        """Runs to certify with: at every drive that which changes most, of those not made yet; no input twice."""
        left = [key for key in self.wanted if key in reduced and key not in self.found]
        left.sort(key=lambda key: -self._size(reduced, key))
        drives = list(dict.fromkeys(key[0] for key in self.studies))
        chosen: list[Key] = []
        for number in range(max(FRESH, len(drives))):
            here = [key for key in left if key not in chosen and key[0] == drives[number % len(drives)]]
            new = [key for key in here if key[1] not in {one[1] for one in chosen}]
            chosen += (new or here)[:1]
        return chosen if len(chosen) >= FRESH else []

    def _size(self, reduced: Mapping[Key, Computed], key: Key) -> float:
        return _difference(reduced[key], self.found[key[0], None])

    def _reduced(self, model: ReducedModel) -> dict[Key, Computed]:
        """All runs that the model can follow, each its drive's full run and what the change does."""
        keys = list(self.studies)
        outcomes = reduced_outcomes(model, [self._beside(*key) for key in keys])
        variants = {keys[number]: one for number, one in outcomes if isinstance(one, Variant)}
        found = {}
        for key, one in variants.items():
            base, full = variants.get((key[0], None)), self.found[key[0], None]
            # Where readings come at other times, or from other places, nothing can be told from the difference.
            if key[1] is None or base is None or not np.array_equal(one.times, base.times):
                continue
            mine, theirs = one.readings, base.readings
            if len(full.readings) == len(mine) and list(full.readings) == list(mine) == list(theirs):
                readings = full.readings + (mine - theirs)
                readings["time_s"] = full.readings["time_s"]
                found[key] = Computed(one.study, readings, full.gradient_at_sensors, full.phases)
        return found


def _difference(one: Computed, other: Computed) -> float:
    """Largest difference of any reading, K."""
    if len(one.readings) != len(other.readings):
        raise NotReducibleError("runs with other times of their readings")
    return float(np.abs((one.readings - other.readings).drop(columns="time_s").to_numpy()).max())
