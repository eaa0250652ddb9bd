"""How sure a named effect is: beside discrepancy models, and without each sensor and run; as plain data."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from tyrefem.diagnose.verdicts.verdict import PARTLY, UNEXPLAINED

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.unknowns.candidates import Candidate

#: Effects below this probability are left out of a row.
LEAST = 0.01
#: Effects from this probability on may act beside a discrepancy.
POSSIBLE = 0.05


def effect_probability(d: DiagnosisData, member: Candidate) -> float:
    """Probability that an effect acts; of a partly identified one the smallest over the discrepancy models."""
    if d.verdict == PARTLY and d.robustness is not None:
        return min(d.robustness.least(member.key), 1.0)
    return d.judgement.named.get(member.key, 0.0)


def confidence(d: DiagnosisData) -> float:
    """Smallest probability of a named effect: as found, beside discrepancies, or without one sensor or run.

    NaN without a named effect. An effect that can show only at one sensor, or in one run, is not left without it.
    """
    return min((member_confidence(d, member) for member in d.supports), default=math.nan)


def member_confidence(d: DiagnosisData, member: Candidate) -> float:
    """The same of one effect; NaN if it was not judged without each sensor and run."""
    support = d.supports.get(member)
    if support is None:
        return math.nan
    chance = effect_probability(d, member)
    return min(chance, support.weakest.probability) if support.weakest else chance


def support_row(d: DiagnosisData, member: Candidate) -> dict[str, Any] | None:
    """Probability of an effect without each sensor and run; ``only``: the one that alone asks for it. Null if unknown.

    ``only_at``: the sensor or run that alone can show the effect, null if all can.
    """
    support = d.supports.get(member)
    if support is None:
        return None
    rows = [{"kind": each.kind, "name": each.name, "probability": each.probability} for each in support.left_out]
    return {"only": support.only or None, "only_at": support.only_at or None, "without": rows}


def possible_effects(d: DiagnosisData) -> dict[str, float]:
    """Candidate key -> probability beside the discrepancy that explains the data: "unexplained", "partly identified".

    Effects that are named or below `POSSIBLE` are left out, and all if noise explains no set's misfit beside it.
    """
    leading = d.robustness.models[0] if d.robustness is not None else None
    if d.verdict not in (UNEXPLAINED, PARTLY) or leading is None or leading.refuted or not leading.fits:
        return {}
    named = {member.key for member in d.best.members} if d.verdict == PARTLY else set()
    return {key: min(share, 1.0) for key, share in leading.named.items() if share >= POSSIBLE and key not in named}


def discrepancy_rows(d: DiagnosisData) -> list[dict[str, Any]]:
    """Effects beside every discrepancy model, the most probable model first; parameters in SI. Empty without a gap.

    Other strain laws that were tried come last; they have no probability.
    """
    unknowns = {unknown.key: unknown for each in d.candidates for unknown in each.unknowns}
    return [
        {
            "name": model.name,
            "size_K": model.size,
            "allows_for": model.words,
            "probability": model.probability,
            "p_value": model.p_value,
            "effects": {key: min(share, 1.0) for key, share in model.named.items() if share >= LEAST},
            "parameters": {
                key: {"value": unknowns[key].value(x), "sd": sd, "unit": unknowns[key].unit}
                for key, (x, sd) in ((key, model.stated(key)) for key in model.values)
                if key in unknowns
            },
        }
        for model in ((*d.robustness.models, *d.robustness.laws) if d.robustness else ())
    ]
