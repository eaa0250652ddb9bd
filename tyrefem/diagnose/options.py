"""Options of a diagnosis in groups: replaceable parts, names of columns, and execution of the simulations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypedDict

from tyrefem.diagnose.data.sensitivities import Tick
from tyrefem.diagnose.fitting.criterion import Criterion, LogEvidence
from tyrefem.diagnose.fitting.exhaustive import Exhaustive
from tyrefem.diagnose.fitting.forward_selection import ForwardSelection
from tyrefem.diagnose.fitting.selection import Strategy
from tyrefem.diagnose.forward.drive_response import DriveResponse
from tyrefem.diagnose.forward.evaluations import ProgressStore, WorkerModels
from tyrefem.diagnose.forward.strain_law_study import mesh_of_law
from tyrefem.diagnose.forward.worker_queues import WorkerQueues, Workers
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import CandidateSpace, catalogue_candidates
from tyrefem.effects import use_effects
from tyrefem.errors import InputError
from tyrefem.measured.names import ColumnNames
from tyrefem.output import as_path

#: Name on the command line -> strategy.
STRATEGIES: Mapping[str, Strategy] = {"forward": ForwardSelection(), "exhaustive": Exhaustive()}
#: Replaceable part -> what it is, and the methods that it must have.
_PARTS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "candidates": ("a function of a study", ("__call__",)),
    "criterion": ("a Criterion, with of_fit and of_linear", ("of_fit", "of_linear")),
    "strategy": ("a Strategy, with check and search", ("check", "search")),
}


@dataclass(frozen=True)
class Method:
    """The replaceable parts of a diagnosis.

    Parameters
    ----------
    candidates : study -> the effects that it may lack. criterion : quality of a set's explanation of the data.
    strategy : search over sets of effects. settings : numerical parameters of the diagnosis.
    calibration : file of a calibration of the layout, or its folder; None: no conformal set.
    """

    candidates: CandidateSpace = catalogue_candidates
    criterion: Criterion = field(default_factory=LogEvidence)
    strategy: Strategy = field(default_factory=ForwardSelection)
    settings: DiagnosisSettings = DEFAULT
    calibration: Path | None = None

    def by_law(self, law: str) -> Method:
        """The same for a study by another strain law, see `mesh_of_law`."""
        return replace(self, settings=replace(self.settings, mesh_size=mesh_of_law(law, self.settings.mesh_size)))


@dataclass(frozen=True)
class SimulationWork:
    """Execution of the simulations of a diagnosis, see `DiagnosisOptions`; ``pool``: processes of all its looks."""

    workers: Workers = 1
    progress: Tick | None = None
    known: Sequence[DriveResponse] | None = None
    rerun: bool = True
    store: ProgressStore | None = None
    verdict_only: bool = False
    pool: WorkerModels | None = None

    def __post_init__(self) -> None:
        count = self.workers
        if not isinstance(count, WorkerQueues) and (isinstance(count, bool) or not isinstance(count, int) or count < 1):
            raise InputError(f"must be a whole number of at least 1, not {count!r:.60}", field="workers")

    def look(self, number: int) -> SimulationWork:
        """The options for the look with this number; 0 is the first look."""
        if not number:
            return self
        store = None if self.store is None else self.store.look(number)
        return replace(self, progress=_suffixed(self.progress, f"look {number + 1}"), known=None, store=store)

    def by_law(self, law: str) -> SimulationWork:
        """The options for the diagnosis with another strain law."""
        store = None if self.store is None else self.store.by_law(law)
        return replace(self, progress=_suffixed(self.progress, f"strain law {law}"), known=None, store=store)

    def tick(self, what: str, done: int = 0, total: int = 0) -> None:
        """Report progress."""
        if self.progress is not None:
            self.progress(what, done, total)


def _suffixed(progress: Tick | None, suffix: str) -> Tick | None:
    if progress is None:
        return None
    return lambda what, done, total: progress(f"{what}, {suffix}", done, total)


class DiagnosisOptions(TypedDict, total=False):
    """Keywords of `diagnose`."""

    ignore: Iterable[str]
    rename: Mapping[str, str] | None
    largest: int
    looks: int
    reduced: str
    settings: DiagnosisSettings
    candidates: CandidateSpace
    criterion: Criterion
    strategy: Strategy
    workers: Workers
    progress: Tick | None
    known: Sequence[DriveResponse] | None
    rerun: bool
    verdict_only: bool
    store: ProgressStore | None
    effects: str | Path | None
    calibration: str | Path | None


def grouped(options: Mapping[str, Any]) -> tuple[ColumnNames, Method, SimulationWork]:
    """The keywords of `diagnose` in groups."""
    given = dict(options)
    if (folder := given.pop("effects", None)) is not None:
        use_effects(folder)
    columns = ColumnNames.of(ignore=given.pop("ignore", ()), rename=given.pop("rename", None))
    settings = given.pop("settings", DiagnosisSettings())
    if not isinstance(settings, DiagnosisSettings):
        raise InputError(f"must be DiagnosisSettings, not {settings!r:.60}", field="settings")
    settings = replace(settings, **{name: given.pop(name) for name in ("largest", "looks", "reduced") if name in given})
    parts = {name: given.pop(name) for name in ("candidates", "criterion", "strategy") if name in given}
    for name, part in parts.items():
        wanted, methods = _PARTS[name]
        if not all(callable(getattr(part, method, None)) for method in methods):
            raise InputError(f"must be {wanted}, not {part!r:.60}", field=name)
    calibration = given.pop("calibration", None)
    table = None if calibration is None else as_path(calibration, "calibration")
    method = Method(**parts, settings=settings, calibration=table)
    return columns, method, SimulationWork(**given)
