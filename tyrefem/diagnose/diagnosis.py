"""The diagnosis: find the gap, name what is missing, judge, add it, show that the gap shrinks."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.compare.experiment import Table, experiments
from tyrefem.diagnose.amend import Change, amended, changes
from tyrefem.diagnose.laboratory import Bench, Laboratory, laboratory
from tyrefem.diagnose.missing import MissingHeat, missing_heat, patches
from tyrefem.diagnose.refine import Explained, Gap, refined
from tyrefem.diagnose.search import search
from tyrefem.diagnose.sets import Prior
from tyrefem.diagnose.trials import trial
from tyrefem.diagnose.unknowns import Candidate, base_unknowns, candidates, sensor_unknowns
from tyrefem.diagnose.verdict import OUTSIDE, Judgement, judge, standings
from tyrefem.diagnose.where import gap_table, rms
from tyrefem.errors import InputError
from tyrefem.studies import Study

if TYPE_CHECKING:
    import pandas as pd

Tick = Callable[[str, int, int], None]


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
    seconds : wall time.
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
        """The same for the fitted model."""
        return gap_table(self.gap, self.after)

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
    gap: Gap | None = None,
) -> Diagnosis:
    """Find where study and data disagree, name the missing effect, add it and show what is left.

    Parameters
    ----------
    study : the study; its cards and sensors state what is uncertain, its ``[diagnosis]`` table the rest.
    table : CSV file or runs; None = the study's own ``[[measured]]`` entries. ignore, rename : see `compare`.
    largest : effects at most in a set. workers : processes. progress : called with (what is done, number, of how many).
    gap : data and tangents already at hand (see `gap_of`), for many diagnoses of one layout.

    Raises
    ------
    InputError : as `compare`; or every run is held out.
    """
    began = time.perf_counter()
    tick = progress or (lambda what, done, total: None)
    planned = experiments(study, table, ignore=ignore, rename=rename)
    trials = tuple(one for one in (trial(each, study) for each in planned) if one.series)
    if not any(not one.hold_out for one in trials):
        raise InputError("no reading within the simulated drive in any run that is not held out", file=study.file)
    with laboratory(Bench(study, trials), workers) as lab:
        if gap is None:
            gap = gap_of(lab, tick)
        found = candidates(study)
        prior = Prior(found, study.card.diagnosis.effects_expected)
        done = 0

        def count(what: str) -> None:
            nonlocal done
            done += 1
            tick(what, done, 0)

        scored = search(gap, found, prior, largest=largest, tick=count)
        explained = {one.members: one for _, _, one in scored if one is not None}
        null = explained[()]
        best_known = max(explained.values(), key=lambda one: prior(one.members) + one.log_evidence)
        unknown = patches(study)
        missing = missing_heat(gap, unknown, null)
        outside = np.log(study.card.diagnosis.effects_expected * OUTSIDE) + missing.log_evidence
        ranked = standings(scored, float(outside))

        def fitted(members: tuple[Candidate, ...]) -> Explained | None:
            if members not in explained:
                explained[members] = refined(gap, [members])[0]  # type: ignore[arg-type]
            return explained[members]

        judgement = judge(ranked, fitted)
        best = judgement.best.explained or (null if judgement.best.unexplained else fitted(judgement.best.members))
        assert best is not None
        if best.members:
            missing = missing_heat(gap, unknown, best_known)
        tick("running the amended study", 0, 0)
        change = changes(gap, best, [one.name for one in trials])
        new = amended(study, change)
        before = {i: gap.computed[i] + gap.correction[i] for i in range(len(trials))}
        after = dict(enumerate(lab.ask("full", [(i, new) for i in range(len(trials))])))
        further: Mapping[str, Any] = {}
        if judgement.verdict == "confounded":
            from tyrefem.diagnose.experiment import next_experiment

            tick("looking for the experiment that decides", 0, 0)
            further = next_experiment(gap, judgement, fitted)
    return Diagnosis(
        study, new, judgement, gap, found, null, best, missing, change, before, after, further,
        time.perf_counter() - began,
    )  # fmt: skip


def gap_of(lab: Laboratory, tick: Tick | None = None) -> Gap:
    """Base predictions and tangents of every trial of a laboratory."""
    study, trials = lab.bench.study, lab.bench.trials
    measured = {one.sensor for each in trials for one in each.series}
    nuisance = (*base_unknowns(study), *sensor_unknowns(study, measured))
    found = [one for each in candidates(study) for one in (*each.amplitudes, *each.presence)]
    unknowns = (*nuisance, *found, *patches(study))
    done = 0

    def step() -> None:
        nonlocal done
        done += 1
        if tick:
            tick("sensitivities", done, len(trials))

    answers = lab.ask("prepared", [(i, unknowns) for i in range(len(trials))], step)
    computed, correction, jacobians = (tuple(each) for each in zip(*answers, strict=True))
    return Gap(lab, unknowns, len(nuisance), correction, computed, jacobians)
