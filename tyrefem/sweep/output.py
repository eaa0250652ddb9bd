"""A sweep's folder: table as CSV and Parquet, certificate, summary, pictures, page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.output import atomic_path, write_json
from tyrefem.summary import versions
from tyrefem.sweep.pareto import front
from tyrefem.sweep.sweep import Sweep

if TYPE_CHECKING:
    import pandas as pd


def write(found: Sweep, folder: Path, *, pictures: bool = True) -> dict[str, Any]:
    """Write ``sweep.csv``, ``sweep.parquet``, ``pareto.csv``, ``summary.json`` and the page; returns the summary."""
    table = found.table
    write_table(table, folder / "sweep")
    best = front(table)
    if len(best):
        with atomic_path(folder / "pareto.csv") as temporary:
            best.to_csv(temporary, index=False, float_format="%.9g")
    summary = summarised(found, best)
    write_json(summary, folder / "summary.json")
    if pictures:
        from tyrefem.sweep.page import write_page

        write_page(found, best, summary, folder / "sweep.html")
    return summary


def write_table(table: pd.DataFrame, stem: Path) -> None:
    """A table as CSV and as Parquet."""
    with atomic_path(stem.with_suffix(".csv")) as temporary:
        table.to_csv(temporary, index=False, float_format="%.9g")
    with atomic_path(stem.with_suffix(".parquet")) as temporary:
        table.to_parquet(temporary, index=False)


def summarised(found: Sweep, best: pd.DataFrame) -> dict[str, Any]:
    """What `summary.json` holds: how the variants were chosen and answered, versions, and the words for people."""
    plan, certificate = found.plan, found.certificate
    by = [one.get("by", "failed") for one in found.outcomes.values()]
    counts = {how: by.count(how) for how in ("full", "reduced", "failed")}
    return {
        "study": plan.study.name,
        "title": plan.study.title,
        "complete": found.complete,
        "variants": len(plan.variants),
        "finished": counts,
        "varied": [
            {
                "key": one.key,
                "unit": one.unit,
                "values": list(one.values),
                "from": one.low,
                "to": one.high,
                "log": one.log,
            }
            for one in plan.varied
        ],
        "sample": dict(plan.how),
        "limits": {name: limit.model_dump(exclude_none=True) for name, limit in plan.limits.items()},
        "time_to_degC": plan.time_to,
        "reduced_model": None
        if certificate is None
        else {
            "largest_error_K": certificate.worst,
            "tolerance_K": certificate.tolerance,
            "fresh_cases": certificate.cases,
            "training_runs": certificate.trained_on,
            "largest_errors": dict(certificate.errors),
        },
        "why_full_runs": found.why_full,
        "pareto": best["variant"].tolist() if len(best) else [],
        "failures": found.failed,
        "seconds": found.seconds,
        "taken_up": found.taken_up,
        "tolerance_K": plan.study.tolerance,
        "mesh": plan.study.card.mesh.model_dump(),
        "versions": versions(),
        "random_seed": plan.how.get("seed"),
        "input": dict(plan.study.data),
        "words": words(found, best, counts),
    }


def words(found: Sweep, best: pd.DataFrame, counts: dict[str, int]) -> list[str]:
    """A few lines for people."""
    plan, table, certificate = found.plan, found.table, found.certificate
    lines = [plan.study.title, f"  {len(found.outcomes)} of {len(plan.variants)} variants in {found.seconds:.1f} s"]
    if found.taken_up:
        lines[-1] += f", {found.taken_up} of them taken up"
    if certificate is not None:
        lines.append(
            f"  {counts['reduced']} by a reduced model from {certificate.trained_on} runs; within"
            f" {certificate.worst:.2g} K of {certificate.cases} fresh full runs"
        )
    elif found.why_full:
        lines.append(f"  all by full runs: {found.why_full}")
    done = table[table["failure"] == ""] if len(table) else table
    if len(done) and plan.limits:
        lines.append(f"  {int(done['feasible'].sum())} of {len(done)} keep to the limits")
    if len(done):
        for name, form in (("hottest_degC", "{:.1f} degC"), ("rolling_resistance_coefficient", "{:.5f}")):
            low, high = done.loc[done[name].idxmin()], done.loc[done[name].idxmax()]
            lines.append(
                f"  {name:32s} {form.format(low[name])} (variant {low['variant']}) to {form.format(high[name])} "
                f"(variant {high['variant']})"
            )
    if len(best):
        lines.append(f"  Pareto front: {len(best)} variants, in pareto.csv")
    return lines
