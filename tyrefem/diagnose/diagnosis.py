"""The diagnosis: find the gap, name what is missing, judge, add it, show that the gap shrinks."""

from __future__ import annotations

import functools
import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.compare.experiment import Table, experiments
from tyrefem.diagnose.amend import Change, amended, changes
from tyrefem.diagnose.laboratory import Bench, Laboratory, Response, laboratory
from tyrefem.diagnose.missing import MissingHeat, missing_heat, missing_heat_fitted, patches
from tyrefem.diagnose.progress_store import ProgressStore
from tyrefem.diagnose.refine import Explained, Gap, refined
from tyrefem.diagnose.search import search
from tyrefem.diagnose.sets import Prior
from tyrefem.diagnose.trials import trial
from tyrefem.diagnose.unknowns import Candidate, Unknown, base_unknowns, candidates, sensor_unknowns
from tyrefem.diagnose.verdict import IDENTIFIED, IMPROBABLE, OUTSIDE, UNEXPLAINED, Judgement, judge, standings
from tyrefem.diagnose.where import gap_table, rms
from tyrefem.errors import InputError
from tyrefem.studies import Study

if TYPE_CHECKING:
    import pandas as pd

Tick = Callable[[str, int, int], None]
#: Diagnoses at most, each of what the one before it has left.
LOOKS = 3
#: Heat of unknown origin that the linear model puts this far, or less, below the best set is fitted in the full model.
NEAR = 10.0


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """What a diagnosis found.

    Parameters
    ----------
    original : the study that was held against the data. study : the amended one, ready to save and run.
    judgement : verdict, sets with their probabilities, reasons. gap : data, base predictions, tangents.
    null, best : the fits without any effect and with the most probable set. missing : heat of unknown origin.
    changes : what ``study`` has that ``original`` has not. before, after : trial -> block means, degC.
    next_experiment : what would tell the credible sets apart; empty where nothing needs telling.
    seconds : wall time. again : what was found when the amended study was held against the same data.
    """

    original: Study
    study: Study
    judgement: Judgement
    gap: Gap
    candidates: tuple[Candidate, ...]
    null: Explained
    best: Explained
    missing: MissingHeat
    changes: tuple[Change, ...]
    before: dict[int, Any]
    after: dict[int, Any]
    next_experiment: Mapping[str, Any]
    seconds: float
    again: Diagnosis | None = None

    @property
    def looks(self) -> tuple[Diagnosis, ...]:
        """This diagnosis and those of what was left."""
        return (self, *(self.again.looks if self.again else ()))

    @property
    def verdict(self) -> str:
        """identified, confounded, unexplained or no gap."""
        return self.judgement.verdict

    @functools.cached_property
    def where(self) -> pd.DataFrame:
        """Disagreement of the original study with the data by run, sensor and stretch of time."""
        return gap_table(self.gap, self.before)

    @functools.cached_property
    def where_after(self) -> pd.DataFrame:
        """The same for the amended study, at the same stretches of time."""
        return gap_table(self.gap, self.after, self.before)

    @functools.cached_property
    def prior(self) -> Prior:
        """ln of the prior probability of a set."""
        return Prior(self.candidates, self.original.card.diagnosis.effects_expected)

    def rms(self, *, after: bool, held_out: bool) -> float:
        """Root mean square of measured - computed, K."""
        trials = self.gap.held_out if held_out else self.gap.fitted
        return rms(self.gap, self.after if after else self.before, trials)

    @property
    def noise(self) -> float:
        """Root mean square of the readings' noise, K."""
        series = [one for each in self.gap.lab.bench.trials for one in each.series]
        weights = np.array([len(one.times) for one in series], dtype=float)
        return float(np.sqrt(np.average([one.noise**2 for one in series], weights=weights)))

    def to_dict(self) -> dict[str, Any]:
        """What `verdict.json` holds."""
        from tyrefem.diagnose.record import record

        return record(self)

    def save(self, folder: str | Path) -> Path:
        """Write verdict.json, amended.toml, tables, pictures and one self-contained page; returns the page."""
        from tyrefem.diagnose.record import write

        return write(self, Path(folder))


def diagnose(
    study: Study,
    table: Table | None = None,
    *,
    ignore: Iterable[str] = (),
    rename: Mapping[str, str] | None = None,
    largest: int = 3,
    workers: int = 1,
    progress: Tick | None = None,
    known: Sequence[Response] | None = None,
    rerun: bool = True,
    store: ProgressStore | None = None,
    looks: int = LOOKS,
) -> Diagnosis:
    """Find where study and data disagree, name the missing effect, add it and show what is left.

    What is identified is added, and the amended study is held against the same data again, until nothing more is
    identified: see `Diagnosis.again`.

    Parameters
    ----------
    study : the study; its cards and sensors state what is uncertain, its ``[diagnosis]`` table the rest.
    table : CSV file or runs; None = the study's own ``[[measured]]`` entries. ignore, rename : see `compare`.
    largest : effects at most in a set. workers : processes. progress : called with (what is done, number, of how many).
    known : responses of the runs' drives already at hand (see `responses`), for many diagnoses of one layout.
    rerun : run the amended study on its own mesh at the end; else ``after`` is the fit's own prediction.
    store : where finished simulations are kept, so that an interrupted diagnosis takes them up again.
    looks : diagnoses at most.

    Raises
    ------
    InputError : as `compare`; or every run is held out.
    """
    found: list[Diagnosis] = []
    while not found or (found[-1].verdict == IDENTIFIED and len(found) < looks):
        number = len(found)
        found.append(
            _look(
                found[-1].study if found else study,
                table,
                ignore=ignore,
                rename=rename,
                largest=largest,
                workers=workers,
                tick=_numbered(progress, number),
                known=None if number else known,
                rerun=rerun,
                store=store and store.look(number),
            )
        )
    result = found.pop()
    while found:
        result = replace(found.pop(), again=result)
    return result


def _numbered(progress: Tick | None, number: int) -> Tick:
    if progress is None:
        return lambda what, done, total: None
    if not number:
        return progress
    return lambda what, done, total: progress(f"{what}, look {number + 1}", done, total)


def _look(
    study: Study,
    table: Table | None,
    *,
    ignore: Iterable[str],
    rename: Mapping[str, str] | None,
    largest: int,
    workers: int,
    tick: Tick,
    known: Sequence[Response] | None,
    rerun: bool,
    store: ProgressStore | None,
) -> Diagnosis:
    """One diagnosis."""
    began = time.perf_counter()
    planned = experiments(study, table, ignore=ignore, rename=rename)
    trials = tuple(one for one in (trial(each, study) for each in planned) if one.series)
    if not any(not one.hold_out for one in trials):
        raise InputError("no reading within the simulated drive in any run that is not held out", file=study.file)
    bench = Bench(study, trials)
    if store is not None and store.open(bench):
        tick(f"taking up {store.taken_up} simulations", 0, 0)
    with laboratory(bench, workers, store) as lab:
        gap = gap_of(lab, tick, known)
        found = candidates(study)
        prior = Prior(found, study.card.diagnosis.effects_expected)
        done = 0

        def count(what: str) -> None:
            nonlocal done
            done += 1
            tick(what, done, 0)

        unknown = patches(study)
        outside = math.log(study.card.diagnosis.effects_expected * OUTSIDE)

        def elsewhere(null: Explained) -> float:
            return outside + missing_heat(gap, unknown, null).log_evidence

        scored = search(gap, found, prior, largest=largest, tick=count, outside=elsewhere)
        explained = {one.members: one for _, _, one in scored if one is not None}
        null = explained[()]
        missing = missing_heat(gap, unknown, null)
        ahead = scored[0]
        doubtful = ahead[2] is None or min(ahead[2].p_value, ahead[2].held_out_p) < IMPROBABLE
        if doubtful or outside + missing.log_evidence > ahead[0] - NEAR:
            missing = missing_heat_fitted(gap, unknown, null, lambda: count("fitting heat of unknown origin"))
        ranked = standings(scored, outside + missing.log_evidence)

        def fitted(members: tuple[Candidate, ...]) -> Explained | None:
            if members not in explained:
                explained[members] = refined(gap, [members])[0]
            return explained[members]

        judgement = judge(ranked, fitted)
        best = judgement.best.explained or (null if judgement.best.unexplained else fitted(judgement.best.members))
        assert best is not None
        values, sd = best.values, best.sd
        lacking = [one for member in best.members for one in member.unknowns]
        if judgement.verdict == UNEXPLAINED:
            # Nothing is named: the study gets the heat of unknown origin that is more than two sd from none.
            lacking = [one for one in unknown if abs(missing.values.get(one, 0.0)) > 2 * missing.sd.get(one, 1.0)]
            values = {one: x for one, x in missing.values.items() if one in lacking or one not in unknown}
            sd = missing.sd
        change = changes(gap, values, sd, lacking, [one.name for one in trials])
        new = amended(study, change)
        before = {i: gap.corrected(i, gap.computed[i]) for i in range(len(trials))}
        tick("running the amended study", 0, 0)
        if rerun:
            driven = [amended(bench.driven(study, i), change) for i in range(len(trials))]
            after = dict(enumerate(lab.ask("full", list(enumerate(driven)))))
        else:
            answers = lab.ask("predict", [(i, values) for i in range(len(trials))])
            after = {i: gap.corrected(i, answer) for i, answer in enumerate(answers)}
        further: Mapping[str, Any] = {}
        if judgement.verdict == "confounded":
            from tyrefem.diagnose.experiment import next_experiment

            tick("looking for the experiment that decides", 0, 0)
            further = next_experiment(gap, judgement, fitted)
    return Diagnosis(
        study, new, judgement, gap, found, null, best, missing, change, before, after, further,
        time.perf_counter() - began,
    )  # fmt: skip


def unknowns_of(study: Study, measured: Iterable[str]) -> tuple[tuple[Unknown, ...], int]:
    """Everything that a diagnosis with these sensors may fit, and how many of it, the first, are in every model."""
    nuisance = (*base_unknowns(study), *sensor_unknowns(study, set(measured)))
    found = [one for each in candidates(study) for one in (*each.amplitudes, *each.presence)]
    return (*nuisance, *found, *patches(study)), len(nuisance)


def responses(lab: Laboratory, unknowns: tuple[Unknown, ...], tick: Tick | None = None) -> tuple[Response, ...]:
    """The response of every trial's drive: the dear part of a diagnosis, and the same for any data."""
    count = len(lab.bench.trials)
    done = 0

    def step() -> None:
        nonlocal done
        done += 1
        if tick:
            tick("sensitivities", done, count)

    sensors = lab.bench.sensors
    return tuple(
        Response(unknowns, times, *(dict(zip(sensors, each, strict=True)) for each in stacks))
        for times, *stacks in lab.ask("response", [(i, unknowns) for i in range(count)], step)
    )


def gap_of(lab: Laboratory, tick: Tick | None = None, known: Sequence[Response] | None = None) -> Gap:
    """Data against study for the trials of a laboratory; ``known``: their responses, if at hand."""
    trials = lab.bench.trials
    unknowns, nuisance = unknowns_of(lab.bench.study, {one.sensor for each in trials for one in each.series})
    if known is not None and any(one.unknowns != unknowns for one in known):
        raise InputError("the responses at hand are of another study, or of other sensors")
    found = known or responses(lab, unknowns, tick)
    computed, correction, jacobians = zip(
        *(one.blocks(each) for one, each in zip(found, trials, strict=True)), strict=True
    )
    return Gap(lab, unknowns, nuisance, correction, computed, jacobians, tuple(found))
