"""Sobol indices: which share of an answer's variance comes from which number, alone and together with others."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.errors import InputError
from tyrefem.studies import Study
from tyrefem.sweep.plan import Plan
from tyrefem.sweep.sweep import Sweep
from tyrefem.sweep.varied import Varied

if TYPE_CHECKING:
    import pandas as pd


def problem(varied: Sequence[Varied]) -> dict[str, Any]:
    """What SALib wants to know: names and bounds (the unit cube: `Varied.at` takes it from there)."""
    return {"num_vars": len(varied), "names": [one.key for one in varied], "bounds": [[0.0, 1.0]] * len(varied)}


def indices_plan(
    study: Study, varied: Sequence[Varied], base: int, seed: int = 1, time_to: float | None = None
) -> Plan:
    """Saltelli's sample: ``base`` (a power of two) x (numbers + 2) variants, numbers uniform in their ranges.

    Raises
    ------
    InputError : ``base`` is not a power of two; fewer than two numbers.
    """
    from SALib.sample import sobol

    if base < 2 or base & (base - 1):
        raise InputError(f"must be a power of two, not {base}", field="--indices")
    if len(varied) < 2:
        raise InputError("Sobol indices need at least two numbers that vary", field="vary")
    places = sobol.sample(problem(varied), base, calc_second_order=False, seed=seed)
    variants = tuple({one.key: one.at(float(u)) for one, u in zip(varied, row, strict=True)} for row in places)
    names = tuple(str(number + 1) for number in range(len(variants)))
    how = {"sample": "saltelli", "count": len(variants), "seed": seed, "base": base}
    return Plan(study, tuple(varied), variants, names, {}, time_to, how)


def indices(swept: Sweep, answer: str, seed: int = 1) -> pd.DataFrame:
    """First-order and total indices of an answer with their 95 % intervals; the largest total first.

    Raises
    ------
    InputError : variants that failed or were not run: the estimate needs every one.
    """
    import pandas as pd
    from SALib.analyze import sobol

    plan = swept.plan
    values = [swept.outcomes.get(n, {}).get("answers", {}).get(answer) for n in range(len(plan.variants))]
    missing = sum(value is None for value in values)
    if missing:
        raise InputError(f"{missing} of {len(values)} variants have no '{answer}'; Sobol indices need them all")
    found = sobol.analyze(
        problem(plan.varied), np.array(values, dtype=float), calc_second_order=False, seed=seed, print_to_console=False
    )
    table = pd.DataFrame(
        {
            "number": [one.key for one in plan.varied],
            "first": found["S1"],
            "first_95": found["S1_conf"],
            "total": found["ST"],
            "total_95": found["ST_conf"],
        }
    )
    return table.sort_values("total", ascending=False, ignore_index=True)
