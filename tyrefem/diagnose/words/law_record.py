"""The law of missing heat as plain data for programs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from tyrefem.diagnose.law.places import UNITS
from tyrefem.diagnose.words.draft_effect import EFFECTS, draft_effects
from tyrefem.diagnose.words.law import law_formula, law_place_words, law_words

if TYPE_CHECKING:
    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.law.search import RankedPlace


def law_record(d: DiagnosisData) -> dict[str, Any] | None:
    """The law of the missing heat; null without a clear source.

    ``holds``: whether one law describes the heat in all fitted runs. ``lead_nats``: ln evidence over sources with a
    free strength in every run; ``share``: its gain over theirs. ``exponents``: of every variable that varies, those of
    the law first; ``told_by_runs`` is false where the runs leave the prior almost as it was. ``places``: the places
    that competed. ``signatures``: effects and mechanisms, most alike first. ``draft_effect``: file of the draft effect.
    """
    heat = d.law
    if heat is None:
        return None
    law, first = heat.law, heat.ranking[0]
    return {
        "sentences": [f"{sentence}." for sentence in law_words(d)],
        "holds": heat.holds,
        "lead_nats": heat.lead,
        "share": heat.share,
        **_place(d, first),
        "exponents": [
            {
                "name": entry.name,
                "in_law": entry.name in law.fit.terms,
                "mean": entry.mean,
                "sd": entry.sd,
                "probability": entry.probability,
                "told_by_runs": entry.narrowed,
                "reference": entry.reference,
            }
            for entry in law.exponents
        ],
        "switch": law.fit.switch.kind,
        "switch_probabilities": dict(law.switch_probabilities),
        "time_s": law.time,
        "time_sd_s": law.time_sd,
        "alternatives": [
            {"terms": dict(zip(fit.terms, map(float, fit.mean), strict=True)), "switch": fit.switch.kind,
             "log_evidence_below_best": below}
            for fit, below in law.alternatives
        ],
        "hardly_vary": list(law.hardly),
        "vary_together": [list(pair) for pair in law.together],
        "signatures": [
            {
                "name": row.name,
                "kind": "effect" if row.effect else "mechanism",
                "likeness": row.likeness,
                "log_evidence_below_best": row.below,
                "station_m": row.station,
                "where": row.where,
                "exponents": dict(row.exponents),
            }
            for row in d.signatures
        ],
        "draft_effect": next((f"{EFFECTS}/{name}" for name in draft_effects(d)), None),
        "places": [_place(d, entry) | {"law": law_formula(entry.law)} for entry in heat.ranking],
    }  # fmt: skip


def _place(d: DiagnosisData, entry: RankedPlace) -> dict[str, Any]:
    """A place with the amplitude of its best law at the references."""
    unit = {"W/m**3": "W_m3", "W/m**2": "W_m2", "1": "1"}[UNITS[entry.place.kind]]
    return {
        "place": law_place_words(d, entry.place),
        "kind": entry.place.kind,
        "where": entry.place.where,
        "station_m": entry.place.station,
        f"amplitude_{unit}": entry.law.amplitude,
        f"amplitude_sd_{unit}": entry.law.sd,
        "other_sources": len(entry.others),
        "log_evidence_below_best": entry.below,
    }
