"""Tornado: every uncertain number changed alone, down and up by its tolerance."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from tyrefem.errors import InputError, nearest
from tyrefem.inputs.changes import check_factor
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.uncertain_numbers import UncertainNumber, left_out, uncertain_number
from tyrefem.sweep.part import InSentences
from tyrefem.sweep.question import SweepQuestion
from tyrefem.sweep.responses import judged
from tyrefem.sweep.sweep import Sweep, sweep
from tyrefem.variants.answer_units import difference_unit, name_of, shown
from tyrefem.variants.card import SweepCard, TornadoCard
from tyrefem.variants.execution import Execution
from tyrefem.variants.links import Links, members
from tyrefem.variants.outcomes import Failed, answer_of
from tyrefem.variants.plan import Plan, check_changes
from tyrefem.variants.varied import DIGITS, factored

if TYPE_CHECKING:
    import pandas as pd


def tolerances(
    study: StudyData, only: Mapping[str, float] | None = None, links: Links | None = None
) -> tuple[UncertainNumber, ...]:
    """The uncertain numbers with their relative tolerances as sd; linked numbers are one number.

    Default: all numbers that affect answers and for which cards or study state a standard deviation. A card's number is
    the same in all regions that use the card.

    Raises
    ------
    InputError : no tolerance is stated, or the study has no such name.
    """
    uncertain = [number for number in study.uncertain_numbers if not number.idle]
    if only:
        uncertain = [_number(study, key, part, links or {}) for key, part in only.items()]
    if not uncertain:
        raise InputError(
            "no tolerances: neither cards (relative_sd) nor [uncertainty] state any; give --tolerance-of KEY=5%",
            file=study.file,
        )
    return tuple(uncertain)


def _number(study: StudyData, name: str, tolerance: float, links: Links) -> UncertainNumber:
    group = members(study, name, links)
    if not group.linked:
        number = uncertain_number(study, name, tolerance)
        _check_share(name, number.written)
        return number
    together = factored(study, group)
    written = (together.nominal, *(value for _, value in together.also))
    return UncertainNumber(name, together.keys, written, tolerance, regions=(name, *together.keys))


def _check_share(name: str, written: tuple[Any, ...]) -> None:
    """Raise `InputError` for a tolerance of a temperature, which has no share, with the table that takes kelvins."""
    for value in written:
        try:
            check_factor(value)
        except InputError as error:
            raise InputError(f"{error.message} in [uncertainty]", field=f"tornado.tolerances.{name}") from None


def tornado_plan(
    study: StudyData,
    given: Mapping[str, float] | None = None,
    time_to: float | None = None,
    links: Links | None = None,
) -> Plan:
    """Plan of the unchanged study, then each number alone times 1 - tolerance and 1 + tolerance."""
    variants: list[dict[str, Any]] = [{}]
    names = ["as it is"]
    numbers = tolerances(study, given, links)
    for number in numbers:
        for sign, word in ((-1, "less"), (1, "more")):
            variants.append(number.changes(1 + sign * number.sd, DIGITS))
            names.append(f"{number.key}, {number.sd:.3g} {word}")
    check_changes(study, list(zip(names, variants, strict=True)))
    sampling = {
        "sample": "tolerances",
        "count": len(variants),
        "seed": None,
        "tolerances": {number.key: number.sd for number in numbers},
        "in_words": {number.key: number.deviation for number in numbers},
        "also": {number.key: list(number.regions[1:]) for number in numbers if len(number.regions) > 1},
        "left_out": [] if given else left_out(study.uncertain_numbers),
    }
    return Plan(study, (), tuple(variants), tuple(names), {}, time_to, sampling)


@dataclass(frozen=True, eq=False, repr=False)
class Tornado(InSentences):
    """Effect of every tolerance alone on the answers.

    Parameters
    ----------
    swept : sweep of `tornado_plan`. answers : the reported answers.
    """

    swept: Sweep
    answers: tuple[str, ...]

    name = "tornado"
    heading = "Which tolerance matters"

    @functools.cached_property
    def table(self) -> pd.DataFrame:
        """Per answer and number: ``nominal``, ``less`` and ``more`` (changes of the answer), ``range``; largest first.

        ``tolerance`` is the relative change of the number. ``also`` has the other regions of its card, which change
        too. The other columns are in the answer's unit.
        """
        import pandas as pd

        plan, rows = self.swept.plan, []
        for answer in self.answers:
            base = self._value(0, answer)
            for n, key in zip(range(1, len(plan.variants), 2), plan.sampling["tolerances"], strict=True):
                less, more = (self._value(m, answer) - base for m in (n, n + 1))
                width = max(less, more, 0.0) - min(less, more, 0.0) if math.isfinite(less + more) else math.nan
                rows.append(
                    {
                        "answer": answer,
                        "number": key,
                        "tolerance": plan.sampling["tolerances"][key],
                        "nominal": base,
                        "less": less,
                        "more": more,
                        "range": width,
                        "also": ", ".join(plan.sampling["also"].get(key, ())),
                        "failure": "; ".join(filter(None, (self._failure(m) for m in (0, n, n + 1)))),
                    }
                )
        order = {answer: number for number, answer in enumerate(self.answers)}
        table = pd.DataFrame(rows)
        keys = table["answer"].map(order)
        return table.assign(_order=keys).sort_values(
            ["_order", "range"], ascending=[True, False], ignore_index=True
        ).drop(columns="_order")  # fmt: skip

    @property
    def interrupted(self) -> str:
        """Why the sweep is incomplete; empty: it is complete."""
        return self.swept.interrupted

    @property
    def failed(self) -> dict[str, str]:
        """Run that failed -> reason."""
        return self.swept.failed

    def tolerance(self, number: str) -> str:
        """The tolerance of a number as text: a share, of a temperature kelvins."""
        return str(self.swept.plan.sampling["in_words"][number])

    def of(self, answer: str) -> pd.DataFrame:
        """The rows of an answer, the largest range first.

        Raises
        ------
        InputError : an answer that the tornado does not report; names the nearest.
        """
        if answer not in self.answers:
            raise InputError(f"no answer '{answer}'{nearest(str(answer), self.answers)}", field="answer")
        table = self.table
        return table[table["answer"] == answer].drop(columns="answer").reset_index(drop=True)

    def _value(self, n: int, answer: str) -> float:
        value = answer_of(self.swept.outcomes.get(n), answer)
        return math.nan if value is None else float(value)

    def _failure(self, n: int) -> str:
        outcome = self.swept.outcomes.get(n, Failed("not run"))
        return outcome.reason if isinstance(outcome, Failed) else ""

    @property
    def words(self) -> list[str]:
        """The answer in sentences."""
        sentences = []
        for answer in self.answers:
            rows = self.of(answer).dropna(subset=["range"]).to_dict("records")
            if not rows:
                continue
            unit, first = difference_unit(answer), rows[0]
            together = math.sqrt(sum((row["range"] / 2) ** 2 for row in rows))
            others = [f"{row['number']} (±{row['range'] / 2:.2g})" for row in rows[1:3] if row["range"] > 0]
            sentences += [
                f"The {name_of(answer)}, {shown(answer, first['nominal'])} in the unchanged study, depends most on "
                + f"{first['number']}: ±{first['range'] / 2:.2g} {unit}".rstrip()
                + f" for {self.tolerance(first['number'])}"
                + "".join(f", then {clause}" for clause in others)
                + "."
            ]
            if len(rows) > 1:
                sentences.append(f"All {len(rows)} together, if independent: ±{together:.2g} {unit}".rstrip() + ".")
        failed = self.swept.failed
        sentences += [f"{clause[0].upper()}{clause[1:]}." for clause in self.swept.plan.sampling["left_out"]]
        return sentences + ([f"{len(failed)} of {len(self.swept.plan.variants)} runs failed."] if failed else [])

    def to_dict(self) -> dict[str, Any]:
        """Content for JSON."""
        return {"rows": self.table.to_dict("records"), "failures": self.swept.failed, "words": self.words}


class TornadoQuestion(SweepQuestion):
    """``[tornado]``: every uncertain number changed alone, down and up by its tolerance."""

    key: ClassVar[str] = Tornado.name
    table: ClassVar[type[TornadoCard]] = TornadoCard
    place: ClassVar[int] = 1

    def __init__(self, study: StudyData, table: TornadoCard, card: SweepCard) -> None:
        self.plan, self.answers = tornado_plan(study, table.tolerances, card.time_to, card.link), card.answers

    @property
    def words(self) -> str:
        """The planned work: number of tolerances."""
        return f"a tornado of {(len(self.plan.variants) - 1) // 2} tolerances"

    def answered(self, execution: Execution) -> Tornado:
        """Run the variants in full: they are too few to train a reduced model."""
        swept = sweep(self.plan, execution, reduced="never")
        return Tornado(swept, self.answers or tuple(judged(swept)) or ("hottest_degC",))
