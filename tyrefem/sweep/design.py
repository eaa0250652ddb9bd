"""A design study: the questions of a sweep file, checked before anything runs, and their answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from tyrefem.brief import Brief, counted
from tyrefem.errors import InputError, InputWarning, nearest
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.cautions import warnings_of
from tyrefem.output import as_path
from tyrefem.requirements import Requirements
from tyrefem.sweep.envelope import Envelope
from tyrefem.sweep.optimum import Optimum, optimum
from tyrefem.sweep.pareto import ParetoFront
from tyrefem.sweep.part import DesignPart
from tyrefem.sweep.question import SweepQuestion, questions_of, sweep_questions, with_further_tables
from tyrefem.sweep.responses import Responses, judged
from tyrefem.sweep.sample_answer import SampleAnswer
from tyrefem.sweep.sobol_indices import Indices
from tyrefem.sweep.sweep import Sweep, sweep
from tyrefem.sweep.tornado import Tornado
from tyrefem.variants.answers import check_answer
from tyrefem.variants.card import SweepCard, flat
from tyrefem.variants.dask_cluster import ClusterLostError
from tyrefem.variants.execution import Execution, ExecutionOptions
from tyrefem.variants.plan import Plan, card_of, planned

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class DesignData(Brief):
    """The answers to a design study.

    Parameters
    ----------
    study, card : the study and its sweep file. swept : the variants of the sample; None: no sample.
    optimum : result of the search, or None. answers : key of a question -> its answer. interrupted : why the study
        is incomplete; empty: it is complete.
    """

    study: StudyData
    card: SweepCard
    swept: Sweep | None
    optimum: Optimum | None = None
    answers: Mapping[str, DesignPart] = field(default_factory=dict)
    interrupted: str = ""

    def _title(self) -> str:
        return f"of {self.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        swept = {} if self.swept is None else self.swept._facts()
        sentences = {part.name: next(iter(part.words), "no statement") for part in self.parts}
        return {**swept, **sentences, **({"interrupted": self.interrupted} if self.interrupted else {})}

    @property
    def parts(self) -> tuple[DesignPart, ...]:
        """All answers, in the order of the report."""
        parts: list[DesignPart] = []
        if self.optimum is not None:
            parts.append(self.optimum)
        if self.swept is not None and self.swept.outcomes:
            parts.append(Responses(self.swept, self.card.answers))
            parts.append(ParetoFront(self.swept, dict(self.card.pareto)))
        parts += [] if self.indices is None else [self.indices]
        return (*parts, *self.answers.values())

    @property
    def tornado(self) -> Tornado | None:
        """The effects of the tolerances; None: not in the sweep file."""
        answer = self.answers.get(Tornado.name)
        return answer if isinstance(answer, Tornado) else None

    @property
    def envelope(self) -> Envelope | None:
        """The safe operating envelope; None: not in the sweep file."""
        answer = self.answers.get(Envelope.name)
        return answer if isinstance(answer, Envelope) else None

    @property
    def table(self) -> pd.DataFrame:
        """A row per variant, see `Sweep.table`; without a sample the variants of the search."""
        if self.swept is not None:
            return self.swept.table
        if self.optimum is not None:
            return self.optimum.table
        raise InputError("the sweep file has neither a sample nor [optimise]: there is no table of variants")

    def variant_study(self, variant: str | int) -> StudyData:
        """The study of a variant of the sample, by its name in the table; the title says what it changes.

        Raises
        ------
        InputError : no sample, or no variant of that name.
        """
        if self.swept is None:
            raise InputError("the sweep has no sample, so no variants by name", field="variant")
        plan, name = self.swept.plan, str(variant)
        if name not in plan.names:
            raise InputError(f"no variant '{name}'{nearest(name, plan.names)}", field="variant")
        number = plan.names.index(name)
        values = ", ".join(f"{key} {value}" for key, value in plan.settings(number).items())
        study = plan.study.replace(plan.variants[number])
        return study.replace({"title": f"{study.title}; variant {name}: {values}"})

    @property
    def pareto(self) -> pd.DataFrame:
        """The variants on the Pareto front, see `tyrefem.sweep.pareto.front`."""
        from tyrefem.sweep.pareto import front

        if self.swept is not None and self.swept.outcomes:
            return ParetoFront(self.swept, dict(self.card.pareto)).table
        return front(self.table, dict(self.card.pareto))

    @property
    def indices(self) -> Indices | None:
        """Sobol indices; None without a complete Saltelli sample."""
        if self.swept is None or self.swept.plan.sampling.get("sample") != "saltelli" or not self.swept.complete:
            return None
        return Indices(self.swept, tuple(judged(self.swept, self.card.answers)))

    @property
    def failed(self) -> dict[str, str]:
        """Variant -> reason of its failure."""
        return {} if self.swept is None else self.swept.failed

    @property
    def failures(self) -> dict[str, str]:
        """Every run that failed -> reason: a variant of the sample by its name, others behind their answer's name."""
        reasons = dict(self.failed)
        for part in self.parts:
            of_part = getattr(part, "failed", None)
            if isinstance(of_part, Mapping):
                reasons |= {f"{part.name}: {name}": str(reason) for name, reason in of_part.items()}
        return reasons

    @property
    def words(self) -> list[str]:
        """All answers in sentences."""
        return [line for part in self.parts for line in part.words]


#: Requirements of a sweep on a study.
NEEDS = Requirements("a sweep")


@dataclass(frozen=True, eq=False)
class Questions:
    """The checked questions of a sweep file about a study.

    Parameters
    ----------
    plan : varied numbers and the variants of the sample, possibly none. further : questions with separate tables.
    """

    study: StudyData
    card: SweepCard
    plan: Plan
    further: tuple[SweepQuestion, ...] = ()

    @property
    def warnings(self) -> tuple[InputWarning, ...]:
        """Warnings of unusual input in the study, and in its variants at the ends of what varies."""
        return (*warnings_of(self.study), *self.plan.warnings)

    @property
    def words(self) -> str:
        """A line that describes the planned work."""
        parts = [counted(len(self.plan.variants), "variant")] if self.card.sampled else []
        if self.card.optimise is not None:
            parts.append(f"an optimum of {self.card.optimise.answer} by {self.card.optimise.runs} variants at most")
        parts += [question.words for question in self.further]
        return f"{', '.join(parts)}; study {self.study.name}"

    def answered(self, execution: Execution | None = None, **options: Unpack[ExecutionOptions]) -> DesignData:
        """Run the variants and answer the questions; parameters as in `tyrefem.sweep.sweep.sweep`.

        Ctrl-C keeps the finished variants. A `Local` scheduler used as a context manager keeps its processes.
        """
        card, execution = self.card, (execution or Execution()).given(options)
        swept = best = None
        answers: dict[str, Any] = {}
        interrupted = ""
        try:
            if card.sampled:
                swept = sweep(self.plan, execution)
                interrupted = swept.interrupted
            if card.optimise is not None and not interrupted:
                best = optimum(self.plan, card.optimise, execution.within(Optimum.name), known=swept)
            for question in self.further:
                if isinstance(question, SampleAnswer):
                    if swept is not None and swept.outcomes:
                        answers[question.key] = question.of(swept)
                elif not interrupted:
                    answers[question.key] = question.answered(execution.within(question.key))
                    interrupted = getattr(answers[question.key], "interrupted", "")
        except KeyboardInterrupt:
            interrupted = "interrupted"
        except ClusterLostError as error:
            interrupted = str(error)
        return DesignData(self.study, card, swept, best, answers, interrupted)


def questions(study: StudyData, card: SweepCard, near: Path | None = None) -> Questions:
    """The checked questions of a sweep file about a study.

    Raises
    ------
    InputError : the study is a campaign, has no such name, value or answer, or two variants are equal.
    """
    NEEDS.check(study)
    plan = planned(study, card, near)
    if card.optimise is not None:
        if not plan.varied:
            raise InputError(
                "needs [vary]; a list of variants has none: its best variants are on the Pareto front",
                field="optimise",
            )
        try:
            check_answer(card.optimise.answer, study, card.time_to)
        except InputError as error:
            raise error.within(field="optimise") from None
    return Questions(study, card, plan, questions_of(study, card))


def run_design_study(study: StudyData, vary: Mapping[str, Any] | None = None, **options: Any) -> DesignData:
    """Run a design study from Python values, for `Study.sweep`.

    Parameters
    ----------
    vary, options : as in `card_of`; ``options`` may also have the fields of `Execution`.

    Raises
    ------
    InputError : an option is neither a key of a sweep file nor a field of `Execution`; errors of `questions`.
    """
    known = [each.name for each in fields(Execution)]
    allowed = {*known, *SweepCard.model_fields, *sweep_questions()}
    for name in options:
        if name not in allowed:
            raise InputError(f"unknown option '{name}'{nearest(name, allowed)}", field="sweep")
    run = {name: options.pop(name) for name in known if name in options}
    if run.get("folder") is not None:
        run["folder"] = as_path(run["folder"], "folder")
    execution = Execution(**run)
    if options.get("case") is not None:
        study = study.case(options["case"])
    card = card_of(study, vary, **with_further_tables(options))
    return questions(study.replace(card.change) if card.change else study, card).answered(execution)


def loaded(name: str, changes: Mapping[str, Any] | None = None, **options: Any) -> Questions:
    """The questions of a sweep file, by name or path.

    Parameters
    ----------
    changes : dotted name -> value, changes of the study. options : keys that replace those of the file; tables
        (``vary``, ``limits``) are merged with the file's.

    >>> loaded("crown-angle").words
    '100 variants, an optimum of mass_kg by 160 variants at most; study nasa-22x5.5-8pr'
    """
    from tyrefem import library
    from tyrefem.cards import read_toml

    path = library.find("sweep", name)
    data = read_toml(path)
    for key, value in options.items():
        both = isinstance(value, Mapping) and isinstance(data.get(key), Mapping)
        data[key] = {**data[key], **value} if both else value
    if {"sample", "optimise"} & set(options):
        data = _of_other_sample(data, options)
    card = SweepCard.check(with_further_tables(data), path)
    try:
        return questions(card.load_study(path.parent, changes), card, path.parent)
    except InputError as error:
        raise error if error.file else error.within(file=path) from None


def _of_other_sample(data: dict[str, Any], options: Mapping[str, Any]) -> dict[str, Any]:
    """A sweep file's data without what belongs to the file's sample alone, where ``options`` give another.

    Levels belong to a grid, number and seed to a random sample.
    """
    kept = dict(data)
    chosen = kept.get("sample") or ("grid" if "optimise" not in kept else None)
    if chosen in ("grid", "list"):
        for key in ("count", "seed"):
            if key not in options:
                kept.pop(key, None)
    if chosen != "grid" and isinstance(kept.get("vary"), Mapping):
        given = options.get("vary") or {}
        kept["vary"] = {
            key: {part: value for part, value in entry.items() if part != "levels"}
            if key not in given and isinstance(entry, Mapping)
            else entry
            for key, entry in flat(dict(kept["vary"])).items()
        }
    return kept
