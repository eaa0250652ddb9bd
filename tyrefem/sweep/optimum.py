"""The best variant: the smallest or largest answer within what varies, under limits."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import NDArray

from tyrefem.sweep.answer_words import difference_unit, name_of, shown
from tyrefem.sweep.answers import check_answer
from tyrefem.sweep.asked import Asked
from tyrefem.sweep.card import LimitCard, OptimiseCard
from tyrefem.sweep.execution import Execution, Said
from tyrefem.sweep.plan import Plan
from tyrefem.sweep.samples import grid
from tyrefem.sweep.search import best_known, evolve, objective, violation
from tyrefem.sweep.sweep import Sweep

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
Outcome = Mapping[str, Any]
#: Candidates that are run in full, in the order of what they promise, until one keeps the limits.
CANDIDATES = 5


@dataclass(frozen=True, eq=False)
class Optimum:
    """What a search found.

    Parameters
    ----------
    swept : every evaluated variant, in the order of the search. card : what was asked.
    best : number of the best variant that keeps the limits; None: none does. full : its answers by a full run.
    nominal : outcome of the study as it is. exhaustive : every combination was tried. ended : why the search ended.
    """

    swept: Sweep
    card: OptimiseCard
    best: int | None
    full: Mapping[str, Any]
    nominal: Outcome
    exhaustive: bool
    ended: str

    name = "optimum"
    heading = "Optimum"

    @property
    def answer(self) -> str:
        """What was minimised or maximised."""
        return self.card.answer

    @functools.cached_property
    def table(self) -> pd.DataFrame:
        """Every evaluated variant, as `Sweep.table`, with ``best_so_far`` of those that keep the limits."""
        table = self.swept.table
        if self.answer not in table:
            return table.assign(best_so_far=np.nan)
        values = table[self.answer].where(table["feasible"])
        return table.assign(best_so_far=(values.cummin() if self.card.minimise else values.cummax()).ffill())

    @property
    def changes(self) -> dict[str, Any]:
        """What to change in the study to get the best variant."""
        return {} if self.best is None else dict(self.swept.plan.variants[self.best])

    @property
    def where(self) -> str:
        """`changes` to four digits, for people."""
        return ", ".join(f"{key} = {_brief(value)}" for key, value in self.changes.items())

    @property
    def words(self) -> list[str]:
        """The answer in sentences."""
        plan, limits = self.swept.plan, words_of(self.swept.plan.limits)
        asked = (
            f"{'Smallest' if self.card.minimise else 'Largest'} {name_of(self.answer)}{limits and f' with {limits}'}"
        )
        failed = sum("failure" in one for one in self.swept.outcomes.values())
        tried = f"{len(self.swept.outcomes)} different variants evaluated" + (f", {failed} failed" if failed else "")
        if self.best is None:
            return [f"{asked}: no variant keeps the limits ({tried})."]
        told = [f"{asked}: {shown(self.answer, self.full[self.answer])} at {self.where}, by a full run."]
        others = [name for name in plan.limits if name != self.answer]
        if others:
            values = ", ".join(f"{name_of(name)} {shown(name, self.full[name])}" for name in others)
            told.append(f"There: {values}.")
        if "answers" in self.nominal:
            before = float(self.nominal["answers"][self.answer])
            gained = f"{self.full[self.answer] - before:+.3g} {difference_unit(self.answer)}".strip()
            broken = violation(self.nominal, plan.limits) > 0
            breaks = " but breaks a limit" if broken else ""
            told.append(f"The study as it is has {shown(self.answer, before)}{breaks}: {gained} by the optimum.")
        told.append(f"{tried}; {'every combination was tried' if self.exhaustive else self.ended}.")
        certificate = self.swept.certificate
        if certificate is not None:
            stated = certificate.errors.get(self.answer)
            error = "" if stated is None else f"; {name_of(self.answer)} to ±{shown(self.answer, stated, 2)}"
            told.append(f"The search used a reduced model, good to {certificate.worst:.2g} K{error}.")
        return told

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            "asked": self.card.model_dump(exclude_none=True),
            "limits": {name: limit.model_dump(exclude_none=True) for name, limit in self.swept.plan.limits.items()},
            "changes": self.changes,
            "answers": dict(self.full),
            "as_it_is": dict(self.nominal),
            "evaluated": len(self.swept.outcomes),
            "exhaustive": self.exhaustive,
            "ended": self.ended,
            "why_full_runs": self.swept.why_full,
            "words": self.words,
        }


def optimum(
    plan: Plan, card: OptimiseCard, how: Execution | None = None, *, known: Sweep | None = None, **said: Unpack[Said]
) -> Optimum:
    """Search by differential evolution (Storn & Price 1997; scipy), listed values as whole numbers.

    Limits by Lampinen's rule (2002): a variant that keeps them beats one that does not, of two that do not the one that
    breaks them less. Where everything that varies is listed and `card.runs` allows, every combination is tried. The
    best variant is run in full before it is named.

    Parameters
    ----------
    plan : its study, `varied`, `limits` and time to a temperature. how, said : as of `tyrefem.sweep.sweep.sweep`.
    known : variants of the same box that have answers: the best of them are in the first generation.

    Raises
    ------
    InputError : an unknown answer.
    """
    for name in (card.answer, *plan.limits):
        check_answer(name, plan.study, plan.time_to)
    how = (how or Execution()).given(said)
    with Asked(plan, how) as asked:
        nominal = Asked(plan, Execution(how.scheduler))([{}])[0]
        asked.train(card.runs)
        exhaustive = (
            all(one.values for one in plan.varied) and math.prod(len(one.values) for one in plan.varied) <= card.runs
        )
        if exhaustive:
            asked(grid(plan.varied))
            ended = ""
        else:
            ended = evolve(asked, card, how.tick, best_known(known, card))
        best, full = _verified(asked, card)
    swept = Sweep(asked.table_plan, asked.outcomes, asked.certificate, asked.why_full, taken_up=asked.taken_up)
    return Optimum(swept, card, best, full, nominal, exhaustive, ended)


def _brief(value: Any) -> str:
    """A written quantity to four digits; anything else as it is."""
    if isinstance(value, float):
        return f"{value:.4g}"
    number, space, unit = str(value).partition(" ")
    try:
        return f"{float(number):.4g}{space}{unit}"
    except ValueError:
        return str(value)


def words_of(limits: Mapping[str, LimitCard]) -> str:
    """Limits as a person reads them.

    >>> words_of({"hottest_degC": LimitCard(below=90.0)})
    'highest temperature < 90 °C'
    """
    told = []
    for name, limit in limits.items():
        told += [f"{name_of(name)} < {shown(name, limit.below)}"] if limit.below is not None else []
        told += [f"{name_of(name)} > {shown(name, limit.above)}"] if limit.above is not None else []
    return " and ".join(told)


def _verified(asked: Asked, card: OptimiseCard) -> tuple[int | None, Mapping[str, Any]]:
    """The most promising variant whose full run keeps the limits, and what that run answers."""
    limits = asked.plan.limits
    fine = [n for n, one in asked.outcomes.items() if "answers" in one and violation(one, limits, asked.margins) == 0]
    for n in sorted(fine, key=lambda n: (objective(asked.outcomes[n], card), n))[:CANDIDATES]:
        (full,) = asked([asked.variants[n]], full=True)
        if "answers" in full and violation(full, limits) == 0:
            return n, full["answers"]
    return None, {}
