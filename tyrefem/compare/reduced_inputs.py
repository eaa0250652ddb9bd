"""Runs with one uncertain input changed, by a reduced model of the drives' own runs, tried on full ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from tyrefem.compare.interface import Computed
from tyrefem.compare.runs import Key, Runs, Work
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.cycle_schedule import same_cycles
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.reduced.answers import outcomes_of
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.residual import EARLY, corrected_tyre
from tyrefem.reduced.training import ReducedFineness, Snapshots, trained
from tyrefem.reduced.training_rounds import HORIZONS, PackedModel, pack, remember
from tyrefem.reduced.variant import Variant


@dataclass(frozen=True)
class ReducedInputSettings:
    """How a reduced model is made for changed inputs, and when it is believed."""

    #: A reading of a changed run may be off by this much, K, or by twice the time error that the study allows full
    #: runs, as either of the two that are compared may be off by that.
    finest: float = 0.02
    #: Share of that which the fresh runs may take up.
    safety: float = 0.8
    #: Fresh runs that a certificate needs at least; how often one is tried.
    fresh: int = 3
    trials: int = 2
    #: Rounds of corrections before the first certificate, or as many as drives.
    rounds: int = 2
    #: The modes' share of the tolerance.
    finer: float = 0.25
    #: Modes at most: many numbers, each with an early and a late change of its own, need more than a few in a box.
    most_modes: int = 200
    #: With fewer changed runs a model is not worth its making.
    worth: int = 12
    #: The first field that a phase is corrected at is one of its first s.
    early: float = EARLY


#: As shipped.
DEFAULT = ReducedInputSettings()


def followed(studies: Mapping[Key, StudyData]) -> dict[Key, StudyData]:
    """The runs that a reduced model is worth making for: of strain cycles that take longer than a run, those that have
    their drive's.

    What changes the strain cycle needs a solution of its own either way, and more of them to learn from.
    """
    return {
        (drive, name): study
        for (drive, name), study in studies.items()
        if not strain_law(study).by_elements or name is None or same_cycles(study, studies[drive, None])
    }


def worth(studies: Mapping[Key, StudyData], settings: ReducedInputSettings = DEFAULT) -> bool:
    """Are there changed runs enough?"""
    return sum(name is not None for _, name in studies) >= settings.worth


@dataclass(frozen=True, eq=False)
class ReducedInputCertificate:
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
    def values(self) -> list[float]:
        """All of it as numbers."""
        return [float(getattr(self, name.name)) for name in fields(self)]

    @classmethod
    def of(cls, values: Any) -> ReducedInputCertificate:
        """The certificate of such numbers."""
        worst, tolerance, *counts = (float(value) for value in values)
        return cls(worst, tolerance, *(round(count) for count in counts))

    @property
    def sentence(self) -> str:
        """For the notes of a comparison."""
        return (
            f"Note: {self.reduced} of {self.reduced + self.full} runs with a changed input are a reduced model's; "
            f"{self.cases} full ones differ from it by {self.worst:.2g} K at most"
        )


def amended(task: tuple[PackedModel, Work, float, float]) -> Snapshots | None:
    """Done in a worker: what the full model makes of the reduced run of a study, over a horizon.

    None: no reduced model can follow it. It will be run in full, which says what is wrong, if anything is.
    """
    packed, work, share, early = task
    first = work.drive.first or work.drive
    try:
        remember(first.packed, first.tyre)
        return corrected_tyre(packed.unpacked(), work.tyre, share, early)[0]
    except InputError:
        return None


@dataclass(eq=False)
class Neighbours:
    """Runs of some drives, and of each with one input changed, most of them by a reduced model.

    A changed run is its drive's full run plus what the reduced model says that the change does: what the model gets
    wrong in both drops out. ``runs``: begun.
    """

    runs: Runs
    settings: ReducedInputSettings = DEFAULT
    rounds: int = 0
    corrections: int = 0

    def __post_init__(self) -> None:
        runs = self.runs
        drive = runs.drives[0]
        study = runs.studies[drive, None]
        if study.card.mechanics.feedback is not None:
            raise NotReducibleError("strain cycles that follow the temperature")
        #: Those that the model is made for.
        self.studies = followed(runs.studies)
        self.changed = [key for key in self.studies if key[1] is not None]
        if not worth(self.studies, self.settings):
            raise NotReducibleError(f"fewer than {self.settings.worth} runs with a changed input")
        self.tolerance = max(self.settings.finest, 2 * study.tolerance)
        first = runs.work((drive, None)).drive
        self.packed, self.base = first.packed, first.tyre
        remember(self.packed, self.base)

    @property
    def computed(self) -> dict[Key, Computed]:
        """All runs made so far."""
        return self.runs.computed

    def solve(self) -> ReducedInputCertificate:
        """Find every run.

        Raises
        ------
        NotReducibleError : no model, or one that fresh runs do not bear out; the full runs made so far are found.
        """
        runs = self.runs
        for drive in runs.drives:
            if runs.work((drive, None)).tyre.mesh is not self.base.mesh:
                raise NotReducibleError(f"another mesh{f' at the drive {drive}' if drive else ''}")
        if len({training.fields.shape[1] for training in runs.learnt} | {self.base.problem.operators.size}) > 1:
            raise NotReducibleError("another mesh")
        model, worst = trained(self.base, runs.learnt, self._fineness), np.inf
        for trial in range(self.settings.trials):
            for _ in range(1 if trial else max(self.settings.rounds, len(runs.drives))):
                model = self._round(model)
            reduced = self._reduced(model)
            fresh = self._fresh(reduced)
            if not fresh:
                break
            runs.teach(fresh)
            errors = [_difference(reduced[key], self.computed[key]) for key in fresh if key in reduced]
            worst = max(errors, default=np.inf)
            if worst <= self.settings.safety * self.tolerance:
                return self._filled(reduced, worst, len(errors))
        raise NotReducibleError(
            f"full runs are off by {worst:.2g} K; allowed: {self.settings.safety:g} x {self.tolerance:g} K"
            if np.isfinite(worst)
            else "no run to certify with"
        )

    @property
    def _fineness(self) -> ReducedFineness:
        most = self.settings.most_modes
        return replace(ReducedFineness.of(self.settings.finer * self.tolerance), most_modes=most, most_sources=most)

    def _filled(self, reduced: Mapping[Key, Computed], worst: float, cases: int) -> ReducedInputCertificate:
        """Take the reduced runs; what no reduced model can follow is run in full."""
        taken = {key: reduced[key] for key in self.changed if key not in self.computed and key in reduced}
        self.runs.take(taken)
        self.runs.fill()
        in_full = len(self.runs.changed) - len(taken)
        return ReducedInputCertificate(worst, self.tolerance, cases, len(taken), in_full, self.corrections)

    def _round(self, model: ReducedModel) -> ReducedModel:
        """Corrections: every input lowered once, at one drive after the other; what is wanted raised stays untaught."""
        runs, drives = self.runs, self.runs.drives
        inputs = dict.fromkeys(name for _, name in self.changed)
        packed, number, early = pack(model, self.packed), self.rounds, self.settings.early
        # The model goes with each: an executor's map names no workers, nor need they read this machine's files.
        work = [
            (packed, runs.work((drives[n % len(drives)], name), lowered=True), HORIZONS[n % len(HORIZONS)], early)
            for n, name in enumerate(inputs, number)
        ]
        lessons = [lesson for lesson in runs.each(amended, work) if lesson is not None]
        runs.learnt += lessons
        self.rounds, self.corrections = number + 1, self.corrections + len(lessons)
        return trained(self.base, runs.learnt, self._fineness)

    def _fresh(self, reduced: Mapping[Key, Computed]) -> list[Key]:
        """Runs to certify with: at every drive that which changes most, of those not made yet; no input twice."""
        left = [key for key in self.changed if key in reduced and key not in self.computed]
        left.sort(key=lambda key: -self._size(reduced, key))
        drives = self.runs.drives
        chosen: list[Key] = []
        for number in range(max(self.settings.fresh, len(drives))):
            here = [key for key in left if key not in chosen and key[0] == drives[number % len(drives)]]
            new = [key for key in here if key[1] not in {name for _, name in chosen}]
            chosen += (new or here)[:1]
        return chosen if len(chosen) >= self.settings.fresh else []

    def _size(self, reduced: Mapping[Key, Computed], key: Key) -> float:
        return _difference(reduced[key], self.computed[key[0], None])

    def _reduced(self, model: ReducedModel) -> dict[Key, Computed]:
        """All runs that the model can follow, each its drive's full run and what the change does."""
        keys = list(self.studies)
        outcomes = outcomes_of(model, [self.runs.work(key).tyre for key in keys])
        variants = {keys[number]: variant for number, variant in outcomes if isinstance(variant, Variant)}
        computed = {}
        for key, variant in variants.items():
            base, full = variants.get((key[0], None)), self.computed[key[0], None]
            # Where readings come at other times, or from other places, nothing can be told from the difference.
            if key[1] is None or base is None or not np.array_equal(variant.times, base.times):
                continue
            mine, theirs = variant.readings, base.readings
            if len(full.readings) == len(mine) and list(full.readings) == list(mine) == list(theirs):
                readings = full.readings + (mine - theirs)
                readings["time_s"] = full.readings["time_s"]
                computed[key] = Computed(variant.study, readings, full.gradient_at_sensors, full.phases)
        return computed


def _difference(computed: Computed, other: Computed) -> float:
    """Largest difference of any reading, K."""
    if len(computed.readings) != len(other.readings):
        raise NotReducibleError("runs with other times of their readings")
    return float(np.abs((computed.readings - other.readings).drop(columns="time_s").to_numpy()).max())
