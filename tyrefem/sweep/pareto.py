"""The Pareto front: variants that no other variant dominates."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError, nearest
from tyrefem.sweep.part import InSentences
from tyrefem.variants.answers import comparable

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.sweep.sweep import Sweep

Array = NDArray[np.float64]
#: Default aims, all minimised.
DEFAULT_AIMS = ("hottest_degC", "rolling_resistance_coefficient", "mass_kg")


def undominated(values: Array) -> NDArray[np.bool_]:
    """Which rows (n, k) no other row dominates: at most as large in every column, and smaller in at least one.

    >>> undominated(np.array([[1.0, 2.0], [2.0, 1.0], [2.0, 2.0]])).tolist()
    [True, True, False]
    """
    kept = np.zeros(len(values), dtype=np.bool_)
    best = np.empty((0, values.shape[1]))
    # In sorted order only an earlier row can dominate a row: compare it with the front so far.
    for i in np.lexsort(values.T[::-1]):
        worse = (best <= values[i]).all(axis=1)
        if not (worse & (best < values[i]).any(axis=1)).any():
            kept[i] = True
            best = np.vstack([best, values[i]])
    return kept


def default_aims(table: pd.DataFrame) -> dict[str, str]:
    """Temperature, rolling resistance and mass, all minimised, if they vary."""
    feasible = table[table["feasible"].astype(bool)]
    return {name: "min" for name in DEFAULT_AIMS if name in feasible and feasible[name].nunique() > 1}


def front(table: pd.DataFrame, aims: Mapping[str, str] | None = None) -> pd.DataFrame:
    """The feasible rows of a sweep's table on the Pareto front, sorted by the first aim.

    Parameters
    ----------
    aims : answer -> "min" or "max"; default: temperature, rolling resistance and mass, if they vary.

    Raises
    ------
    InputError : the table does not have the answer, or an aim is neither "min" nor "max".
    """
    feasible = table[table["feasible"].astype(bool)]
    aims = aims or default_aims(table)
    answered = bool((table["failure"] == "").any())
    for name, aim in aims.items():
        if name not in table and answered:
            raise InputError(f"no answer '{name}'{nearest(name, table.columns)}", field="pareto")
        if aim not in ("min", "max"):
            raise InputError(f"'{aim}' is not an aim; allowed: min, max", field=f"pareto.{name}")
    if not aims or feasible.empty:
        return feasible.iloc[:0]
    columns = [comparable(name, feasible[name]) * (1 if aim == "min" else -1) for name, aim in aims.items()]
    signed = np.column_stack(columns)
    # A share of no heat is neither small nor large.
    known = ~np.isnan(signed).any(axis=1)
    return feasible[known][undominated(signed[known])].sort_values(next(iter(aims)))


@dataclass(frozen=True, eq=False, repr=False)
class ParetoFront(InSentences):
    """The Pareto front of a sweep; ``aims`` as in `front`."""

    swept: Sweep
    aims: Mapping[str, str]

    name = "pareto"
    heading = "Pareto front"

    @property
    def chosen(self) -> dict[str, str]:
        """Answer -> aim."""
        return dict(self.aims) or default_aims(self.swept.overview())

    @functools.cached_property
    def table(self) -> pd.DataFrame:
        """The variants on the front, sorted by the first aim."""
        best, numbers = front(self.swept.overview(tuple(self.chosen)), self.chosen), self.swept.packed.numbers
        whole = self.swept.rows(np.sort(numbers[best.index]))
        return whole.set_index("variant", drop=False).loc[best["variant"]].set_index(best.index)

    @property
    def words(self) -> list[str]:
        """The answer in sentences."""
        from tyrefem.sweep.responses import extreme, named
        from tyrefem.variants.answer_units import name_of, shown

        table, aims = self.table, self.chosen
        if len(aims) < 2 or table.empty:
            return []
        feasible = int(self.swept.overview()["feasible"].sum())
        together = ", ".join(("" if aim == "min" else "large ") + name_of(name) for name, aim in aims.items())
        are = "is" if len(table) == 1 else "are"
        sentences = [f"{len(table)} of {feasible} variants {are} not dominated in {together}."]
        best: dict[str, tuple[Mapping[str, Any], list[str]]] = {}
        for name, aim in aims.items():
            row = extreme(table, name, least=aim == "min")
            best.setdefault(str(row["variant"]), (row, []))[1].append(name)
        for row, names in best.values():
            values = ", ".join(f"{name_of(name)} {shown(name, row[name])}" for name in aims)
            sentences.append(f"Best in {' and '.join(map(name_of, names))}: {named(self.swept, row)}; {values}.")
        return sentences

    def to_dict(self) -> dict[str, Any]:
        """Content for JSON."""
        return {"aims": self.chosen, "variants": self.table["variant"].tolist(), "words": self.words}
