"""The best variant: the smallest or largest answer under limits, by differential evolution."""

from __future__ import annotations

import functools
import heapq
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import counted
from tyrefem.errors import InputError, nearest
from tyrefem.sweep.evaluation import Evaluator
from tyrefem.sweep.part import InSentences
from tyrefem.sweep.sweep import Sweep
from tyrefem.variants.answer_units import difference_unit, name_of, shown
from tyrefem.variants.answers import check_answer, comparable
from tyrefem.variants.card import LimitCard, OptimiseCard
from tyrefem.variants.execution import Execution, ExecutionOptions
from tyrefem.variants.outcomes import Answered, Failed, Outcome
from tyrefem.variants.plan import Plan
from tyrefem.variants.samples import Grid
from tyrefem.variants.varied import Varied

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]


#: The search ends when the population's answers differ by this share of their mean.
CONVERGED = 1e-4


#: Violation of a failed variant, in shares of a limit.
FAILED = 1e3


#: Known variants in the first generation, at most.
MOST_KNOWN = 10


#: Margin around a range, as a share of it, that is mapped to its end.
MARGIN = 0.15


def best_known(known: Sweep | None, card: OptimiseCard) -> list[Array]:
    """Points of the known variants that keep the limits, the best first."""
    if known is None:
        return []
    plan = known.plan
    feasible = ((objective(each, card), n) for n, each in known.answered if violation(each, plan.limits) == 0)
    return [
        np.array([_place(number, plan.variants[n][number.key]) for number in plan.varied])
        for _, n in heapq.nsmallest(MOST_KNOWN, feasible)
    ]


def _place(varied: Varied, value: Any) -> float:
    """The coordinate of a value in the search: its number in a list, or its position between both ends."""
    if varied.values:
        return float(varied.values.index(value))
    number = float(varied.of(value))
    return (
        math.log(number / varied.low, varied.high / varied.low)
        if varied.log
        else (number - varied.low) / (varied.high - varied.low)
    )


def evolve(
    evaluate: Evaluator, card: OptimiseCard, report_progress: Callable[[str, int, int], None], known: list[Array]
) -> str:
    """Evaluate generations until they converge or `card.runs` is reached; returns the reason of the end."""
    from scipy.optimize import NonlinearConstraint, differential_evolution
    from scipy.stats import qmc

    varied, limits = evaluate.plan.varied, evaluate.plan.limits
    most = np.array([len(varied_number.values) - 1.0 if varied_number.values else 1.0 for varied_number in varied])
    whole = np.array([bool(varied_number.values) for varied_number in varied])
    count = int(np.clip(card.runs // 10, 8, 10 * len(varied)))

    def outcomes(x: Array) -> list[Any]:
        return evaluate([_variant(varied, column) for column in np.atleast_2d(x.T)])

    def aim(x: Array) -> Array:
        report_progress("optimum", min(len(evaluate.outcomes), card.runs), card.runs)
        return np.array([objective(outcome, card) for outcome in outcomes(x)])

    def broken(x: Array) -> Array:
        return np.array([[violation(outcome, limits, evaluate.margins) for outcome in outcomes(x)]])

    first = qmc.LatinHypercube(len(varied), seed=np.random.default_rng(card.seed)).random(count) * most
    for number, place in enumerate(known[: count // 3]):
        first[number] = place
    # The search rejects points outside its bounds; a margin of clipped points lets it reach the edges of the box.
    margin = np.where(whole, 0.0, MARGIN)
    search = differential_evolution(
        aim,
        list(zip(-margin, most + margin, strict=True)),
        integrality=whole,
        init=np.where(whole, np.round(first), first),
        maxiter=max(card.runs // count - 1, 1),
        constraints=NonlinearConstraint(broken, -np.inf, 0.0) if limits else (),
        seed=card.seed,
        tol=CONVERGED,
        polish=False,
        updating="deferred",
        vectorized=True,
    )
    return "the search had converged" if search.success else f"the search ended at its {card.runs} trials"


def _variant(varied: Sequence[Varied], x: Array) -> dict[str, Any]:
    changes: dict[str, Any] = {}
    for number, u in zip(varied, x, strict=True):
        changes |= number.changes(
            number.values[round(float(u))] if number.values else number.at(float(np.clip(u, 0.0, 1.0)))
        )
    return changes


def objective(outcome: Outcome, card: OptimiseCard) -> float:
    """The number to minimise; a time that is not reached is the longest, a failure or no such number is infinite."""
    if isinstance(outcome, Failed) or card.answer not in outcome.answers:
        return math.inf
    value = float(comparable(card.answer, outcome.answers[card.answer]))
    if math.isnan(value):
        return math.inf
    return value if card.minimise else -value


def violation(outcome: Outcome, limits: Mapping[str, LimitCard], margins: Mapping[str, float] | None = None) -> float:
    """Sum of the relative violations of the limits; 0: all are kept.

    ``margins``: answer -> error of the reduced model; its answers must keep the limits with this margin.

    >>> violation(Answered({"hottest_degC": 99.0}), {"hottest_degC": LimitCard(below=90.0)})
    0.1
    """
    if isinstance(outcome, Failed) or any(name not in outcome.answers for name in limits):
        return FAILED if limits else 0.0
    total = 0.0
    for name, limit in limits.items():
        value = float(comparable(name, outcome.answers[name]))
        if math.isnan(value):
            total += FAILED
            continue
        margin = (margins or {}).get(name, 0.0) if outcome.by == "reduced" else 0.0
        total += 0.0 if limit.below is None else _beyond(value + margin, limit.below)
        total += 0.0 if limit.above is None else _beyond(margin - value, -limit.above)
    return total


def _beyond(value: float, bound: float) -> float:
    """Relative excess over a bound; the bound itself is not allowed."""
    return 0.0 if value < bound else max((value - bound) / max(abs(bound), 1e-12), 1e-9)


#: Best variants that are run in full, one after the other, until one keeps the limits.
CANDIDATES = 5


@dataclass(frozen=True, eq=False, repr=False)
class Optimum(InSentences):
    """Result of a search.

    Parameters
    ----------
    swept : all evaluated variants, in the order of the search. card : the question.
    best : number of the best variant that keeps the limits; None: none does. full : its answers by a full run.
    nominal : outcome of the unchanged study. exhaustive : all combinations were evaluated. ended : why it ended.
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
        """The answer that was minimised or maximised."""
        return self.card.answer

    @functools.cached_property
    def table(self) -> pd.DataFrame:
        """All evaluated variants, as `Sweep.table`, with ``best_so_far`` among those that keep the limits."""
        table = self.swept.table
        if self.answer not in table:
            return table.assign(best_so_far=np.nan)
        values = table[self.answer].where(table["feasible"])
        return table.assign(best_so_far=(values.cummin() if self.card.minimise else values.cummax()).ffill())

    @property
    def changes(self) -> dict[str, Any]:
        """Changes of the study that give the best variant."""
        return {} if self.best is None else dict(self.swept.plan.variants[self.best])

    @property
    def evaluated(self) -> int:
        """Number of different variants; a full run after one by the reduced model is no other variant."""
        variants = self.swept.plan.variants
        return len({json.dumps(variants[n], sort_keys=True, default=str) for n in self.swept.outcomes})

    @property
    def failed(self) -> dict[str, str]:
        """Variant of the search that failed -> reason."""
        return {f"variant {name}": reason for name, reason in self.swept.failed.items()}

    @property
    def where(self) -> str:
        """`changes` as text, with four digits; linked numbers by their name."""
        values = {} if self.best is None else self.swept.plan.settings(self.best)
        return ", ".join(f"{key} = {_four_digits(value)}" for key, value in values.items())

    @property
    def words(self) -> list[str]:
        """The answer in sentences."""
        plan, limits = self.swept.plan, words_of(self.swept.plan.limits)
        heading = (
            f"{'Smallest' if self.card.minimise else 'Largest'} {name_of(self.answer)}{limits and f' with {limits}'}"
        )
        failed = len(self.swept.failed)
        count = f"{counted(self.evaluated, 'different variant')} evaluated"
        tried = count + (f", {failed} failed" if failed else "")
        if self.best is None:
            why = "no variant keeps the limits" if plan.limits else "no variant has a number"
            return [f"{heading}: {why} ({tried})."]
        sentences = [f"{heading}: {shown(self.answer, self.full[self.answer])} at {self.where}, by a full run."]
        others = [name for name in plan.limits if name != self.answer]
        if others:
            values = ", ".join(f"{name_of(name)} {shown(name, self.full[name])}" for name in others)
            sentences.append(f"There: {values}.")
        if isinstance(self.nominal, Answered):
            before = float(self.nominal.answers[self.answer])
            change = self.full[self.answer] - before
            gained = f": {change:+.3g} {difference_unit(self.answer)}".rstrip() + " by the optimum"
            # A time that is never reached has no difference.
            gained = "" if math.isnan(change) else gained
            broken = violation(self.nominal, plan.limits) > 0
            breaks = " but breaks a limit" if broken else ""
            sentences.append(f"The study as it is has {shown(self.answer, before)}{breaks}{gained}.")
        sentences.append(f"{tried}; {'every combination was tried' if self.exhaustive else self.ended}.")
        certificate = self.swept.certificate
        if certificate is not None:
            stated = certificate.errors.get(self.answer)
            width = "" if stated is None else f"{stated:.2g} {difference_unit(self.answer)}".strip()
            error = f"; {name_of(self.answer)} to ±{width}" if width else ""
            sentences.append(f"The search used a reduced model with an error of {certificate.error:.2g} K{error}.")
        return sentences

    def to_dict(self) -> dict[str, Any]:
        """Content for JSON."""
        return {
            "asked": self.card.model_dump(exclude_none=True),
            "limits": {name: limit.model_dump(exclude_none=True) for name, limit in self.swept.plan.limits.items()},
            "changes": self.changes,
            "answers": dict(self.full),
            "as_it_is": self.nominal.entry,
            "evaluated": self.evaluated,
            "exhaustive": self.exhaustive,
            "ended": self.ended,
            "why_full_runs": self.swept.why_full,
            "words": self.words,
        }


def optimum(
    plan: Plan,
    card: OptimiseCard,
    execution: Execution | None = None,
    *,
    known: Sweep | None = None,
    **options: Unpack[ExecutionOptions],
) -> Optimum:
    """Search by differential evolution (Storn & Price 1997; scipy); listed values are integers.

    Limits follow Lampinen's rule (2002): a variant that keeps them is better than a variant that violates them; of two
    that violate them the smaller violation is better. If all varied numbers are listed and `card.runs` allows, every
    combination is evaluated. The best variant is confirmed by a full run.

    Parameters
    ----------
    plan : its study, `varied`, `limits` and ``time_to``. execution, options : as in `tyrefem.sweep.sweep.sweep`.
    known : evaluated variants of the same box; the best of them enter the first generation.

    Raises
    ------
    InputError : an unknown answer.
    """
    for name in (card.answer, *plan.limits):
        check_answer(name, plan.study, plan.time_to)
    execution = (execution or Execution()).given(options)
    with Evaluator(plan, execution) as evaluate:
        nominal = Evaluator(plan, Execution(execution.scheduler))([{}])[0]
        _check_there(nominal, (card.answer, *plan.limits))
        listed = all(number.values for number in plan.varied)
        combinations = math.prod(len(number.values) for number in plan.varied)
        exhaustive = listed and combinations <= card.runs
        evaluate.train(combinations if exhaustive else card.runs)
        if exhaustive:
            evaluate(Grid(plan.varied))
            ended = ""
        else:
            ended = evolve(evaluate, card, execution.report_progress, best_known(known, card))
        best, full = _verified(evaluate, card)
    swept = Sweep(
        evaluate.table_plan, evaluate.outcomes, evaluate.certificate, evaluate.why_full, resumed=evaluate.resumed
    )
    return Optimum(swept, card, best, full, nominal, exhaustive, ended)


def _check_there(nominal: Outcome, names: Sequence[str]) -> None:
    """Raise `InputError` for an answer that only a pattern allows, as ``lost_*_share`` does, and the study has not."""
    if not isinstance(nominal, Answered):
        return
    for name in names:
        if name not in nominal.answers:
            raise InputError(f"no answer '{name}'{nearest(name, nominal.answers)}", field="optimise")


def _four_digits(value: Any) -> str:
    """A written quantity with four digits; other values unchanged."""
    if isinstance(value, float):
        return f"{value:.4g}"
    number, space, unit = str(value).partition(" ")
    try:
        return f"{float(number):.4g}{space}{unit}"
    except ValueError:
        return str(value)


def words_of(limits: Mapping[str, LimitCard]) -> str:
    """Limits as text.

    >>> words_of({"hottest_degC": LimitCard(below=90.0)})
    'highest temperature < 90 °C'
    """
    parts = []
    for name, limit in limits.items():
        parts += [f"{name_of(name)} < {shown(name, limit.below)}"] if limit.below is not None else []
        parts += [f"{name_of(name)} > {shown(name, limit.above)}"] if limit.above is not None else []
    return " and ".join(parts)


def _verified(evaluate: Evaluator, card: OptimiseCard) -> tuple[int | None, Mapping[str, Any]]:
    """The best variant whose full run keeps the limits, and the answers of that run."""
    limits = evaluate.plan.limits
    outcomes = evaluate.outcomes
    answered = [n for n, outcome in outcomes.items() if isinstance(outcome, Answered)]
    numbered = [n for n in answered if objective(outcomes[n], card) < math.inf]
    feasible = [n for n in numbered if violation(outcomes[n], limits, evaluate.margins) == 0]
    for n in sorted(feasible, key=lambda n: (objective(outcomes[n], card), n))[:CANDIDATES]:
        (full,) = evaluate([evaluate.variants[n]], full=True)
        if isinstance(full, Answered) and violation(full, limits) == 0:
            return n, full.answers
    return None, {}
