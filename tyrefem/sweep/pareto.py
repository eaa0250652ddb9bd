"""The Pareto front: variants that no other one beats in every respect."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError, nearest

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]
#: What a designer weighs, unless he says otherwise: all the smaller the better.
USUAL = ("hottest_degC", "rolling_resistance_coefficient", "mass_kg")


def undominated(values: Array) -> NDArray[np.bool_]:
    """Which rows (n, k) no other row beats: at most as large in every column, smaller in one. NaN is beaten by all.

    >>> undominated(np.array([[1.0, 2.0], [2.0, 1.0], [2.0, 2.0]])).tolist()
    [True, True, False]
    """
    found = np.isfinite(values).all(axis=1)
    for i in np.flatnonzero(found):
        others = values[found]
        if ((others <= values[i]).all(axis=1) & (others < values[i]).any(axis=1)).any():
            found[i] = False
    return found


def front(table: pd.DataFrame, aims: Mapping[str, str] | None = None) -> pd.DataFrame:
    """The rows of a sweep's table on the Pareto front, feasible ones only, sorted by the first aim.

    Parameters
    ----------
    aims : answer -> "min" or "max"; by default temperature, rolling resistance and mass, where they vary.

    Raises
    ------
    InputError : an answer that the table does not have, an aim that is neither.
    """
    feasible = table[table["feasible"]]
    aims = aims or {name: "min" for name in USUAL if name in feasible and feasible[name].nunique() > 1}
    for name, aim in aims.items():
        if name not in table:
            raise InputError(f"no answer '{name}'{nearest(name, table.columns)}", field="pareto")
        if aim not in ("min", "max"):
            raise InputError(f"'{aim}' is not an aim; allowed: min, max", field=f"pareto.{name}")
    if not aims or feasible.empty:
        return feasible.iloc[:0]
    signed = np.column_stack([feasible[name] * (1 if aim == "min" else -1) for name, aim in aims.items()])
    return feasible[undominated(signed)].sort_values(next(iter(aims)))
