"""The diagnosis: readings, residuals, candidates, fits, ranking, verdict; and the study that has what was missing."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Unpack

from tyrefem.brief import Brief
from tyrefem.compare.experiment import ColumnNames, Table, experiments
from tyrefem.diagnose.amend import Change, amended, changes
from tyrefem.diagnose.candidates import Members, SetPrior
from tyrefem.diagnose.criterion import Criterion
from tyrefem.diagnose.diagnosis import DiagnosisData
from tyrefem.diagnose.effort import check_effort
from tyrefem.diagnose.evaluations import Evaluations, evaluating
from tyrefem.diagnose.fits import FittedSet, first_fits
from tyrefem.diagnose.forward_model import ForwardModel
from tyrefem.diagnose.heat_patches import patches
from tyrefem.diagnose.missing_heat import UnknownHeat, missing_heat, missing_heat_fitted
from tyrefem.diagnose.multifidelity import Predictions
from tyrefem.diagnose.next_experiment import next_experiment
from tyrefem.diagnose.options import DiagnosisOptions, Method, SimulationWork, grouped
from tyrefem.diagnose.residuals import Residuals, residuals_of
from tyrefem.diagnose.runs import Trial, trial
from tyrefem.diagnose.selection import SelectionProblem
from tyrefem.diagnose.sensitivities import responses, sensitivities, unknowns_of
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns import Unknown
from tyrefem.diagnose.verdict import CONFOUNDED, IDENTIFIED, UNEXPLAINED, Judgement, judge, ranked
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.requirements import Requirements

#: What a diagnosis needs of a study.
NEEDS = Requirements("a diagnosis", measured=True, fitted=True)


def diagnose(study: StudyData, table: Table | None = None, **options: Unpack[DiagnosisOptions]) -> DiagnosisData:
    """Find where study and data disagree, name the missing effect, add it and show what is left.

    What is identified is added, and the amended study is held against the same data again, until nothing more is
    identified: see `DiagnosisData.again`.

    Parameters
    ----------
    study : the study; its cards and sensors state what is uncertain, its ``[diagnosis]`` table the rest.
    table : as of `compare`; None = the study's own ``[[measured]]`` entries. ignore, rename : see `compare`.
    settings : every number that steers the diagnosis, see `DiagnosisSettings`.
    largest, looks, reduced : in place of what ``settings`` say: effects at most in a set; diagnoses at most; "auto" or
        "never", whether reduced models of the drives predict for the fits where simulations confirm them.
    candidates : function of the study that gives the effects it may lack; default: all of the catalogue.
    criterion : how well a set explains the data: `LogEvidence` (default), `BIC`, or any `Criterion`.
    strategy : which sets are fitted: `ForwardSelection` (default), `Exhaustive`, or any `Strategy`.
    workers : processes. progress : called with (what is done, number, of how many).
    known : responses of the runs' drives already at hand (see `responses`), for many diagnoses of one layout.
    rerun : run the amended study on its own mesh at the end; else ``after`` is the fit's own prediction.
    store : where finished simulations are kept, so that an interrupted diagnosis takes them up again.

    Raises
    ------
    InputError : as `compare`; or every run is held out, or read outside the simulated drive only.
    TypeError : a keyword that is none of these.
    """
    columns, method, work = grouped(options)
    NEEDS.check(study, table)
    looks: list[DiagnosisData] = []
    while not looks or (looks[-1].verdict == IDENTIFIED and len(looks) < method.settings.looks):
        current = looks[-1].study if looks else study
        looks.append(_look(current, table, columns, method, work.look(len(looks))))
    result = looks.pop()
    while looks:
        result = replace(looks.pop(), again=result)
    return result


def _look(
    study: StudyData, table: Table | None, columns: ColumnNames, method: Method, work: SimulationWork
) -> DiagnosisData:
    """One diagnosis: what is measured goes forwards from residuals to ranking, verdict and amended study."""
    began = time.perf_counter()
    settings = method.settings
    trials, candidates = _trials(study, table, columns, settings), method.candidates(study)
    method.strategy.check(study, candidates, settings)
    model = ForwardModel(study, tuple(run.sampling for run in trials), settings=settings)
    if work.known is None:
        check_effort(model, f"the diagnosis of {study.name}", 1.0, work.workers)
    if work.store is not None and work.store.open(model):
        work.tick(f"taking up {work.store.resumed} simulations")
    unknowns, nuisance = unknowns_of(study, {name for run in trials for name in run.parts()}, candidates, settings)
    with evaluating(model, work.workers, work.store) as evaluations:
        known = tuple(work.known or responses(evaluations, unknowns, work.tick))
        sensitive = sensitivities(model.drives, unknowns, nuisance, known)
        residuals = residuals_of(study, trials, sensitive, settings)
        predictions = Predictions(
            evaluations, [response.modes for response in known] if settings.reduced == "auto" else ()
        )
        ranking = rank(residuals, predictions, candidates, method, _Counted(work.tick))
        if not predictions.confirmed(ranking.best.members, ranking.best.values):
            work.tick("the reduced models do not hold there: simulating")
            predictions = replace(predictions, modes=(), given_up=True)
            ranking = rank(residuals, predictions, candidates, method, _Counted(work.tick))
        values, sd, lacking = _lacking(residuals, ranking)
        change = changes(residuals, values, sd, lacking)
        work.tick("running the amended study")
        after = _after(residuals, evaluations, change if work.rerun else None, values)
        further: Mapping[str, Any] = {}
        if ranking.judgement.verdict == CONFOUNDED:
            work.tick("looking for the experiment that decides")
            further = next_experiment(evaluations.model, ranking.judgement, ranking.fit_of)
    return DiagnosisData(
        original=study,
        study=amended(study, change),
        judgement=ranking.judgement,
        gap=residuals,
        candidates=candidates,
        null=ranking.null,
        best=ranking.best,
        missing=ranking.missing,
        changes=change,
        before={number: residuals.corrected(number, computed) for number, computed in enumerate(residuals.computed)},
        after=after,
        next_experiment=further,
        predictions=predictions.to_dict(),
        seconds=time.perf_counter() - began,
    )


def _trials(
    study: StudyData, table: Table | None, columns: ColumnNames, settings: DiagnosisSettings
) -> tuple[Trial, ...]:
    """The measured runs as blocks of readings within the simulated drives."""
    planned = experiments(study, table, ignore=columns.ignore, rename=columns.rename)
    NEEDS.check_fitted(study, [experiment.hold_out for experiment in planned])
    trials = tuple(run for run in (trial(experiment, study, settings) for experiment in planned) if run.sensors)
    if all(run.hold_out for run in trials):
        message = "no reading within the simulated drive in any run that is not held out"
        raise InputError(message, field="measured", file=study.file)
    return trials


@dataclass(frozen=True, eq=False)
class Ranking(Brief):
    """What the search of one look comes to.

    Parameters
    ----------
    judgement : verdict, and sets with their probabilities. best, null : fits with the most probable set and with none.
    missing : heat of unknown origin. fit_of : the fit of a set, made if it has none.
    """

    judgement: Judgement
    best: FittedSet
    null: FittedSet
    missing: UnknownHeat
    fit_of: Callable[[Members], FittedSet]


def rank(
    residuals: Residuals,
    predictions: Predictions,
    candidates: Members,
    method: Method,
    tick: Callable[[str], None] | None = None,
) -> Ranking:
    """Search the sets that explain the residuals, and judge them against each other and against an unknown cause."""
    settings, expected = residuals.settings, residuals.study.card.diagnosis.effects_expected
    prior = SetPrior(candidates, expected, settings.size_shares)
    origin = _UnknownOrigin(residuals, predictions, method.criterion, math.log(expected * settings.outside_share))
    problem = SelectionProblem(
        residuals,
        predictions,
        candidates,
        prior,
        method.criterion,
        lambda null: origin.score(null, origin.of(null)),
        tick,
    )
    scored = method.strategy.search(problem)
    fits = {problem.ordered(entry.fit.members): entry.fit for entry in scored if entry.fit is not None}
    null = fits[()]

    def fit_of(members: Members) -> FittedSet:
        if members not in fits:
            (fits[members],) = first_fits(residuals, predictions, [members])
        return fits[members]

    missing, best = origin.of(null), scored[0]
    doubtful = best.fit is None or min(best.fit.p_value, best.fit.held_out_p) < settings.improbable
    if doubtful or origin.score(null, missing) > best.score - settings.missing_near:
        missing = missing_heat_fitted(
            residuals,
            predictions,
            origin.patches,
            null,
            lambda: tick("fitting heat of unknown origin") if tick else None,
        )
    judgement = judge(ranked(scored, origin.score(null, missing)), fit_of, settings)
    ahead = judgement.best
    return Ranking(judgement, ahead.fit or (null if ahead.outside else fit_of(ahead.members)), null, missing, fit_of)


class _UnknownOrigin:
    """Heat of unknown origin as a rival of all sets of the catalogue; ``prior``: ln of its prior probability."""

    def __init__(self, residuals: Residuals, predictions: Predictions, criterion: Criterion, prior: float) -> None:
        self.residuals, self.criterion, self.prior = residuals, criterion, prior
        self.patches = patches(residuals.study, residuals.settings)

    def of(self, null: FittedSet) -> UnknownHeat:
        """In the linear model about the fit of no effect."""
        return missing_heat(self.residuals, self.patches, null)

    def score(self, null: FittedSet, heat: UnknownHeat) -> float:
        """ln(prior) + criterion: of no effect, and what the evidence gains by the heat."""
        return self.prior + self.criterion.of_fit(null) + (heat.log_evidence - null.log_evidence)


class _Counted:
    """Counts the simulations of the fits, of which nobody knows beforehand how many there will be."""

    def __init__(self, tick: Callable[[str, int, int], None]) -> None:
        self.tick, self.done = tick, 0

    def __call__(self, what: str) -> None:
        self.done += 1
        self.tick(what, self.done, 0)


def _lacking(
    residuals: Residuals, ranking: Ranking
) -> tuple[Mapping[Unknown, float], Mapping[Unknown, float], list[Unknown]]:
    """Values and sd of the unknowns, and which of them the study lacks."""
    best, missing = ranking.best, ranking.missing
    if ranking.judgement.verdict != UNEXPLAINED:
        return best.values, best.sd, [unknown for member in best.members for unknown in member.unknowns]
    # Nothing is named: the study gets the heat of unknown origin that is more than two sd from none.
    heat = patches(residuals.study, residuals.settings)
    lacking = [patch for patch in heat if abs(missing.values.get(patch, 0.0)) > 2 * missing.sd.get(patch, 1.0)]
    values = {unknown: x for unknown, x in missing.values.items() if unknown in lacking or unknown not in heat}
    return values, missing.sd, lacking


def _after(
    residuals: Residuals, evaluations: Evaluations, change: tuple[Change, ...] | None, values: Mapping[Unknown, float]
) -> dict[int, Any]:
    """Block means of every trial with the changes, on the study's own mesh; as fitted, if there are None."""
    numbers = range(len(residuals.trials))
    if change is None:
        answers = evaluations.of("predict", [(number, values) for number in numbers])
        return {number: residuals.corrected(number, answer) for number, answer in enumerate(answers)}
    driven = [amended(residuals.driven(number), change) for number in numbers]
    return dict(enumerate(evaluations.of("full", list(enumerate(driven)))))
