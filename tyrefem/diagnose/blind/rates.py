"""Many blind cases in parallel, kept on disk, and the rates at which the diagnosis is right."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any, TypedDict, Unpack

import tyrefem
from tyrefem.diagnose.blind.blind_case import (
    DATA_MODELS,
    ORDINARY,
    STRUCTURAL,
    BlindOutcome,
    cases,
    mesh_of,
    other_model,
    run_case,
)
from tyrefem.diagnose.blind.criteria import (
    Rate,
    Row,
    acting,
    by_effect,
    failures,
    lines,
    names,
    ordinary_rates,
    rate,
    structural_rates,
)
from tyrefem.diagnose.blind.kept_cases import CASES, computed_cases, keep_cases, kept_cases, resuming, tag_for
from tyrefem.diagnose.data.sensitivities import responses, unknowns_of
from tyrefem.diagnose.forward.drive_response import DriveResponse
from tyrefem.diagnose.forward.effort import CASE, SENSITIVITIES, STRUCTURAL_CASE, check_effort
from tyrefem.diagnose.forward.evaluations import ProgressStore, evaluating
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.layout.planned_runs import candidates_of, layout_notes, planned
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.output import jsonable
from tyrefem.requirements import Requirements
from tyrefem.simulation.surroundings import GAS
from tyrefem.variants.answer_store import PROGRESS, study_digest

#: What a study must have for a blind test.
NEEDS = Requirements("a blind test", fitted=True)
BINS = (0.5, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0)


@dataclass(frozen=True, eq=False)
class Blind:
    """Finished cases of a blind test and their rates.

    ``notes``: sentences on sensors and runs that the study lacks. ``mesh``: mesh of the synthetic data; ``data_model``:
    their model, of `tyrefem.diagnose.blind.blind_case.DATA_MODELS`. ``plugins``: own effects and laws that took part.
    """

    study: str
    seed: int
    rows: tuple[Row, ...]
    notes: tuple[str, ...] = ()
    mesh: Mapping[str, Any] = field(default_factory=dict)
    data_model: str = ORDINARY
    plugins: tuple[dict[str, str], ...] = ()

    @cached_property
    def rates(self) -> dict[str, Rate]:
        """Criterion -> rate of the cases that fulfil it."""
        return structural_rates(self.rows) if self.data_model == STRUCTURAL else ordinary_rates(self.rows)

    @property
    def failures(self) -> list[Row]:
        """Every case that misses a goal, with its causes."""
        return failures(self.rows)

    @cached_property
    def reliability(self) -> list[Row]:
        """Stated probability and observed share of right names, for verdicts "identified", by bins of probability."""
        rates = []
        for low, high in pairwise(BINS):
            identified = [
                row
                for row in self.rows
                if row["verdict"] == "identified" and low < min(row["probability"], 1.0) <= high
            ]
            if identified:
                mean = sum(row["probability"] for row in identified) / len(identified)
                held = rate(identified, lambda row: bool(row["hidden"]) and names(row) <= acting(row))
                rates.append({"stated": mean, **held.to_dict()})
        return rates

    @cached_property
    def by_effect(self) -> list[Row]:
        """One row per effect (all variants): cases, identifiable, named, and the results of the missed cases."""
        return by_effect(self.rows)

    def to_dict(self) -> Row:
        """Contents of ``blind.json``."""
        return {
            "study": self.study,
            "seed": self.seed,
            "truth": self.data_model,
            "mesh_of_the_truth": dict(self.mesh) or mesh_of(self.data_model),
            "cases": list(self.rows),
            "rates": {name: rate.to_dict() for name, rate in self.rates.items()},
            "reliability": self.reliability,
            "by_effect": self.by_effect,
            "failures": self.failures,
            "notes": list(self.notes),
            "plugins": list(self.plugins),
        }

    def words(self) -> list[str]:
        """The rates as lines of text, then the notes."""
        return [*lines(self.rates), *self.notes]


def checked_model(name: str, field: str = "truth") -> str:
    """The name of the data's model; ``field``: where it stands.

    Raises
    ------
    InputError : it is none of `DATA_MODELS`; with the nearest.
    """
    if name not in DATA_MODELS:
        raise InputError(f"'{name}' is no model of synthetic data{nearest(name, DATA_MODELS)}", field=field)
    return name


#: Keywords of `run_blind`.
BlindOptions = TypedDict(  # noqa: UP013
    "BlindOptions",
    {
        "reduced": str,
        "mesh": Mapping[str, Any] | None,
        "truth": str,
        "finished": Mapping[int, Row],
        "only": Collection[int],
    },
    total=False,
)


#: The row of a case whose diagnosis fails.
FAILED: Row = {
    "verdict": "failed", "named": [], "set": [], "best": "", "probability": 0.0, "missing_station_m": math.nan,
    "rms_K": {}, "held_out_rms_K": {"before": 0.0, "after": math.inf}, "noise_K": 0.0,
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class BlindTest:
    """The inputs of all cases: study, number of cases, seed, responses, ``reduced``, the data's mesh and model."""

    study: StudyData
    count: int
    seed: int
    known: tuple[DriveResponse, ...]
    reduced: str
    mesh: Mapping[str, Any]
    data_model: str = ORDINARY


def _case(test: BlindTest, number: int) -> Row:
    study = test.study
    case = cases(study, test.count, test.seed)[number]
    try:
        row = run_case(study, case, test.known, test.reduced, test.mesh, test.data_model).to_dict()
    except InputError as error:
        # A diagnosis that fails counts as wrong.
        parts = other_model(study, case).to_dict(test.mesh) if test.data_model == STRUCTURAL else None
        outcome = BlindOutcome(case, identifiable=True, other_model=parts)
        row = {**outcome.to_dict(), **FAILED, "reason": str(error)}
    plain: Row = jsonable({**row, "station_m": case.station, "length_m": study.section.line.length})
    return plain


def run_blind(
    study: StudyData,
    count: int,
    seed: int,
    folder: Path,
    workers: int = 1,
    tick: Callable[[int], None] | None = None,
    **options: Unpack[BlindOptions],
) -> Blind:
    """Run blind cases in parallel; finished cases are kept in ``folder``/cases.

    Cases in the folder with the same study, count, seed, options and version are not run again.

    Parameters
    ----------
    reduced : see `tyrefem.diagnose.diagnose`; all cases share the modes of the reduced models.
    mesh : mesh of the synthetic data, as changes of a study by dotted names; default: `mesh_of`.
    truth : model of the data. "ordinary" (default): the study's, with hidden causes, another mesh and time
        integration. "structural": also another strain energy, other gauges and speed laws of films (`OtherModel`).
    finished : rows of cases by number, of an earlier test with the same study, count and seed: not run again.
    only : numbers of the cases to run; default: all. Finished ones count all the same.

    Raises
    ------
    InputError : as `isolability`; ``truth`` is none of these; or ``only`` has a number that no case has.
    TypeError : a keyword that is none of these.
    """
    unknown = sorted(set(options) - set(BlindOptions.__annotations__))
    if unknown:
        raise TypeError(f"run_blind takes no keyword {unknown[0]!r}{nearest(unknown[0], BlindOptions.__annotations__)}")
    data_model, reduced, mesh = _chosen(options)
    NEEDS.check(study)
    candidates = candidates_of(study)
    drives = planned(study)
    tag = tag_of(study, count, seed, **options)
    store = folder / CASES
    rows: dict[int, Row] = dict(options.get("finished", {})) | kept_cases(store, tag)
    wanted = options.get("only", range(count))
    if beyond := [number for number in wanted if not 0 <= number < count]:
        raise InputError(f"there is no case {beyond[0]}; the cases are 0 to {count - 1}", field="only")
    left = [number for number in range(count) if number in wanted and number not in rows]
    # The shared responses are kept until all cases are finished.
    progress = ProgressStore(folder / PROGRESS)
    with resuming(rows, count):
        if left:
            model = ForwardModel(study, drives)
            of_case = STRUCTURAL_CASE if data_model == STRUCTURAL else CASE
            check_effort(model, f"{len(left):,} blind cases", SENSITIVITIES + len(left) * of_case, workers)
            progress.open(model)
            with evaluating(model, workers, progress) as evaluations:
                unknowns, _ = unknowns_of(study, [*study.sensors, GAS], candidates)
                known = responses(evaluations, unknowns)
            test = BlindTest(study, count, seed, known, reduced, mesh, data_model)
            keep_cases(rows, computed_cases(_case, test, left, workers), store, tag, tick)
        notes = layout_notes(study)
        if not any(drive.hold_out for drive in drives):
            notes += ("No run is held out, so the rates do not cover runs that were not fitted.",)
    progress.clear()
    used = plugin_summary(study, [candidate.name for candidate in candidates])["plugins"]
    rows_in_order = tuple(rows[number] for number in sorted(rows))
    return Blind(study.name, seed, rows_in_order, notes, mesh, data_model, tuple(used))


def tag_of(study: StudyData, count: int, seed: int, **options: Unpack[BlindOptions]) -> str:
    """Begin of the names of a test's files in ``folder``/cases: tests that differ share a folder, but no file."""
    data_model, reduced, mesh = _chosen(options)
    decisive = [study_digest(study), count, seed, reduced, dict(mesh), tyrefem.__version__]
    decisive += [] if data_model == ORDINARY else [data_model]
    return tag_for(decisive)


def _chosen(options: BlindOptions) -> tuple[str, str, Mapping[str, Any]]:
    """Model of the data, use of reduced models, and mesh of the data, of options of which some are not given."""
    data_model, stated = checked_model(options.get("truth", ORDINARY)), options.get("mesh")
    return data_model, options.get("reduced", "auto"), mesh_of(data_model) if stated is None else stated
