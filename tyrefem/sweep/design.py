"""A design study: everything that a sweep file asks of a study, checked before anything runs, and the answers.

What a sweep file asks of a study, checked before anything runs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from tyrefem.brief import Brief
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.study import StudyData
from tyrefem.requirements import Requirements
from tyrefem.sweep.envelope import Envelope
from tyrefem.sweep.optimum import Optimum, optimum
from tyrefem.sweep.pareto import ParetoFront
from tyrefem.sweep.part import DesignPart
from tyrefem.sweep.question import SweepQuestion, further_apart, questions_of, sweep_questions
from tyrefem.sweep.responses import Responses, judged
from tyrefem.sweep.sobol_indices import Indices
from tyrefem.sweep.sweep import Sweep, sweep
from tyrefem.sweep.tornado import Tornado
from tyrefem.variants.answers import check_answer
from tyrefem.variants.card import SweepCard
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
    study, card : what was asked. swept : the variants of the sample; None: none were asked for.
    optimum : the answer, else None. answers : key of a question -> its answer. interrupted : why some were not
        reached; empty: none.
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
        sentences = {part.name: next(iter(part.words), "nothing to tell") for part in self.parts}
        return {**swept, **sentences, **({"interrupted": self.interrupted} if self.interrupted else {})}

    @property
    def parts(self) -> tuple[DesignPart, ...]:
        """All answers, in the order in which they are told."""
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
        """Which tolerance matters, if asked for."""
        answer = self.answers.get(Tornado.name)
        return answer if isinstance(answer, Tornado) else None

    @property
    def envelope(self) -> Envelope | None:
        """The safe operating envelope, if asked for."""
        answer = self.answers.get(Envelope.name)
        return answer if isinstance(answer, Envelope) else None

    @property
    def table(self) -> pd.DataFrame:
        """A row per variant: see `Sweep.table`; without a sample those that the optimiser evaluated."""
        if self.swept is not None:
            return self.swept.table
        if self.optimum is not None:
            return self.optimum.table
        raise InputError("no variants were asked for")

    @property
    def pareto(self) -> pd.DataFrame:
        """The variants that no other beats: see `tyrefem.sweep.pareto.front`."""
        from tyrefem.sweep.pareto import front

        return front(self.table, dict(self.card.pareto))

    @property
    def indices(self) -> Indices | None:
        """Sobol indices, of a Saltelli sample."""
        if self.swept is None or self.swept.plan.how.get("sample") != "saltelli" or not self.swept.complete:
            return None
        return Indices(self.swept, tuple(judged(self.swept, self.card.answers)))

    @property
    def failed(self) -> dict[str, str]:
        """Variant -> why it has no answers."""
        return {} if self.swept is None else self.swept.failed

    @property
    def words(self) -> list[str]:
        """All answers in sentences."""
        return [line for part in self.parts for line in part.words]


#: What a sweep needs of a study.
NEEDS = Requirements("a sweep")


@dataclass(frozen=True, eq=False)
class Questions:
    """What a sweep file asks of a study; all of it makes sense.

    Parameters
    ----------
    plan : the variants of the sample, maybe none, with what varies. further : questions with a table of their own.
    """

    study: StudyData
    card: SweepCard
    plan: Plan
    further: tuple[SweepQuestion, ...] = ()

    @property
    def words(self) -> str:
        """One line of what would be run."""
        parts = [f"{len(self.plan.variants)} variants"] if self.card.sampled else []
        if self.card.optimise is not None:
            parts.append(f"an optimum of {self.card.optimise.answer} by {self.card.optimise.runs} variants at most")
        parts += [question.words for question in self.further]
        return f"{', '.join(parts)}; study {self.study.name}"

    def answered(self, how: Execution | None = None, **options: Unpack[ExecutionOptions]) -> DesignData:
        """Run what is needed; parameters as of `tyrefem.sweep.sweep.sweep`. Ctrl-C keeps what is finished.

        A `Local` scheduler used as a context manager keeps its processes from one question to the next.
        """
        card, how = self.card, (how or Execution()).given(options)
        swept = best = None
        answers: dict[str, DesignPart] = {}
        interrupted = ""
        try:
            if card.sampled:
                swept = sweep(self.plan, how)
                interrupted = swept.interrupted
            if card.optimise is not None and not interrupted:
                best = optimum(self.plan, card.optimise, how.within(Optimum.name), known=swept)
            for question in self.further:
                if not interrupted:
                    answers[question.key] = question.answered(how.within(question.key))
                    interrupted = getattr(answers[question.key], "interrupted", "")
        except KeyboardInterrupt:
            interrupted = "interrupted"
        except ClusterLostError as error:
            interrupted = str(error)
        return DesignData(self.study, card, swept, best, answers, interrupted)


def questions(study: StudyData, card: SweepCard, near: Path | None = None) -> Questions:
    """What a sweep file asks, or the first thing that makes no sense.

    Raises
    ------
    InputError : a campaign; a name, value or answer that the study does not have; two variants that are the same.
    """
    NEEDS.check(study)
    plan = planned(study, card, near)
    if card.optimise is not None:
        if not plan.varied:
            raise InputError("searches within [vary], and a list has none: its best are on the front", field="optimise")
        try:
            check_answer(card.optimise.answer, study, card.time_to)
        except InputError as error:
            raise error.within(field="optimise") from None
    return Questions(study, card, plan, questions_of(study, card))


def asked_of(study: StudyData, vary: Mapping[str, Any] | None = None, **options: Any) -> DesignData:
    """The answers to what `card_of` takes, carried out as `Execution` says: `Study.sweep`.

    Raises
    ------
    InputError : a name that is neither a key of a sweep file nor a field of `Execution`; as of `questions`.
    """
    known = [each.name for each in fields(Execution)]
    allowed = [*known, *SweepCard.model_fields, *sweep_questions()]
    for name in options:
        if name not in allowed:
            raise InputError(f"nothing is called '{name}' here{nearest(name, allowed)}", field="sweep")
    run = {name: options.pop(name) for name in known if name in options}
    if isinstance(run.get("folder"), str):
        run["folder"] = Path(run["folder"])
    how = Execution(**run)
    if options.get("case") is not None:
        study = study.case(options["case"])
    return questions(study, card_of(study, vary, **further_apart(options))).answered(how)


def loaded(name: str, changes: Mapping[str, Any] | None = None, **options: Any) -> Questions:
    """The questions of a sweep file by name or path, the study's values changed by dotted names.

    ``said``: keys of the file said otherwise; tables (``vary``, ``limits``) are laid over the file's.

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
    card = SweepCard.check(further_apart(data), path)
    try:
        return questions(card.load_study(path.parent, changes), card, path.parent)
    except InputError as error:
        raise error if error.file else error.within(file=path) from None
