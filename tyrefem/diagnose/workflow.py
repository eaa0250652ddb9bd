"""The diagnosis: find the gap, name what is missing, judge, add it, show that the gap shrinks.

Which effects a gap is put down to: search, heat of unknown origin, judgement.
"""

from __future__ import annotations

import functools
import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from tyrefem.compare.experiment import Table, experiments
from tyrefem.diagnose.amend import Change, amended, changes
from tyrefem.diagnose.diagnosis import Diagnosis
from tyrefem.diagnose.effort import check_effort
from tyrefem.diagnose.evaluations import ProgressStore, laboratory
from tyrefem.diagnose.fit import refined
from tyrefem.diagnose.fitted import Explained
from tyrefem.diagnose.forward_model import Bench, Response
from tyrefem.diagnose.linearised import Gap
from tyrefem.diagnose.missing_heat import MissingHeat, missing_heat, missing_heat_fitted, patches
from tyrefem.diagnose.runs import trial
from tyrefem.diagnose.search import Prior, Scored, search
from tyrefem.diagnose.sensitivities import Tick, gap_of
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns import Candidate, Unknown, candidates
from tyrefem.diagnose.verdict import (
    CONFOUNDED,
    IDENTIFIED,
    UNEXPLAINED,
    Judgement,
    judge,
    standings,
)
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.requirements import Requirements


class Naming:
    """What the search of one look comes to.

    Attributes
    ----------
    judgement : verdict and sets with their probabilities. best, null : fits with the most probable set and with none.
    missing : heat of unknown origin.
    """

    def __init__(self, gap: Gap, study: StudyData, found: tuple[Candidate, ...], count: Callable[[str], None]) -> None:
        self.gap = gap
        prior = Prior(found, study.card.diagnosis.effects_expected, gap.settings.size_shares)
        scored, self.missing = _searched(gap, study, found, prior, count)
        self.explained = {one.members: one for _, _, one in scored if one is not None}
        self.null = self.explained[()]
        self.judgement = judge(standings(scored, _outside(gap) + self.missing.log_evidence), self.fitted, gap.settings)
        ahead = self.judgement.best
        self.best = ahead.explained or (self.null if ahead.unexplained else self.fitted(ahead.members))

    def fitted(self, members: tuple[Candidate, ...]) -> Explained:
        """The fit of a set, made if it has none."""
        if members not in self.explained:
            self.explained[members] = refined(self.gap, [members])[0]
        return self.explained[members]


def _outside(gap: Gap) -> float:
    """ln of the prior probability that what is missing is not in the catalogue."""
    return math.log(gap.lab.bench.study.card.diagnosis.effects_expected * gap.settings.outside_share)


def _searched(
    gap: Gap, study: StudyData, found: tuple[Candidate, ...], prior: Prior, count: Callable[[str], None]
) -> tuple[list[Scored], MissingHeat]:
    """All sets with their scores, and heat of unknown origin: in the full model where it may matter."""
    settings = gap.settings
    unknown, outside = patches(study, settings), _outside(gap)

    @functools.cache
    def linear(null: Explained) -> MissingHeat:
        return missing_heat(gap, unknown, null)

    def elsewhere(null: Explained) -> float:
        return outside + linear(null).log_evidence

    scored = search(gap, found, prior, largest=settings.largest, tick=count, outside=elsewhere)
    null = next(one for _, members, one in scored if one is not None and not members)
    missing = linear(null)
    score, _, ahead = scored[0]
    doubtful = ahead is None or min(ahead.p_value, ahead.held_out_p) < settings.improbable
    if doubtful or outside + missing.log_evidence > score - settings.missing_near:
        missing = missing_heat_fitted(gap, unknown, null, lambda: count("fitting heat of unknown origin"))
    return scored, missing


#: What a diagnosis needs of a study.
NEEDS = Requirements("a diagnosis", measured=True, fitted=True)


def diagnose(
    study: StudyData,
    table: Table | None = None,
    *,
    ignore: Iterable[str] = (),
    rename: Mapping[str, str] | None = None,
    largest: int | None = None,
    workers: int = 1,
    progress: Tick | None = None,
    known: Sequence[Response] | None = None,
    rerun: bool = True,
    store: ProgressStore | None = None,
    looks: int | None = None,
    reduced: str | None = None,
    settings: DiagnosisSettings = DEFAULT,
) -> Diagnosis:
    """Find where study and data disagree, name the missing effect, add it and show what is left.

    What is identified is added, and the amended study is held against the same data again, until nothing more is
    identified: see `Diagnosis.again`.

    Parameters
    ----------
    study : the study; its cards and sensors state what is uncertain, its ``[diagnosis]`` table the rest.
    table : as of `compare`; None = the study's own ``[[measured]]`` entries. ignore, rename : see `compare`.
    workers : processes. progress : called with (what is done, number, of how many).
    known : responses of the runs' drives already at hand (see `responses`), for many diagnoses of one layout.
    rerun : run the amended study on its own mesh at the end; else ``after`` is the fit's own prediction.
    store : where finished simulations are kept, so that an interrupted diagnosis takes them up again.
    largest, looks, reduced : in place of what ``settings`` say.
    settings : every number that steers the diagnosis.

    Raises
    ------
    InputError : as `compare`; or every run is held out, or read outside the simulated drive only.
    """
    stated: dict[str, Any] = {"largest": largest, "looks": looks, "reduced": reduced}
    settings = replace(settings, **{name: value for name, value in stated.items() if value is not None})
    NEEDS.check(study, table)
    found: list[Diagnosis] = []
    while not found or (found[-1].verdict == IDENTIFIED and len(found) < settings.looks):
        number = len(found)
        found.append(
            _look(
                found[-1].study if found else study,
                table,
                ignore=ignore,
                rename=rename,
                workers=workers,
                tick=_numbered(progress, number),
                known=None if number else known,
                rerun=rerun,
                store=store and store.look(number),
                settings=settings,
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
    study: StudyData,
    table: Table | None,
    *,
    ignore: Iterable[str],
    rename: Mapping[str, str] | None,
    workers: int,
    tick: Tick,
    known: Sequence[Response] | None,
    rerun: bool,
    store: ProgressStore | None,
    settings: DiagnosisSettings,
) -> Diagnosis:
    """One diagnosis."""
    began = time.perf_counter()
    planned = experiments(study, table, ignore=ignore, rename=rename)
    NEEDS.check_fitted(study, [one.hold_out for one in planned])
    trials = tuple(one for one in (trial(each, study, settings) for each in planned) if one.series)
    if not any(not one.hold_out for one in trials):
        message = "no reading within the simulated drive in any run that is not held out"
        raise InputError(message, field="measured", file=study.file)
    bench = Bench(study, trials, settings=settings)
    if known is None:
        check_effort(bench, f"the diagnosis of {study.name}", 1.0, workers)
    if store is not None and store.open(bench):
        tick(f"taking up {store.taken_up} simulations", 0, 0)
    with laboratory(bench, workers, store) as lab:
        gap = gap_of(lab, tick, known, reduced=settings.reduced == "auto")
        found = candidates(study)
        named = Naming(gap, study, found, _Counted(tick))
        if not gap.predicted.confirmed(named.best.members, named.best.values):
            tick("the reduced models do not hold there: simulating", 0, 0)
            said = gap.predicted
            gap = replace(gap, predictions=replace(said, modes=(), given_up=True))
            named = Naming(gap, study, found, _Counted(tick))
        judgement, best, missing = named.judgement, named.best, named.missing
        values, sd, lacking = _lacking(gap, judgement, best, missing)
        change = changes(gap, values, sd, lacking, [one.name for one in trials])
        tick("running the amended study", 0, 0)
        after = _after(gap, change if rerun else None, values)
        further: Mapping[str, Any] = {}
        if judgement.verdict == CONFOUNDED:
            from tyrefem.diagnose.next_experiment import next_experiment

            tick("looking for the experiment that decides", 0, 0)
            further = next_experiment(gap, judgement, named.fitted)
    before = {i: gap.corrected(i, gap.computed[i]) for i in range(len(trials))}
    return Diagnosis(
        study, amended(study, change), judgement, gap, found, named.null, best, missing, change, before, after, further,
        time.perf_counter() - began,
    )  # fmt: skip


class _Counted:
    """Counts the simulations of the fits, of which nobody knows beforehand how many there will be."""

    def __init__(self, tick: Tick) -> None:
        self.tick, self.done = tick, 0

    def __call__(self, what: str) -> None:
        self.done += 1
        self.tick(what, self.done, 0)


def _lacking(
    gap: Gap, judgement: Judgement, best: Explained, missing: MissingHeat
) -> tuple[Mapping[Unknown, float], Mapping[Unknown, float], list[Unknown]]:
    """Values and sd of the unknowns, and which of them the study lacks."""
    if judgement.verdict != UNEXPLAINED:
        return best.values, best.sd, [one for member in best.members for one in member.unknowns]
    # Nothing is named: the study gets the heat of unknown origin that is more than two sd from none.
    unknown = patches(gap.lab.bench.study, gap.settings)
    lacking = [one for one in unknown if abs(missing.values.get(one, 0.0)) > 2 * missing.sd.get(one, 1.0)]
    return {one: x for one, x in missing.values.items() if one in lacking or one not in unknown}, missing.sd, lacking


def _after(gap: Gap, change: tuple[Change, ...] | None, values: Mapping[Unknown, float]) -> dict[int, Any]:
    """Block means of every trial with the changes, on the study's own mesh; as fitted, if there are None."""
    bench = gap.lab.bench
    numbers = range(len(bench.trials))
    if change is None:
        answers = gap.lab.ask("predict", [(i, values) for i in numbers])
        return {i: gap.corrected(i, answer) for i, answer in enumerate(answers)}
    driven = [amended(bench.driven(bench.study, i), change) for i in numbers]
    return dict(enumerate(gap.lab.ask("full", list(enumerate(driven)))))
