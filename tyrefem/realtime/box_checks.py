"""Whether a box of numbers can be explored: its numbers, limits, tolerance and cost, before any training."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tyrefem.boundaries.rim import LumpedRim
from tyrefem.errors import InputError
from tyrefem.estimates.work import warn_if_long
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.realtime.suitability import check_suitable
from tyrefem.reduced.surrogate import check_varied
from tyrefem.requirements import Requirements
from tyrefem.simulation.estimate import RunEstimate
from tyrefem.variants.answers import highest_name
from tyrefem.variants.card import flat
from tyrefem.variants.plan import Plan
from tyrefem.variants.schedulers import Here, Local, Scheduler

#: Cost: equivalent full runs of training, certificate and search, and strain cycles by finite elements.
RUNS, CYCLES = 16.0, 20.0
#: K: footprints by finite elements differ by up to 2 % with their number of harmonics, which depends on the load.
PRESSED_TOLERANCE = 1.0
#: Requirements of an exploration on a study.
NEEDS = Requirements("an exploration")
#: What a slider can move.
POSSIBLE = (
    "Sliders move speed, load, pressure, ambient, road_temperature and initial of the drive or of a phase; "
    "loss_tangent, conductivity, specific_heat and density of materials.REGION; numbers of the laws in boundaries"
)


def refuse_levels(ranges: Mapping[str, Any]) -> None:
    """Raise `InputError` for levels of a range: a slider has all its values."""
    for key, entry in flat(dict(ranges)).items():
        if (isinstance(entry, tuple) and len(entry) == 3) or (isinstance(entry, Mapping) and "levels" in entry):
            raise InputError("a slider has no levels: give FROM:TO alone", field=f"vary.{key}")


def default_tolerance(study: StudyData) -> float:
    """Allowed error of the temperatures, K: that of the study's ``[explore]``; else 0.3, or `PRESSED_TOLERANCE`.

    >>> import tyrefem
    >>> [default_tolerance(tyrefem.study(name)) for name in ("nasa-22x5.5-8pr", "passenger-205-55r16")]
    [0.3, 1.0]
    """
    choice = study.card.explore
    chosen = "tolerance" in choice.model_fields_set
    return PRESSED_TOLERANCE if strain_law(study).by_elements and not chosen else choice.tolerance


def check_explored(plan: Plan, tolerance: float) -> None:
    """Raise `InputError` if a plan's box cannot be explored."""
    NEEDS.check(plan.study)
    check_suitable(plan.study)
    for number in plan.varied:
        table, last = number.key.split(".")[0], number.key.rpartition(".")[2]
        field = f"vary.{number.key}"
        if number.values:
            raise InputError(
                f"a list has no slider: give a range or a factor, or make a page of each. {POSSIBLE}", field=field
            )
        if last == "duration":
            raise InputError(f"a duration has no slider: all settings share their times. {POSSIBLE}", field=field)
        if table in ("section", "mesh", "output", "numerics", "mechanics"):
            raise InputError(f"has no slider: it needs another mesh or other strain cycles. {POSSIBLE}", field=field)
    check_varied(plan)
    known = limited_answers(plan.study)
    for name in plan.limits:
        if name not in known:
            words = f"'{name}' is an answer of a sweep only, a page does not compute it; allowed: {', '.join(known)}"
            raise InputError(words, field="limits")
    if tolerance < plan.study.tolerance:
        raise InputError(
            f"{tolerance:g} K is less than the time error of the full runs; must be at least numerics.tolerance, "
            f"{plan.study.tolerance:g} K",
            field="tolerance",
        )


def limited_answers(study: StudyData) -> list[str]:
    """Names of the answers that a limit may have: those of `setting_solution`.

    >>> import tyrefem
    >>> limited_answers(tyrefem.study("nasa-22x5.5-8pr"))[:3]
    ['hottest_degC', 'carcass_max_degC', 'bead_max_degC']
    """
    regions = study.section.regions
    return [
        "hottest_degC",
        *(f"{region}_max_degC" for region in regions),
        *(name for sensor in study.sensors for name in (f"{sensor}_degC", highest_name(sensor, regions))),
        *(["rim_degC"] if isinstance(study.card.boundaries.rim, LumpedRim) else []),
        *("contained-air_degC", "gas_pressure_Pa", "rolling_resistance_N", "rolling_resistance_coefficient"),
    ]


def check_cost(study: StudyData, scheduler: Scheduler) -> None:
    """Raise `InputError` if the parallel runs do not fit in memory; warn of long work."""
    run, workers = RunEstimate.of(study), getattr(scheduler, "workers", 1)
    if isinstance(scheduler, Here | Local):
        run.check(workers)

    def seconds(run: RunEstimate) -> float:
        return (RUNS * run.transient_run.time + CYCLES * run.mechanics.time) / workers

    warn_if_long(seconds(run), f"exploring {study.name}", lambda: run.quick_look(seconds))
