"""Every explanation that was tried, and how well it does: candidates one by one, and sets of them.

Before and after as tables: by run, sensor and stretch of time; by run and sensor; reading by reading.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.diagnose.candidates import Candidate
from tyrefem.diagnose.residual_tables import rms
from tyrefem.diagnose.unknowns import Unknown
from tyrefem.diagnose.verdict import CONFOUNDED, RankedSet

if TYPE_CHECKING:
    import pandas as pd

    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.fits import FittedSet

#: Sets that a record lists at most.
MOST_SETS = 30


def parameters(unknowns: Sequence[Unknown], fit: FittedSet) -> dict[str, dict[str, Any]]:
    """Parameter -> value and standard deviation, SI, of those that were fitted."""
    return {
        one.parameter.name: {"value": one.value(fit.values[one]), "sd": fit.sd[one], "unit": one.unit}
        for one in unknowns
        if one.parameter is not None and one in fit.values
    }


def fitness(d: DiagnosisData, fit: FittedSet | None) -> dict[str, Any]:
    """How well a fitted set does, K and probabilities; empty where the full model was not fitted."""
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
        "at_bound": list(fit.at_bound),
        "converged": fit.converged,
    }


def candidate_rows(d: DiagnosisData) -> list[dict[str, Any]]:
    """One row per candidate, most probable first.

    ``probability``: that it is part of the truth. ``log_evidence``: ln p(fitted data | it alone), up to a constant of
    the data; ``log_evidence_gain``: the same minus that of no effect. ``confounded_with``: what takes its place in
    other credible sets, where the verdict is "confounded".
    """
    alone = {one.members[0]: one for one in d.judgement.ranking if len(one.members) == 1}
    none = next(one for one in d.judgement.ranking if not one.members and not one.outside)
    rows = []
    for candidate in d.candidates:
        one = alone[candidate]
        evidence = _log_evidence(d, one)
        rows.append(
            {
                "name": candidate.name,
                "variant": dict(candidate.choice),
                "probability": d.judgement.named.get(candidate.key, 0.0),
                "log_evidence": evidence,
                "log_evidence_gain": evidence - _log_evidence(d, none),
                "confounded_with": confounded_with(d, candidate),
                "parameters": parameters(candidate.unknowns, one.fit) if one.fit else {},
                **fitness(d, one.fit),
            }
        )
    return sorted(rows, key=lambda row: (-row["probability"], -row["log_evidence"]))


def set_rows(d: DiagnosisData, most: int = MOST_SETS) -> list[dict[str, Any]]:
    """The most probable sets, with the score relative to the best."""
    best = d.judgement.best.score
    return [
        {
            "effects": ["not in the catalogue"] if one.outside else [member.key for member in one.members],
            "probability": one.probability,
            "log_score_below_best": best - one.score,
            "credible": one in d.judgement.credible,
            "fitted": one.fit is not None,
            **fitness(d, one.fit),
        }
        for one in d.judgement.ranking[:most]
    ]


def contenders(d: DiagnosisData) -> list[RankedSet]:
    """Credible sets that none of their own parts outdoes: a set with an idle effect beside the others is no rival."""
    found: list[RankedSet] = []
    for one in d.judgement.credible:
        parts = [each for each in found if not each.outside and set(each.members) < set(one.members)]
        if one.outside or not parts:
            found.append(one)
    return found


def support(d: DiagnosisData, one: RankedSet) -> float:
    """Probability that all members of a set are part of the truth, whatever is beside them."""
    if one.outside:
        return one.probability
    having = (each for each in d.judgement.ranking if not each.outside and set(one.members) <= set(each.members))
    return min(sum(each.probability for each in having), 1.0) if one.members else one.probability


def confounded_with(d: DiagnosisData, candidate: Candidate) -> list[str]:
    """What other contenders have in a candidate's place; empty unless the verdict is "confounded"."""
    sets = contenders(d)
    if d.verdict != CONFOUNDED or not any(candidate in one.members for one in sets):
        return []
    found: dict[str, None] = {}
    for one in sets:
        if candidate not in one.members:
            found.update(dict.fromkeys([member.key for member in one.members] or [one.key]))
    return list(found)


def _log_evidence(d: DiagnosisData, one: RankedSet) -> float:
    """Fitted with the full model where that was done, else by the linear one."""
    if one.fit is not None:
        return one.fit.log_evidence
    return one.score - d.prior(one.members)


def finite(row: Mapping[str, Any], key: str) -> float | None:
    """A number of a row, if it has one."""
    value = row.get(key)
    return None if value is None or not math.isfinite(value) else float(value)


def where_table(d: DiagnosisData) -> pd.DataFrame:
    """One row per run, sensor and stretch: the columns of `residual_table`, and what is left in the amended study."""
    keys = ["run", "hold_out", "sensor", "phase"]
    after = d.where_after.rename(columns={"mean_K": "mean_after_K", "rms_K": "rms_after_K"})
    return d.where.merge(after[[*keys, "mean_after_K", "rms_after_K"]], on=keys, how="left", validate="1:1")


def rms_table(d: DiagnosisData) -> pd.DataFrame:
    """One row per run and sensor: root mean square of the readings' deviations before and after, noise included, K."""
    import pandas as pd

    rows = []
    for number, trial in enumerate(d.gap.trials):
        for one in trial.sensors:
            place = trial.parts()[one.sensor]
            left = [trial.measured[place] - computed[number][place] for computed in (d.before, d.after)]
            rows.append(
                {
                    "run": trial.name,
                    "hold_out": trial.hold_out,
                    "sensor": one.sensor,
                    "n": len(one.times),
                    "before_K": rms(d.gap, d.before, [number], one.sensor),
                    "after_K": rms(d.gap, d.after, [number], one.sensor),
                    "noise_K": one.noise,
                    "mean_before_K": float(np.average(left[0], weights=one.sizes)),
                    "mean_after_K": float(np.average(left[1], weights=one.sizes)),
                }
            )
    return pd.DataFrame(rows)


def history_table(d: DiagnosisData) -> pd.DataFrame:
    """One row per block of readings: measured mean, and what the original and the amended study say, degC."""
    import pandas as pd

    rows = []
    for number, trial in enumerate(d.gap.trials):
        measured, before, after = trial.measured, d.before[number], d.after[number]
        for one in trial.sensors:
            place = trial.parts()[one.sensor]
            rows.append(
                pd.DataFrame(
                    {
                        "run": trial.name,
                        "hold_out": trial.hold_out,
                        "sensor": one.sensor,
                        "time_s": one.block_times,
                        "readings": one.sizes.astype(int),
                        "measured_degC": measured[place],
                        "original_degC": before[place],
                        "amended_degC": after[place],
                        "noise_K": one.noise / np.sqrt(one.sizes),
                    }
                )
            )
    return pd.concat(rows, ignore_index=True)
