"""Summary of a sweep's table: range of every answer, and main effects of the varied numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.brief import counted
from tyrefem.sweep.part import InSentences
from tyrefem.sweep.sweep import Sweep
from tyrefem.variants.answer_units import difference_unit, name_of, shown
from tyrefem.variants.answers import TIME_TO, comparable

if TYPE_CHECKING:
    import pandas as pd

#: Default answers in pictures and tables.
DEFAULT_ANSWERS = ("hottest_degC", "rolling_resistance_coefficient")
#: The effect of a number with more values than this is a straight line, also in a grid.
MOST_LEVELS = 12


def judged(sweep: Sweep, wanted: tuple[str, ...] = ()) -> list[str]:
    """Answers in pictures and tables: those wanted, else the default ones, if they vary."""
    table = finished(sweep, wanted)
    names = wanted or (*DEFAULT_ANSWERS, *([TIME_TO] if sweep.plan.time_to is not None else []))
    return [name for name in names if name in table and table[name].nunique() > 1]


def finished(sweep: Sweep, wanted: Sequence[str] = ()) -> pd.DataFrame:
    """The rows that have answers, with the usual answers and those wanted; see `Sweep.overview`."""
    table = sweep.overview(wanted)
    return table[table["failure"] == ""]


def numeric(sweep: Sweep) -> list[str]:
    """Headings of the varied numbers that can be an axis."""
    table = sweep.overview()
    return [
        varied.heading
        for varied in sweep.plan.varied
        if varied.heading in table and table[varied.heading].dtype.kind in "if" and table[varied.heading].nunique() > 1
    ]


def main_effects(sweep: Sweep, answer: str) -> pd.DataFrame:
    """Main effect of each varied number on an answer, averaged over the others; the largest first.

    Least squares of answer = mean + sum of an effect of each number: a straight line over a number of a range that is
    no grid or has many values, else an effect of each value. On a whole grid these are the means at the values.

    Columns ``number``, ``low``, ``high`` (its ends; of a card or word the values with the lowest and highest effect)
    and ``effect``, the answer's change from low to high. No rows: the variants are too few to tell the numbers apart.
    """
    import pandas as pd

    table = finished(sweep, [answer]).dropna(subset=[answer])
    axes, grid = numeric(sweep), sweep.plan.sampling.get("sample") == "grid"
    terms = []
    for varied in sweep.plan.varied:
        name = varied.heading
        if name in table and table[name].nunique() > 1:
            ranged = not grid and not varied.values
            line = name in axes and (ranged or table[name].nunique() > MOST_LEVELS)
            terms.append(_Term(name, table[name].to_numpy(), ordered=name in axes, line=line))
    rows = _effects(terms, table[answer].to_numpy(dtype=float)) if terms else []
    effects = pd.DataFrame(rows, columns=["number", "low", "high", "effect"])
    order = effects["effect"].abs().sort_values(ascending=False).index
    return effects.loc[order].reset_index(drop=True)


class _Term:
    """The part of a varied number in the sum of effects: ``columns`` of the least-squares matrix, (variants, k)."""

    def __init__(self, name: str, values: Any, *, ordered: bool, line: bool) -> None:
        self.name, self.ordered, self.line = name, ordered, line
        self.levels = sorted(set(values.tolist()), key=lambda value: (isinstance(value, str), value))
        if line:
            span = self.levels[-1] - self.levels[0]
            self.columns = ((values.astype(float) - self.levels[0]) / span)[:, None]
        else:
            self.columns = (values[:, None] == np.array(self.levels[1:], dtype=object)).astype(float)

    def row(self, solution: Any) -> dict[str, Any]:
        """Its row, from the effects of its columns."""
        effects = np.concatenate([[0.0], solution])
        first, last = (0, -1) if self.ordered else (int(effects.argmin()), int(effects.argmax()))
        ends = {"low": self.levels[first], "high": self.levels[last]}
        return {"number": self.name, **ends, "effect": float(effects[last] - effects[first])}


def _effects(terms: Sequence[_Term], values: Any) -> list[dict[str, Any]]:
    """The rows of all terms; none if the variants cannot tell them apart."""
    matrix = np.column_stack([np.ones(len(values)), *(term.columns for term in terms)])
    spare = 1 if any(term.line for term in terms) else 0
    if len(values) < matrix.shape[1] + spare:
        return []
    solution, _, rank, _ = np.linalg.lstsq(matrix, values, rcond=None)
    if rank < matrix.shape[1]:
        return []
    places = np.cumsum([1, *(term.columns.shape[1] for term in terms)])
    return [term.row(solution[a:b]) for term, a, b in zip(terms, places[:-1], places[1:], strict=True)]


def words(sweep: Sweep, wanted: tuple[str, ...] = ()) -> list[str]:
    """Sentences: range of every reported answer, with its variants, and the main effects."""
    sentences = []
    table = finished(sweep, wanted)
    keeping = int(table["feasible"].sum())
    if sweep.plan.limits and len(table):
        sentences.append(f"{keeping or 'None'} of {len(table)} variants keep{'' if keeping > 1 else 's'} the limits.")
    which = "" if not sweep.plan.limits else " of those" if keeping else " of all"
    for answer in judged(sweep, wanted):
        kept = table[table["feasible"]] if keeping else table
        low, high = extreme(kept, answer, least=True), extreme(kept, answer, least=False)
        ends = [f"{shown(answer, end[answer])} ({named(sweep, end)})" for end in (low, high)]
        span = shown(answer, low[answer]) if low["variant"] == high["variant"] else f"from {ends[0]} to {ends[1]}"
        sentences.append(f"{capital(name_of(answer))}{which}: {span}.")
        effects = main_effects(sweep, answer)
        if len(effects):
            unit = difference_unit(answer)
            moved = "; ".join(_moved(row, unit) for row in effects.to_dict("records"))
            where = ", where it is reached" if answer == TIME_TO else ", where there is one"
            some = where if table[answer].isna().any() else ""
            sentences.append(f"Main effects on the {name_of(answer)}, averaged over the others{some}: {moved}.")
        elif numbers := [varied.label for varied in sweep.plan.varied if varied.heading in table]:
            does = "does" if len(table) == 1 else "do"
            many = counted(len(numbers), "number")
            count = f"{counted(len(table), 'variant')} {does} not tell {many} apart"
            sentences.append(f"No main effects on the {name_of(answer)}: {count}.")
    return sentences


def _moved(row: Mapping[Any, Any], unit: str) -> str:
    ends = f"{_value(row['low'])} → {_value(row['high'])}{_unit(row['number'])}"
    return f"{short(row['number'])}, {ends}, {row['effect']:+.3g} {unit}".rstrip()


def extreme(table: pd.DataFrame, answer: str, *, least: bool) -> Mapping[str, Any]:
    """The row with the smallest or largest answer; a time that is not reached is the largest, of others NaN is none."""
    values = comparable(answer, table[answer])
    values = np.where(np.isnan(values), np.inf if least else -np.inf, values)
    place = int(values.argmin() if least else values.argmax())
    return {str(name): value for name, value in table.iloc[place].items()}


def named(sweep: Sweep, row: Any) -> str:
    """A variant with its values, as text."""
    headings = [varied.heading for varied in sweep.plan.varied]
    values = ", ".join(f"{short(name)} {_value(row[name])}{_unit(name)}" for name in headings if name in row)
    return f"variant {row['variant']}: {values}" if values else f"variant {row['variant']}"


def capital(words: str) -> str:
    """The text with a capital first letter."""
    return words[:1].upper() + words[1:]


def short(heading: str) -> str:
    """A varied name without its unit and its first table."""
    return heading.split(" [")[0].split(".", 1)[-1]


def _unit(heading: str) -> str:
    unit = heading.split(" [")[1].rstrip("]") if " [" in heading else ""
    return {"": "", "x": "×", "deg": "°", "degC": " °C"}.get(unit, f" {unit}")


def _value(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, int | float | np.number) else str(value)


@dataclass(frozen=True, eq=False, repr=False)
class Responses(InSentences):
    """Answers of a sweep and their main effects; ``wanted``: the answers in pictures and tables."""

    swept: Sweep
    wanted: tuple[str, ...] = ()

    name = "sweep"
    heading = "Answers and main effects"

    @property
    def table(self) -> pd.DataFrame:
        """Table of the variants, see `Sweep.table`."""
        return self.swept.table

    @property
    def words(self) -> list[str]:
        """The answer in sentences."""
        return words(self.swept, self.wanted)

    def to_dict(self) -> dict[str, Any]:
        """Content for JSON."""
        main = {
            answer: main_effects(self.swept, answer).to_dict("records") for answer in judged(self.swept, self.wanted)
        }
        return {"main_effects": main, "words": self.words}
