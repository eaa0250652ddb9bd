"""Runs with one changed input by a reduced model of the unchanged runs, certified by full runs."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from tyrefem.brief import counted
from tyrefem.compare.changed_cycles import Key
from tyrefem.compare.interface import Computed
from tyrefem.compare.packed_drive import Work, nearby_cycles
from tyrefem.compare.runs import Runs
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.cycle_schedule import same_cycles
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.reduced.answers import outcomes_of
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.packed_model import PackedModel, pack, remember
from tyrefem.reduced.residual import EARLY, corrected_tyre
from tyrefem.reduced.training import ReducedFineness, Snapshots, sources_at, trained
from tyrefem.reduced.training_rounds import HORIZONS
from tyrefem.reduced.variant import Variant


@dataclass(frozen=True)
class ReducedInputSettings:
    """Numerical parameters of the reduced model for changed inputs and of its certificate."""

    #: Least tolerance of a reading of a changed run, K. The tolerance is twice the study's time error if that is
    #: larger, because both compared runs have this error.
    least_tolerance: float = 0.02
    #: Largest error of the fresh runs, as a share of the tolerance.
    safety: float = 0.8
    #: Least number of fresh runs of a certificate; number of attempts.
    fresh: int = 3
    trials: int = 2
    #: Least number of correction rounds before the first certificate; it is at least the number of drives.
    rounds: int = 2
    #: Error of the modes, as a share of the tolerance. It is the rms over the snapshots of all inputs: the pattern of
    #: a single input at one drive, a hundredth of them, may be off by ten times as much.
    modes_share: float = 0.0625
    #: Largest numbers of modes of temperature and of heat source; many inputs, each with an early and a late change,
    #: and a strain cycle of their own at every drive, need many modes.
    most_modes: int = 300
    most_sources: int = 500
    #: Least number of changed runs for which a reduced model is made.
    least_runs: int = 12
    #: The first field at which a phase is corrected lies within this time from its start, s.
    early: float = EARLY


#: Default settings.
DEFAULT = ReducedInputSettings()


def reducible(studies: Mapping[Key, StudyData], *, nearby: bool = True) -> dict[Key, StudyData]:
    """The runs for which a reduced model saves time; ``nearby``: also those with changed cycles by finite elements.

    With strain cycles by finite elements these are the runs with the strain cycle of their drive, and those whose
    cycles start from it: these need one solution each, training data none. Other changed cycles need a new solution in
    any case, and further ones as training data.
    """
    return {
        (drive, name): study
        for (drive, name), study in studies.items()
        if name is None
        or not strain_law(study).by_elements
        or same_cycles(study, studies[drive, None])
        or (nearby and nearby_cycles(study, studies[drive, None]))
    }


def enough_changed_runs(studies: Mapping[Key, StudyData], settings: ReducedInputSettings = DEFAULT) -> bool:
    """Whether there are enough changed runs for a reduced model."""
    return sum(name is not None for _, name in studies) >= settings.least_runs


@dataclass(frozen=True, eq=False)
class ReducedInputCertificate:
    """Certificate of the reduced model: its difference from full runs that are not in its training data.

    Parameters
    ----------
    worst : largest difference of any reading from ``cases`` full runs, K. tolerance : largest allowed difference, K.
    reduced, full : numbers of changed runs by either model. corrections : corrections in the training data.
    """

    worst: float
    tolerance: float
    cases: int
    reduced: int
    full: int
    corrections: int

    @property
    def values(self) -> list[float]:
        """The fields as numbers, in their order."""
        return [float(getattr(self, name.name)) for name in fields(self)]

    @classmethod
    def of(cls, values: Any) -> ReducedInputCertificate:
        """The certificate from the numbers of `values`."""
        worst, tolerance, *counts = (float(value) for value in values)
        return cls(worst, tolerance, *(round(count) for count in counts))

    @property
    def sentence(self) -> str:
        """The certificate as a note of a comparison."""
        return (
            f"Note: a reduced model computed {self.reduced} of {self.reduced + self.full} runs with a changed input; "
            f"{counted(self.cases, 'full run')} differ{'s' if self.cases == 1 else ''} from it by "
            f"{self.worst:.2g} K at most"
        )


def corrected_run(task: tuple[PackedModel, Work, float, float]) -> Snapshots | None:
    """In a worker: the full model's correction of the reduced run of a study, over a horizon.

    None: the study is not reducible. It is then run in full, and errors of the study appear there.
    """
    packed, work, share, early = task
    first = work.drive.first or work.drive
    try:
        remember(first.packed, first.tyre)
        return corrected_tyre(packed.unpacked(), work.tyre, share, early)[0]
    except InputError:
        return None


@dataclass(eq=False)
class ReducedInputRuns:
    """Runs with one changed input, most of them by a reduced model.

    A changed run is the full run of its drive plus the difference of two reduced runs, with and without the change.
    Errors that both reduced runs share cancel. ``runs``: after `Runs.begin`. ``nearby``: see `reducible`.
    """

    runs: Runs
    settings: ReducedInputSettings = DEFAULT
    nearby: bool = True
    rounds: int = 0
    corrections: int = 0

    def __post_init__(self) -> None:
        runs = self.runs
        drive = runs.drives[0]
        study = runs.studies[drive, None]
        if study.card.mechanics.feedback is not None:
            raise NotReducibleError("strain cycles that follow the temperature")
        #: The runs for which the model is made.
        self.studies = reducible(runs.studies, nearby=self.nearby)
        self.changed = [key for key in self.studies if key[1] is not None]
        if not enough_changed_runs(self.studies, self.settings):
            raise NotReducibleError(f"fewer than {self.settings.least_runs} runs with a changed input")
        self.tolerance = max(self.settings.least_tolerance, 2 * study.tolerance)
        first = runs.work((drive, None)).drive
        self.packed, self.base = first.packed, first.tyre
        remember(self.packed, self.base)

    @property
    def computed(self) -> dict[Key, Computed]:
        """All runs so far."""
        return self.runs.computed

    def solve(self) -> ReducedInputCertificate:
        """Compute every run.

        Raises
        ------
        NotReducibleError : there is no reduced model, or fresh full runs do not confirm it. The full runs so far are
            kept.
        """
        runs = self.runs
        for drive in runs.drives:
            if runs.work((drive, None)).tyre.mesh is not self.base.mesh:
                raise NotReducibleError(f"another mesh{f' at the drive {drive}' if drive else ''}")
        if len({sample.fields.shape[1] for sample in runs.training} | {self.base.problem.operators.size}) > 1:
            raise NotReducibleError("another mesh")
        runs.solve_cycles(self.changed)
        model, worst = trained(self.base, [*runs.training, self._wanted_sources], self._fineness), np.inf
        for trial in range(self.settings.trials):
            for _ in range(1 if trial else max(self.settings.rounds, len(runs.drives))):
                model = self._round(model)
            reduced = self._reduced(model)
            fresh = self._fresh(reduced)
            if not fresh:
                break
            runs.run_for_training(fresh)
            errors = [_difference(reduced[key], self.computed[key]) for key in fresh if key in reduced]
            worst = max(errors, default=np.inf)
            if worst <= self.settings.safety * self.tolerance:
                return self._filled(reduced, worst, len(errors))
        raise NotReducibleError(
            f"full runs are off by {worst:.2g} K; allowed: {self.settings.safety:g} x {self.tolerance:g} K"
            if np.isfinite(worst)
            else "there is no run for a certificate"
        )

    @functools.cached_property
    def _wanted_sources(self) -> Snapshots:
        """Heat sources of the wanted runs at a cold and a warm field, without a solution.

        An input that is lowered teaches no more than two of three patterns: a region's heat, its change with the strain
        cycle, and the other regions' heat.
        """
        first, operators = self.runs.training[0], self.base.problem.operators
        cold, warm = first.fields[0], first.fields[-1]
        sources = [first.sources[:0]]
        for key in self.changed:
            with suppress(InputError):  # it appears in the run itself
                tyre = self.runs.work(key).tyre
                ends = [end * (1 - 1e-9) for end in (*tyre.drive.starts[1:], tyre.drive.end)]
                sources += [sources_at(operators, tyre, end, field)[None] for end in ends for field in (cold, warm)]
        return Snapshots(first.fields[:0], np.vstack(sources))

    @property
    def _fineness(self) -> ReducedFineness:
        settings = self.settings
        fineness = ReducedFineness.of(settings.modes_share * self.tolerance)
        return replace(fineness, most_modes=settings.most_modes, most_sources=settings.most_sources)

    def _filled(self, reduced: Mapping[Key, Computed], worst: float, cases: int) -> ReducedInputCertificate:
        """Take the reduced runs; run the other ones in full."""
        taken = {key: reduced[key] for key in self.changed if key not in self.computed and key in reduced}
        self.runs.take(taken)
        self.runs.fill()
        in_full = len(self.runs.changed) - len(taken)
        return ReducedInputCertificate(worst, self.tolerance, cases, len(taken), in_full, self.corrections)

    def _round(self, model: ReducedModel) -> ReducedModel:
        """A round of corrections: every input is lowered once, and the drives take turns.

        The wanted runs have raised inputs, so they are not in the training data.
        """
        runs, drives = self.runs, self.runs.drives
        inputs = dict.fromkeys(name for _, name in self.changed)
        packed, number, early = pack(model, self.packed), self.rounds, self.settings.early
        # Each task carries the model, because workers may run on machines without access to files of this process.
        work = [
            (packed, runs.work((drives[n % len(drives)], name), lowered=True), HORIZONS[n % len(HORIZONS)], early)
            for n, name in enumerate(inputs, number)
        ]
        samples = [sample for sample in runs.each(corrected_run, work) if sample is not None]
        runs.training += samples
        self.rounds, self.corrections = number + 1, self.corrections + len(samples)
        return trained(self.base, [*runs.training, self._wanted_sources], self._fineness)

    def _fresh(self, reduced: Mapping[Key, Computed]) -> list[Key]:
        """Runs for the certificate: at every drive the run with the largest change; no input twice if possible."""
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
        """All reducible runs, each the full run of its drive plus the reduced model's change."""
        keys = list(self.studies)
        outcomes = outcomes_of(model, [self.runs.work(key).tyre for key in keys])
        variants = {keys[number]: variant for number, variant in outcomes if isinstance(variant, Variant)}
        computed = {}
        for key, variant in variants.items():
            base, full = variants.get((key[0], None)), self.computed[key[0], None]
            # Readings at other times or of other sensors cannot be subtracted.
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
        raise NotReducibleError("the runs have readings at different times")
    return float(np.abs((computed.readings - other.readings).drop(columns="time_s").to_numpy()).max())
