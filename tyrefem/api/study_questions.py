"""Questions to a study: deviation from measurements, missing effects, next runs, variants."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.api.verbs import given, with_verbs
from tyrefem.inputs import study as studies

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from tyrefem.api.comparison import Comparison
    from tyrefem.api.design import Design
    from tyrefem.api.diagnosis import Diagnosis, ExperimentPlan
    from tyrefem.api.exploration import Exploration
    from tyrefem.compare.interface import ResultLike
    from tyrefem.compare.reduced_inputs import ReducedInputSettings
    from tyrefem.diagnose.fitting.criterion import Criterion
    from tyrefem.diagnose.fitting.selection import Strategy
    from tyrefem.diagnose.forward.drive_response import DriveResponse
    from tyrefem.diagnose.forward.evaluations import ProgressStore
    from tyrefem.diagnose.forward.worker_queues import Workers
    from tyrefem.diagnose.settings import DiagnosisSettings
    from tyrefem.diagnose.unknowns.candidates import CandidateSpace
    from tyrefem.variants.answer_store import AnswerStore
    from tyrefem.variants.execution import Scheduler, SweepSettings

#: Called with a description, the number of the step, and the number of steps.
Progress = Callable[[str, int, int], None]


class StudyQuestions(studies.StudyData):
    """A study's methods for measurements and variants."""

    def compare(
        self,
        table: Any = None,
        result: ResultLike | None = None,
        *,
        inputs: bool = True,
        ignore: Iterable[str] = (),
        rename: Mapping[str, str] | None = None,
        k: float = 2.0,
        executor: Executor | None = None,
        progress: Callable[[int, int], object] | None = None,
        reduced: str = "auto",
        store: AnswerStore | None = None,
        begin: Callable[[str], object] | None = None,
        settings: ReducedInputSettings | None = None,
    ) -> Comparison:
        """Deviation from measured tables: ``table``, or the study's tables.

        Parameters
        ----------
        table : CSV file or workbook, pandas table, or a list of these; None: the study's ``[[measured]]`` entries.
        result : the study's result, if it is known.
        inputs : also runs with each uncertain number one standard deviation higher. k : coverage factor, 2 for 95 %.
        ignore : columns to leave out. rename : column -> sensor.
        reduced : "auto": a reduced model, confirmed by full runs, for many changed inputs; "never": full runs only.
        executor, store, settings : how the simulations run. progress, begin : functions that are called meanwhile.

        All of them, and the errors: `tyrefem.compare.compare`.
        """
        from tyrefem.api.comparison import Comparison
        from tyrefem.compare import compare

        options = given(settings=settings)
        data = compare(
            self, table, result, inputs=inputs, ignore=ignore, rename=rename, k=k, executor=executor, progress=progress,
            reduced=reduced, store=store, begin=begin, **options,
        )  # fmt: skip
        return with_verbs(Comparison, data, original=self)

    def diagnose(
        self,
        table: Any = None,
        *,
        ignore: Iterable[str] = (),
        rename: Mapping[str, str] | None = None,
        largest: int | None = None,
        looks: int | None = None,
        reduced: str | None = None,
        settings: DiagnosisSettings | None = None,
        candidates: CandidateSpace | None = None,
        criterion: Criterion | None = None,
        strategy: Strategy | None = None,
        workers: Workers = 1,
        progress: Progress | None = None,
        known: Sequence[DriveResponse] | None = None,
        rerun: bool = True,
        verdict_only: bool = False,
        store: ProgressStore | None = None,
        effects: str | Path | None = None,
        calibration: str | Path | None = None,
    ) -> Diagnosis:
        """Effects that the model lacks, inferred from measured tables: ``table``, or the study's tables.

        Parameters
        ----------
        table, ignore, rename : as in `compare`.
        largest : most effects in a set. looks : most diagnoses, each of the study amended by the one before.
        reduced : "auto" or "never" for certified reduced models in the fits. settings : all numerical parameters.
        candidates, criterion, strategy : which effects, judged how, searched how.
        workers : processes. rerun : run the amended study at the end. verdict_only : leave out what follows it.
        effects : folder with further effects. calibration : of ``tyrefem isolability --calibrate``.
        known, store : simulations already done. progress : called at every step.

        All of them, and the errors: `tyrefem.diagnose.diagnose`.
        """
        from tyrefem.api.diagnosis import Diagnosis
        from tyrefem.diagnose import diagnose

        options = given(
            largest=largest, looks=looks, reduced=reduced, settings=settings, candidates=candidates,
            criterion=criterion, strategy=strategy,
        )  # fmt: skip
        data = diagnose(
            self, table, ignore=ignore, rename=rename, workers=workers, progress=progress, known=known, rerun=rerun,
            verdict_only=verdict_only, store=store, effects=effects, calibration=calibration, **options,
        )  # fmt: skip
        return Diagnosis.of(data)

    def plan(
        self,
        after: Any = None,
        *,
        workers: int = 1,
        progress: Progress | None = None,
        store: ProgressStore | None = None,
        settings: DiagnosisSettings | None = None,
        known: Sequence[DriveResponse] | None = None,
        ignore: Iterable[str] | None = None,
        rename: Mapping[str, str] | None = None,
        largest: int | None = None,
        looks: int | None = None,
        reduced: str | None = None,
        candidates: CandidateSpace | None = None,
        criterion: Criterion | None = None,
        strategy: Strategy | None = None,
        rerun: bool | None = None,
        verdict_only: bool | None = None,
        effects: str | Path | None = None,
        calibration: str | Path | None = None,
    ) -> ExperimentPlan:
        """The next runs and sensors that are expected to tell the remaining effects apart, by gain per cost.

        Parameters
        ----------
        after : None before a test; else a `Diagnosis`, the folder of one, or measured tables.
        workers, progress, store, settings, known : see `tyrefem.plan.workflow.plan`.
        ignore and all further : as in `diagnose`, for tables.
        """
        from tyrefem.api.diagnosis import ExperimentPlan
        from tyrefem.plan.workflow import plan

        options = given(
            ignore=ignore, rename=rename, largest=largest, looks=looks, reduced=reduced, candidates=candidates,
            criterion=criterion, strategy=strategy, rerun=rerun, verdict_only=verdict_only, effects=effects,
            calibration=calibration,
        )  # fmt: skip
        data = plan(
            self, after, workers=workers, progress=progress, store=store, settings=settings, known=known, **options
        )
        return with_verbs(ExperimentPlan, data, original=self)

    def sweep(
        self,
        vary: Mapping[str, Any] | None = None,
        *,
        link: Mapping[str, Sequence[str]] | None = None,
        sample: str | None = None,
        count: int | None = None,
        seed: int | None = None,
        cases: Any = None,
        case: str | None = None,
        change: Mapping[str, Any] | None = None,
        uncertain: float | None = None,
        limits: Mapping[str, Any] | None = None,
        time_to: Any = None,
        answers: Sequence[str] | None = None,
        pareto: Mapping[str, str] | None = None,
        tornado: Mapping[str, Any] | None = None,
        optimise: Mapping[str, Any] | None = None,
        envelope: Mapping[str, Any] | None = None,
        title: str | None = None,
        scheduler: Scheduler | None = None,
        folder: str | Path | None = None,
        restart: bool = False,
        reduced: str = "auto",
        tolerance: float | None = None,
        progress: Progress | None = None,
        settings: SweepSettings | None = None,
        **further: Any,
    ) -> Design:
        """Compute many variants: response, Pareto front, tornado, Sobol indices, optimum, envelope.

        Parameters
        ----------
        vary : dotted name -> tuple (from, to) or (from, to, levels), list of values, or entry of a sweep file.
        link : name -> dotted names that vary together under this name: ``{"gauges": ["section.thickness_scale.*"]}``.
        sample : grid (default), latin-hypercube, sobol, saltelli or list, with ``count``, ``seed`` or ``cases``.
        case : of a campaign. title : of the page.
        change : values changed in every variant.
        uncertain : also vary all uncertain numbers, within so many standard deviations.
        limits : answer -> its limits. time_to : temperature whose time is an answer. answers : in tables and pictures.
        pareto : answer -> "min" or "max". tornado, optimise, envelope : further questions, as in a sweep file.
        scheduler : where the variants run. folder : keeps finished variants; ``restart`` deletes them first.
        reduced : "auto", "never" or "always" for a certified reduced model. tolerance : K, of its certificate; None:
            0.01. settings : see `tyrefem.variants.execution.SweepSettings`.
        progress : called with (stage, finished, total).
        further : tables of other questions, by their names.

        Ctrl-C ends the sweep with what is finished; ``interrupted`` of the design says so.

        The keys of a sweep file: docs/sweeps.md.

        >>> from tyrefem import study
        >>> coarse = study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.duration": "60 s"})
        >>> design = coarse.sweep({"drive.speed": ["10 mph", "20 mph"]}, limits={"hottest_degC": {"below": 35}})
        >>> design.table["feasible"].tolist()
        [True, False]
        """
        from tyrefem.api.design import Design
        from tyrefem.sweep.design import run_design_study

        questions = given(
            link=link, sample=sample, count=count, seed=seed, cases=cases, case=case, change=change,
            uncertain=uncertain, limits=limits, time_to=time_to, answers=answers, pareto=pareto, tornado=tornado,
            optimise=optimise, envelope=envelope, title=title,
        )  # fmt: skip
        execution = given(
            scheduler=scheduler, folder=folder, restart=restart, reduced=reduced, tolerance=tolerance,
            progress=progress, settings=settings,
        )  # fmt: skip
        return with_verbs(Design, run_design_study(self, vary, **questions, **execution, **further))

    def explore(
        self,
        vary: Mapping[str, Any] | None = None,
        *,
        limits: Mapping[str, Any] | None = None,
        axes: tuple[str, str] | None = None,
        tolerance: float | None = None,
        scheduler: Scheduler | None = None,
        progress: Progress | None = None,
    ) -> Exploration:
        """A page with sliders whose temperatures are computed in the browser, from a certified reduced model.

        Parameters
        ----------
        vary : dotted name -> range, as in `sweep`; None: the study's ``[explore]``, else a box about its drive, rubbers
            and films. limits : answer -> below, above. axes : the two numbers of the safe envelope.
        tolerance : K, of every temperature in the certificate; None: the study's, else 0.3, with strain by finite
            elements 1. scheduler : where the runs are done.
        progress : called with (stage, finished, total).

        >>> from tyrefem import study
        >>> coarse = study("nasa-22x5.5-8pr", {"mesh.size": "14 mm", "mesh.through": 1, "drive.duration": "60 s"})
        >>> page = coarse.explore({"drive.speed": ("15 mph", "20 mph")}, tolerance=1.0)
        >>> page.certificate.worst < 1.0
        True
        """
        from tyrefem.api.exploration import Exploration
        from tyrefem.realtime.box_model import explored

        data = explored(
            self, vary, limits=limits, axes=axes, tolerance=tolerance, scheduler=scheduler, progress=progress
        )
        return with_verbs(Exploration, data)
