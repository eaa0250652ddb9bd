"""Effects beside discrepancy models, as plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tyrefem.diagnose.verdict import PARTLY

if TYPE_CHECKING:
    from tyrefem.diagnose.candidates import Candidate
    from tyrefem.diagnose.diagnosis import DiagnosisData

#: Effects below this probability are left out of a row.
LEAST = 0.01


def effect_probability(d: DiagnosisData, member: Candidate) -> float:
    """Probability that an effect acts; of a partly identified one the smallest over the discrepancy models."""
    if d.verdict == PARTLY and d.robustness is not None:
        return d.robustness.least(member.key)
    return d.judgement.named.get(member.key, 0.0)


def discrepancy_rows(d: DiagnosisData) -> list[dict[str, Any]]:
    """Effects beside every discrepancy model, the most probable model first; parameters in SI. Empty without a gap."""
    unknowns = {unknown.key: unknown for each in d.candidates for unknown in each.unknowns}
    return [
        {
            "name": model.name,
            "size_K": model.size,
            "allows_for": model.words,
            "probability": model.probability,
            "p_value": model.p_value,
            "effects": {key: share for key, share in model.named.items() if share >= LEAST},
            "parameters": {
                key: {"value": unknowns[key].value(x), "sd": sd, "unit": unknowns[key].unit}
                for key, (x, sd) in model.values.items()
                if key in unknowns
            },
        }
        for model in (d.robustness.models if d.robustness else ())
    ]
