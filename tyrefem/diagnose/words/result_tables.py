"""Tables of a diagnosis: candidates, sets of effects, and residuals of the original and of the amended study.

The residuals are given by run, sensor and stretch of time; by run and sensor; and by block of readings.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.diagnose.data.residual_tables import rms
from tyrefem.diagnose.fitting.pulls import pulls, pulls_p
from tyrefem.diagnose.unknowns.candidates import Candidate
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, RankedSet

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.fitting.fits import FittedSet

#: A record lists at most this many sets.
MOST_SETS = 30


def parameters(unknowns: Sequence[Unknown], fit: FittedSet) -> dict[str, dict[str, Any]]:
    """Fitted parameter -> value and standard deviation, SI: of the number that a study states."""
    totals = {unknown: fit.total(unknown) for unknown in unknowns if unknown.parameter and unknown in fit.values}
    return {
        unknown.parameter.name: {"value": unknown.value(x), "sd": sd, "unit": unknown.unit}
        for unknown, (x, sd) in totals.items()
        if unknown.parameter is not None
    }


def fitness(d: DiagnosisData, fit: FittedSet | None) -> dict[str, Any]:
    """Quality of a fitted set, K and probabilities; empty if the set was not fitted with the full model."""
    if fit is None:
        return {}
    return {
        "rms_K": rms(d.gap, fit.computed, d.gap.fitted),
        "held_out_rms_K": rms(d.gap, fit.computed, d.gap.held_out),
        "misfit": fit.misfit,
        "blocks": fit.readings,
        "p_value": fit.p_value,
        "held_out_log_probability": fit.held_out,
        "held_out_p": fit.held_out_p,
        "largest_pull": max((abs(pull.pull) for pull in pulls(fit)), default=0.0),
        "pulls_p": pulls_p(fit),
        "at_bound": list(fit.at_bound),
        "converged": fit.converged,
    }


def candidate_rows(d: DiagnosisData) -> list[dict[str, Any]]:
    """One row per candidate, most probable first.

    ``probability``: that the effect acts. ``log_evidence``: ln p(fitted data | this effect alone), up to a constant of
    the data. ``log_evidence_gain``: the same minus that of no effect. ``confounded_with``: the effects in its place in
    other credible sets, if the verdict is "confounded".
    """
    alone = {ranked.members[0]: ranked for ranked in d.judgement.ranking if len(ranked.members) == 1}
    none = next(ranked for ranked in d.judgement.ranking if not ranked.members and not ranked.outside)
    rows = []
    for candidate in d.candidates:
        ranked = alone[candidate]
        evidence = _log_evidence(d, ranked)
        rows.append(
            {
                "name": candidate.name,
                "variant": dict(candidate.choice),
                "runs": list(candidate.runs) or None,
                "probability": d.judgement.named.get(candidate.key, 0.0),
                "log_evidence": evidence,
                "log_evidence_gain": evidence - _log_evidence(d, none),
                "confounded_with": confounded_with(d, candidate),
                "parameters": parameters(candidate.unknowns, ranked.fit) if ranked.fit else {},
                **fitness(d, ranked.fit),
            }
        )
    return sorted(rows, key=lambda row: (-row["probability"], -row["log_evidence"]))


def set_rows(d: DiagnosisData, most: int = MOST_SETS) -> list[dict[str, Any]]:
    """The most probable sets, with their scores relative to the best set."""
    best = d.judgement.best.score
    return [
        {
            "effects": ["not in the catalogue"] if ranked.outside else [member.key for member in ranked.members],
            "probability": ranked.probability,
            "log_score_below_best": best - ranked.score,
            "credible": ranked in d.judgement.credible,
            "fitted": ranked.fit is not None,
            **fitness(d, ranked.fit),
        }
        for ranked in d.judgement.ranking[:most]
    ]


def competing_sets(d: DiagnosisData) -> list[RankedSet]:
    """Credible sets without a more probable subset; this leaves out sets with an effect that explains nothing."""
    kept: list[RankedSet] = []
    for ranked in d.judgement.credible:
        parts = [each for each in kept if not each.outside and set(each.members) < set(ranked.members)]
        if ranked.outside or not parts:
            kept.append(ranked)
    return kept


def inclusion_probability(d: DiagnosisData, ranked: RankedSet) -> float:
    """Probability that all members of a set act, alone or with other effects."""
    if ranked.outside:
        return ranked.probability
    having = (each for each in d.judgement.ranking if not each.outside and set(ranked.members) <= set(each.members))
    return min(sum(each.probability for each in having), 1.0) if ranked.members else ranked.probability


def better_held_out(d: DiagnosisData) -> RankedSet | None:
    """The set of effects that predicts the held-out runs best; None without such runs."""
    return max(
        (each for each in d.judgement.ranking if each.members and math.isfinite(each.held_out)),
        key=lambda each: each.held_out,
        default=None,
    )


def confounded_with(d: DiagnosisData, candidate: Candidate) -> list[str]:
    """The members of competing sets without the candidate; empty unless the verdict is "confounded"."""
    sets = competing_sets(d)
    if d.verdict != CONFOUNDED or not any(candidate in ranked.members for ranked in sets):
        return []
    others: dict[str, None] = {}
    for ranked in sets:
        if candidate not in ranked.members:
            others.update(dict.fromkeys([member.key for member in ranked.members] or [ranked.key]))
    return list(others)


def _log_evidence(d: DiagnosisData, ranked: RankedSet) -> float:
    """ln evidence of the fit with the full model, or of the linear model if there is no fit."""
    if ranked.fit is not None:
        return ranked.fit.log_evidence
    return ranked.score - d.prior(ranked.members)


def finite(row: Mapping[str, Any], key: str) -> float | None:
    """A number of a row; None if it is missing or not finite."""
    value = row.get(key)
    return None if value is None or not math.isfinite(value) else float(value)


def clearest(d: DiagnosisData) -> pd.Series:
    """The row of `DiagnosisData.where` with the most significant mean among those larger than noise."""
    large = d.where[d.where["mean_K"].abs() >= d.noise]
    return (d.where if large.empty else large).sort_values("sigma", ascending=False, kind="stable").iloc[0]


def where_table(d: DiagnosisData) -> pd.DataFrame:
    """One row per run, sensor and stretch: the columns of `residual_table`, and the residuals of the amended study."""
    keys = ["run", "hold_out", "sensor", "phase"]
    after = d.where_after.rename(columns={"mean_K": "mean_after_K", "rms_K": "rms_after_K"})
    return d.where.merge(after[[*keys, "mean_after_K", "rms_after_K"]], on=keys, how="left", validate="1:1")


def rms_table(d: DiagnosisData) -> pd.DataFrame:
    """One row per run and sensor: rms of measured - computed before and after, including noise, K."""
    import pandas as pd

    rows = []
    for number, run in enumerate(d.gap.runs):
        for readings in run.sensors:
            place = run.parts()[readings.sensor]
            left = [run.measured[place] - computed[number][place] for computed in (d.before, d.after)]
            rows.append(
                {
                    "run": run.name,
                    "hold_out": run.hold_out,
                    "sensor": readings.sensor,
                    "n": len(readings.times),
                    "before_K": rms(d.gap, d.before, [number], readings.sensor),
                    "after_K": rms(d.gap, d.after, [number], readings.sensor),
                    "noise_K": readings.noise,
                    "mean_before_K": float(np.average(left[0], weights=readings.sizes)),
                    "mean_after_K": float(np.average(left[1], weights=readings.sizes)),
                }
            )
    return pd.DataFrame(rows)


def history_table(d: DiagnosisData) -> pd.DataFrame:
    """One row per block of readings: means measured, and computed by the original and by the amended study, degC."""
    import pandas as pd

    rows = []
    for number, run in enumerate(d.gap.runs):
        measured, before, after = run.measured, d.before[number], d.after[number]
        for readings in run.sensors:
            place = run.parts()[readings.sensor]
            rows.append(
                pd.DataFrame(
                    {
                        "run": run.name,
                        "hold_out": run.hold_out,
                        "sensor": readings.sensor,
                        "time_s": readings.block_times,
                        "readings": readings.sizes.astype(int),
                        "measured_degC": measured[place],
                        "original_degC": before[place],
                        "amended_degC": after[place],
                        "noise_K": readings.noise / np.sqrt(readings.sizes),
                    }
                )
            )
    return pd.concat(rows, ignore_index=True)
