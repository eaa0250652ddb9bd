"""Simulate what was measured and compare: the way from a study and a table to a `Comparison`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.compare.comparison import Comparison, comparison_of
from tyrefem.compare.experiment import Experiment, Table, experiments
from tyrefem.compare.history import histories
from tyrefem.compare.interface import ResultLike, StudyLike
from tyrefem.errors import InputError
from tyrefem.mechanics import BY_ELEMENTS, same_cycles
from tyrefem.requirements import Requirements
from tyrefem.rolling import run
from tyrefem.studies import Study
from tyrefem.uncertain_numbers import left_out

if TYPE_CHECKING:
    from tyrefem.compare.neighbours import Certificate

#: What a comparison needs of a study.
NEEDS = Requirements("a comparison", measured=True)


def compare(
    study: StudyLike,
    table: Table | None = None,
    result: ResultLike | None = None,
    *,
    inputs: bool = True,
    ignore: Iterable[str] = (),
    rename: Mapping[str, str] | None = None,
    k: float = 2.0,
    executor: Executor | None = None,
    progress: Callable[[int, int], None] | None = None,
    reduced: str = "auto",
) -> Comparison:
    """Deviations between a study and measured temperature histories, E = computed - measured.

    Parameters
    ----------
    study : the study; its sensors give names, noise, accuracy and uncertainty of position.
    table : CSV file (see `tyrefem.measured.read_table`), pandas DataFrame with the same columns, runs already read, or
        a list of these; None = the study's own ``[[measured]]`` entries, with their drives, noise and offsets.
    result : the study's result if it is known; used for every run that was driven at the study's own drive,
        and for a single run in any case if it comes from another (amended, other drive) study.
    inputs : run the study again with each number of ``study.uncertainty`` one standard deviation higher: all that its
        cards and ``[uncertainty]`` state and that can matter, a card's number in all its regions at once.
    ignore : columns of the tables to leave out. ``rename`` : column name -> sensor name; both beside what the
        ``[[measured]]`` entries say.
    k : coverage factor of the verdict; 2 for about 95 %.
    executor : runs the simulations side by side (`concurrent.futures.ProcessPoolExecutor` or alike).
    progress : called with (simulations done, simulations in all) after each.
    reduced : "auto" makes a reduced model of the drives' runs for the changed inputs, where there are at least 12 of
        these, tries it on three or more of them that are run in full, and uses it if it held; "never" does not.

    Raises
    ------
    InputError : a campaign; no measured runs; the table cannot be read, a column is no sensor, no measured time is
        within the simulated span.

    Source: ASME V&V 20-2009; equations and simplifications in docs/validation.md.
    """
    NEEDS.check(study, table)
    if not 0.0 < k < 100.0:
        raise InputError(f"the coverage factor k must be more than 0 and less than 100, not {k!r}")
    if reduced not in ("auto", "never"):
        raise InputError(f"reduced is 'auto' or 'never', not {reduced!r}")
    planned = experiments(study, table, ignore=ignore, rename=rename)
    if result is None and isinstance(study, Study):
        _check_times(study, planned)
    keys = dict(study.uncertainty) if inputs else {}
    solved, certificate, said = _solved(study, planned, result, keys, executor, progress, reduced)
    found, curves, notes = [], {}, []
    for experiment in planned:
        computed, perturbed = solved[_drive(experiment)]
        own, outside = histories(experiment, study, computed, perturbed)
        found += own
        curves[experiment.name] = computed.readings
        first, last = computed.readings["time_s"].iloc[[0, -1]]
        notes += _outside(experiment, first, last, outside)
    if not found:
        raise InputError("no measured time is within the simulated span: " + "; ".join(notes))
    notes += [*said, *_left_out(planned), *_unstated(study, planned, inputs)]
    regions = {number.key: number.regions for number in getattr(study, "uncertain_numbers", ())}
    return comparison_of(
        study.name, found, curves=curves, relative_sd=keys, regions=regions, notes=tuple(notes), k=k,
        reduced=certificate,
    )  # fmt: skip


def _drive(experiment: Experiment) -> str:
    """Experiments at the same drive share their simulations."""
    return repr(sorted(experiment.drive.items()))


def _run(study: StudyLike) -> ResultLike:
    from tyrefem.compare.computed import computed_of

    other: Any = study
    return computed_of(run(study) if isinstance(study, Study) else other.run())


#: Drive and changed input; None: as the study has it.
Key = tuple[str, str | None]


def _solved(
    study: StudyLike,
    planned: Sequence[Experiment],
    result: ResultLike | None,
    keys: Mapping[str, float],
    executor: Executor | None,
    progress: Callable[[int, int], None] | None,
    reduced: str,
) -> tuple[dict[str, tuple[ResultLike, dict[str, ResultLike]]], Certificate | None, list[str]]:
    """Drive -> its result, and its results with each uncertain input one sd higher; certificate; notes."""
    known: dict[str, ResultLike] = {}
    studies: dict[Key, StudyLike] = {}
    drives: dict[str, StudyLike] = {}
    for experiment in planned:
        drive = _drive(experiment)
        if drive in known or (drive, None) in studies:
            continue
        driven = study.with_drive(dict(experiment.drive)) if experiment.drive else study
        amended = result is not None and len(planned) == 1 and result.study is not study
        if result is not None and (not experiment.drive or amended):
            known[drive] = result
            driven = result.study
        else:
            studies[drive, None] = driven
        drives[drive] = driven
        studies |= {(drive, key): driven.scaled(key, 1.0 + sd) for key, sd in keys.items()}

    def done(count: int) -> None:
        if progress is not None:
            progress(count, len(studies))

    each: Any = executor.map if executor is not None else map
    results: dict[Key, ResultLike] = {}
    certificate: Certificate | None = None
    notes: list[str] = []
    if reduced == "auto":
        results, certificate, notes = _by_model(
            studies, lambda drive, key: drives[drive].scaled(key, 1 / (1 + keys[key])), known, each, done
        )
    # The same change at one drive after the other: what takes long to find for a change, its drives may share.
    order: dict[str | None, int] = {None: -1}
    order |= {key: number for number, key in enumerate(keys)}
    missing = sorted((what for what in studies if what not in results), key=lambda what: order[what[1]])
    notes += _cost(study, studies, drives)
    for what, computed in zip(missing, each(_run, [studies[what] for what in missing]), strict=True):
        results[what] = computed
        done(len(results))
    known |= {drive: found for (drive, key), found in results.items() if key is None}
    together = {drive: (computed, {key: results[drive, key] for key in keys}) for drive, computed in known.items()}
    return together, certificate, notes


def _by_model(
    studies: Mapping[Key, StudyLike],
    lowered: Callable[[str, str], Any],
    known: Mapping[str, ResultLike],
    each: Any,
    done: Callable[[int], None],
) -> tuple[dict[Key, ResultLike], Certificate | None, list[str]]:
    """The runs that were made with the help of a reduced model: all, or full ones only if it did not hold."""
    from tyrefem.compare.neighbours import WORTH, Neighbours, followed
    from tyrefem.result import Result

    own = {what: one for what, one in studies.items() if isinstance(one, Study)}
    at_hand = {drive: one for drive, one in known.items() if isinstance(one, Result)}
    if len(own) < len(studies) or len(at_hand) < len(known):
        return {}, None, []
    everything = followed({(drive, None): one.study for drive, one in at_hand.items()} | own)
    if sum(key is not None for _, key in everything) < WORTH:
        return {}, None, []
    neighbours = None
    try:
        neighbours = Neighbours(everything, lowered, at_hand, each, done)
        certificate = neighbours.solve()
    except (InputError, np.linalg.LinAlgError) as error:
        # What is wrong with the study itself is said by its full run.
        made = {} if neighbours is None else neighbours.found
        return dict(made), None, [f"Note: all runs with a changed input are full ones: {error}"]
    return dict(neighbours.found), certificate, [certificate.sentence]


def _check_times(study: Study, planned: Sequence[Experiment]) -> None:
    """Refuse readings that are all outside their runs' drives, before these are simulated."""
    notes: list[str] = []
    for experiment in planned:
        driven = study.with_drive(dict(experiment.drive)) if experiment.drive else study
        times, end = experiment.run.times, driven.card.drive.end
        outside = int(np.sum((times < 0.0) | (times > end * (1 + 1e-9))))
        if outside < len(times):
            return
        notes += _outside(experiment, 0.0, end, outside)
    raise InputError("no measured time is within the simulated span: " + "; ".join(notes))


def _cost(study: StudyLike, studies: Mapping[Key, StudyLike], drives: Mapping[str, StudyLike]) -> list[str]:
    """What the changed inputs cost, where strain cycles take longer than a run."""
    changed = {what: one for what, one in studies.items() if what[1] is not None}
    if not changed or not isinstance(study, Study) or study.card.mechanics.strain not in BY_ELEMENTS:
        return []
    moved = sum(not same_cycles(one, drives[drive]) for (drive, _), one in changed.items())  # type: ignore[arg-type]
    return [
        f"Note: {len(changed)} runs with a changed input; {moved} of them change the strain cycle, which finite "
        "elements solve anew"
    ]


def _outside(experiment: Experiment, first: float, last: float, outside: int) -> list[str]:
    if not outside:
        return []
    total = len(experiment.run.times)
    level = "ERROR" if 2 * outside > total else "Note"
    return [
        f"{level}: run '{experiment.name}': {outside} of {total} measured times lie outside the simulated span "
        f"{first:g} to {last:g} s and are not compared"
    ]


def _left_out(planned: Sequence[Experiment]) -> list[str]:
    channels = dict.fromkeys(heading for experiment in planned for heading in experiment.run.channels)
    return [f"Note: no temperatures, left out: {', '.join(channels)}"] if channels else []


def _unstated(study: StudyLike, planned: Sequence[Experiment], inputs: bool) -> list[str]:
    """What the uncertainty leaves out, because nobody stated it."""
    notes = []
    if not study.uncertainty:
        notes.append("Note: the study states no uncertainty of its inputs, so u_input is 0")
    elif not inputs:
        notes.append("Note: the uncertainty of the inputs was left out, so u_input is 0")
    if inputs:
        notes += [f"Note: inputs {line}" for line in left_out(getattr(study, "uncertain_numbers", ()))]
    silent = {
        sensor: None
        for experiment in planned
        for sensor in experiment.run.sensors
        if not experiment.noise
        and (experiment.noise is not None or not getattr(study.sensors.get(sensor), "noise", 0.0))
    }
    if silent:
        notes.append(f"Note: no measurement noise stated for {', '.join(silent)}")
    return notes
