"""A design study: everything that a sweep file asks of a study, checked before anything runs, and the answers.

What a sweep file asks of a study, checked before anything runs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from tyrefem.brief import Brief
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.study import StudyData
from tyrefem.requirements import Requirements
from tyrefem.sweep.envelope import Envelope, checked_pairs, envelope
from tyrefem.sweep.optimum import Optimum, optimum
from tyrefem.sweep.pareto import ParetoFront
from tyrefem.sweep.part import DesignPart
from tyrefem.sweep.responses import Responses, judged
from tyrefem.sweep.sobol_indices import Indices
from tyrefem.sweep.sweep import Sweep, sweep
from tyrefem.sweep.tornado import Tornado, tornado_plan
from tyrefem.variants.answers import check_answer
from tyrefem.variants.card import SweepCard
from tyrefem.variants.dask_cluster import ClusterLostError
from tyrefem.variants.execution import Execution, Said
from tyrefem.variants.plan import Plan, card_of, planned

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class DesignData(Brief):
    """The answers to a design study.

    Parameters
    ----------
    study, card : what was asked. swept : the variants of the sample; None: none were asked for.
    tornado, optimum, envelope : the answers asked for, else None. interrupted : why some were not reached; empty: none.
    """

    study: StudyData
    card: SweepCard
    swept: Sweep | None
    tornado: Tornado | None = None
    optimum: Optimum | None = None
    envelope: Envelope | None = None
    interrupted: str = ""

    def _title(self) -> str:
        return f"of {self.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        swept = {} if self.swept is None else self.swept._facts()
        told = {part.name: next(iter(part.words), "nothing to tell") for part in self.parts}
        return {**swept, **told, **({"interrupted": self.interrupted} if self.interrupted else {})}

    @property
    def parts(self) -> tuple[DesignPart, ...]:
        """All answers, in the order in which they are told."""
        found: list[DesignPart] = []
        if self.optimum is not None:
            found.append(self.optimum)
        if self.swept is not None and self.swept.outcomes:
            found.append(Responses(self.swept, self.card.answers))
            found.append(ParetoFront(self.swept, dict(self.card.pareto)))
        found += [one for one in (self.indices, self.tornado, self.envelope) if one is not None]
        return tuple(found)

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
    plan : the variants of the sample, maybe none, with what varies. tornado : variants of the tolerances.
    """

    study: StudyData
    card: SweepCard
    plan: Plan
    tornado: Plan | None

    @property
    def words(self) -> str:
        """One line of what would be run."""
        parts = [f"{len(self.plan.variants)} variants"] if self.card.sampled else []
        if self.card.optimise is not None:
            parts.append(f"an optimum of {self.card.optimise.answer} by {self.card.optimise.runs} variants at most")
        if self.tornado is not None:
            parts.append(f"a tornado of {(len(self.tornado.variants) - 1) // 2} tolerances")
        if self.card.envelope is not None:
            parts.append(f"an envelope of {len(checked_pairs(self.study, self.card.envelope))} loads and pressures")
        return f"{', '.join(parts)}; study {self.study.name}"

    def answered(self, how: Execution | None = None, **said: Unpack[Said]) -> DesignData:
        """Run what is needed; parameters as of `tyrefem.sweep.sweep.sweep`. Ctrl-C keeps what is finished.

        A `Local` scheduler used as a context manager keeps its processes from one question to the next.
        """
        card, how = self.card, (how or Execution()).given(said)
        swept = tornado = best = safe = None
        interrupted = ""
        try:
            if card.sampled:
                swept = sweep(self.plan, how)
                interrupted = swept.interrupted
            if self.tornado is not None and not interrupted:
                moved = sweep(self.tornado, how.within(Tornado.name), reduced="never")
                answers = card.answers or tuple(judged(moved)) or ("hottest_degC",)
                tornado, interrupted = Tornado(moved, answers), moved.interrupted
            if card.optimise is not None and not interrupted:
                best = optimum(self.plan, card.optimise, how.within(Optimum.name), known=swept)
            if card.envelope is not None and not interrupted:
                safe = envelope(self.study, card.envelope, how.within(Envelope.name))
        except KeyboardInterrupt:
            interrupted = "interrupted"
        except ClusterLostError as error:
            interrupted = str(error)
        return DesignData(self.study, card, swept, tornado, best, safe, interrupted)


def questions(study: StudyData, card: SweepCard, near: Path | None = None) -> Questions:
    """What a sweep file asks, or the first thing that makes no sense.

    Raises
    ------
    InputError : a campaign; a name, value or answer that the study does not have; two variants that are the same.
    """
    NEEDS.check(study)
    plan = planned(study, card, near)
    try:
        tornado = None if card.tornado is None else tornado_plan(study, card.tornado.tolerances, card.time_to)
    except InputError as error:
        raise error if error.file else error.within(field="tornado") from None
    if card.optimise is not None:
        if not plan.varied:
            raise InputError("searches within [vary], and a list has none: its best are on the front", field="optimise")
        try:
            check_answer(card.optimise.answer, study, card.time_to)
        except InputError as error:
            raise error.within(field="optimise") from None
    if card.envelope is not None:
        checked_pairs(study, card.envelope)
    return Questions(study, card, plan, tornado)


def asked_of(study: StudyData, vary: Mapping[str, Any] | None = None, **options: Any) -> DesignData:
    """The answers to what `card_of` takes, carried out as `Execution` says: `Study.sweep`.

    Raises
    ------
    InputError : a name that is neither a key of a sweep file nor a field of `Execution`; as of `questions`.
    """
    known = [field.name for field in fields(Execution)]
    allowed = [*known, *SweepCard.model_fields]
    for name in options:
        if name not in allowed:
            raise InputError(f"nothing is called '{name}' here{nearest(name, allowed)}", field="sweep")
    run = {name: options.pop(name) for name in known if name in options}
    if isinstance(run.get("folder"), str):
        run["folder"] = Path(run["folder"])
    how = Execution(**run)
    if options.get("case") is not None:
        study = study.case(options["case"])
    return questions(study, card_of(study, vary, **options)).answered(how)


def loaded(name: str, changes: Mapping[str, Any] | None = None, **said: Any) -> Questions:
    """The questions of a sweep file by name or path, the study's values changed by dotted names.

    ``said``: keys of the file said otherwise; tables (``vary``, ``limits``) are laid over the file's.

    >>> loaded("crown-angle").words
    '100 variants, an optimum of mass_kg by 160 variants at most; study nasa-22x5.5-8pr'
    """
    from tyrefem import library
    from tyrefem.cards import read_toml

    path = library.find("sweep", name)
    data = read_toml(path)
    for key, value in said.items():
        both = isinstance(value, Mapping) and isinstance(data.get(key), Mapping)
        data[key] = {**data[key], **value} if both else value
    card = SweepCard.check(data, path)
    try:
        return questions(card.load_study(path.parent, changes), card, path.parent)
    except InputError as error:
        raise error if error.file else error.within(file=path) from None
