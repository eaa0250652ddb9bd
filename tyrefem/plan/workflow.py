"""From a study, alone or after a diagnosis, to a plan of the next runs and sensors."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeGuard

from tyrefem.diagnose.diagnosis import DiagnosisData
from tyrefem.diagnose.forward.drive_response import DriveResponse
from tyrefem.diagnose.forward.evaluations import ProgressStore
from tyrefem.diagnose.layout.planned_runs import layout_notes
from tyrefem.diagnose.options import SimulationWork
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Members
from tyrefem.diagnose.workflow import diagnose
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.plan.batch import Search, greedy_batch
from tyrefem.plan.beliefs import Beliefs, diagnosed_beliefs, prior_beliefs, stored_beliefs
from tyrefem.plan.drives import CandidateDrive, candidate_drives
from tyrefem.plan.places import CandidatePlace, with_candidate_sensors
from tyrefem.plan.readings import PlannedReadings, planned_readings
from tyrefem.plan.steps import PlanData, PlanStep
from tyrefem.requirements import Requirements

#: What a study must have for a plan.
NEEDS = Requirements("a plan")


def plan(
    study: StudyData,
    after: Any = None,
    *,
    workers: int = 1,
    progress: Callable[[str, int, int], None] | None = None,
    store: ProgressStore | None = None,
    settings: DiagnosisSettings | None = None,
    known: Sequence[DriveResponse] | None = None,
    **options: Any,
) -> PlanData:
    """The next runs and sensors that are expected to tell the remaining sets of effects apart best, per cost.

    The study's ``[plan]`` table has the limits of its drive, places of further sensors, and costs.

    Parameters
    ----------
    after : None before a test: no effect or any single effect of the catalogue, by their prior probabilities. Else what
        is known: a diagnosis, the folder of one, or tables of readings, which are diagnosed first.
    workers : number of processes. progress : called with (description, number of the step, number of steps).
    store : store of finished simulations. settings : numerical parameters of diagnosis and plan.
    known : responses of the drives of `tyrefem.plan.drives.candidate_drives`, for many plans of one study.
    options : further options of `tyrefem.diagnose.diagnose`, for tables.

    Raises
    ------
    InputError : limits that are none; a drive that cannot run; a folder without a diagnosis; as `diagnose`.
    """
    began = time.perf_counter()
    NEEDS.check(study)
    settings = settings or DiagnosisSettings()
    # Errors of the limits and places come before the work of a diagnosis.
    candidate_drives(study)
    with_candidate_sensors(study, study.sensors)
    beliefs = _beliefs(study, after, workers, progress, store, settings, options)
    # The diagnosed study may be an amended one, or have other limits.
    study = beliefs.study.replace({"plan": study.data.get("plan", {})})
    drives = candidate_drives(study)
    extended, places = with_candidate_sensors(study, beliefs.noise)
    # The folder of a diagnosis's simulations keeps those of one layout only.
    further = None if store is None else replace(store, folder=store.folder.with_name(f"{store.folder.name}-plan"))
    work = SimulationWork(workers, progress, known, store=store if after is None else further)
    readings = planned_readings(beliefs, extended, drives, places, work, settings)
    search = greedy_batch(readings, drives, places, study.card.plan, progress)
    notes = layout_notes(study)[:1] if not beliefs.verdict else ()
    steps = _steps(readings, search, drives, places)
    seconds = time.perf_counter() - began
    left = study.card.plan.runs_most - sum(step.drive is not None for step in steps)
    return PlanData(study.name, readings.beliefs, steps, drives, places, search.compared, notes, seconds, left)


def _beliefs(
    study: StudyData,
    after: Any,
    workers: int,
    progress: Callable[[str, int, int], None] | None,
    store: ProgressStore | None,
    settings: DiagnosisSettings,
    options: dict[str, Any],
) -> Beliefs:
    if options and (after is None or isinstance(after, DiagnosisData) or _is_folder(after)):
        raise InputError("is for a table of readings; none is given", field=next(iter(options)))
    if after is None:
        return prior_beliefs(study)
    if isinstance(after, DiagnosisData):
        return diagnosed_beliefs(after)
    if _is_folder(after):
        return stored_beliefs(study, Path(after))
    work = {"workers": workers, "progress": progress, "store": store, "settings": settings}
    diagnosis = diagnose(study, after, **work | options)
    return diagnosed_beliefs(diagnosis)


def _is_folder(after: Any) -> TypeGuard[str | os.PathLike[str]]:
    """Whether ``after`` is the folder of a diagnosis."""
    return isinstance(after, str | os.PathLike) and Path(after).is_dir()


def _steps(
    readings: PlannedReadings,
    search: Search,
    drives: tuple[CandidateDrive, ...],
    places: tuple[CandidatePlace, ...],
) -> tuple[PlanStep, ...]:
    by_name = {place.name: place for place in places}
    sets = readings.beliefs.sets
    rival = rival_of([entry.members for entry in sets])
    steps: list[PlanStep] = []
    total = before = 0.0
    for number, entry in enumerate(search.chosen, start=1):
        total += entry.cost
        after = entry.information
        steps.append(
            PlanStep(
                number=number,
                drive=None if entry.drive is None else drives[entry.drive],
                place=None if entry.sensor is None else by_name[entry.sensor],
                run=None if entry.drive is None else len(entry.batch.drives),
                cost=entry.cost,
                total_cost=total,
                gain=after.gain - before,
                total_gain=after.gain,
                sd=after.sd,
                right=after.right,
                named=after.named,
                between=(sets[0].key, sets[rival].key),
                pair_probability=after.between(0, rival),
            )
        )
        before = after.gain
    return tuple(steps)


def rival_of(sets: Sequence[Members]) -> int:
    """Number of the most probable set that lacks a member of the leading one; 1 if all contain it.

    A set of the same effects and more names the leading effects too, so it is no rival of their name.
    """
    return next((number for number, members in enumerate(sets) if not set(sets[0]) <= set(members)), 1)
