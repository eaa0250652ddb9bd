"""Which tolerance matters: every uncertain number moved alone, down and up."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from tyrefem.errors import InputError
from tyrefem.studies import Study
from tyrefem.sweep.plan import Plan
from tyrefem.sweep.sweep import Sweep
from tyrefem.sweep.varied import DIGITS, scaled_value

if TYPE_CHECKING:
    import pandas as pd


def tolerances(study: Study, only: Mapping[str, float] | None = None) -> dict[str, float]:
    """Dotted name -> relative tolerance: those given, or one standard deviation of what cards and study state.

    Raises
    ------
    InputError : none stated.
    """
    found = dict(only or study.uncertainty)
    if not found:
        raise InputError(
            "no tolerances: neither cards (relative_sd) nor [uncertainty] state any; give --tolerance KEY=5%",
            file=study.file,
        )
    return found


def tornado_plan(study: Study, given: Mapping[str, float] | None = None, time_to: float | None = None) -> Plan:
    """The study as it is, then every number at 1 - tolerance and 1 + tolerance, the others as they are."""
    variants: list[dict[str, Any]] = [{}]
    names = ["as it is"]
    for key, part in tolerances(study, given).items():
        for sign, word in ((-1, "less"), (1, "more")):
            variants.append({key: scaled_value(study, key, 1 + sign * part, DIGITS)})
            names.append(f"{key}, {part:.3g} {word}")
    how = {"sample": "tolerances", "count": len(variants), "seed": None}
    return Plan(study, (), tuple(variants), tuple(names), {}, time_to, how)


def tornado(swept: Sweep, answer: str) -> pd.DataFrame:
    """Per number: the answer with less and with more of it, both less the answer as it is; the widest first.

    Columns ``number``, ``less``, ``more``, ``range``, in the answer's unit.
    """
    import pandas as pd

    plan, outcomes = swept.plan, swept.outcomes

    def value(n: int) -> float:
        found = outcomes.get(n, {}).get("answers", {}).get(answer)
        return float("nan") if found is None else float(found)

    base, rows = value(0), []
    for n in range(1, len(plan.variants), 2):
        (key,) = plan.variants[n]
        less, more = value(n) - base, value(n + 1) - base
        rows.append({"number": key, "less": less, "more": more, "range": max(less, more, 0.0) - min(less, more, 0.0)})
    return pd.DataFrame(rows).sort_values("range", ascending=False, ignore_index=True)
