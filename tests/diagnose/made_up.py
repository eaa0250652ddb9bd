"""Diagnoses judged otherwise than the data say, for words and pages of every verdict."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from tyrefem.diagnose import DiagnosisData
from tyrefem.diagnose.amend import Change
from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, UNEXPLAINED, RankedSet, inclusion

NEXT = {
    "between": ["hot-road", "sun"],
    "sensors": [{"place": "s = 0 mm, outside", "gain": 4.0, "largest_K": 2.5, "run": "slow"}],
    "drives": [
        {
            "drive": "twice the speed", "changes": {"speed": "40 mph"}, "gain": 0.01, "largest_K": 0.1,
            "sensor": "crown-outer",
        },
    ],
}  # fmt: skip


def confounded(d: DiagnosisData) -> DiagnosisData:
    """As if hot road and sun were 60 : 25, and an idle effect beside the hot road took the rest."""
    by_name = {candidate.name: candidate for candidate in d.candidates if not candidate.runs}
    hot, sun, idle = by_name["hot-road"], by_name["sun"], by_name["sensor-offset"]
    fits = {candidate.members: candidate.fit for candidate in d.judgement.ranking}
    sets = [((hot,), 0.6), ((sun,), 0.25), ((hot, idle), 0.14), ((), 0.01)]
    alone = [((candidate,), 0.0) for candidate in d.candidates if candidate not in (hot, sun)]
    result = tuple(
        RankedSet(members, float(np.log(probability + 1e-30)), probability, fits.get(members))
        for members, probability in [*sets, *alone]
    )
    named = {"hot-road": 0.74, "sun": 0.25}
    judged = replace(d.judgement, verdict=CONFOUNDED, ranking=result, credible=result[:3], named=named)
    return replace(d, judgement=judged, next_experiment=NEXT)


def judged(d: DiagnosisData, verdict: str, sets: dict[tuple[str, ...], float], **further: Any) -> DiagnosisData:
    """As if these sets had these probabilities; ``further``: other fields of the judgement."""
    by_name = {candidate.key: candidate for candidate in d.candidates}
    fits = {row.members: row.fit for row in d.judgement.ranking}
    rows = []
    for names, share in sets.items():
        members = tuple(by_name[name] for name in names)
        rows.append(RankedSet(members, float(np.log(share)), share, fits.get(members)))
    given = {row.members for row in rows}
    # Every candidate alone and no effect are among the sets of a diagnosis.
    others = [members for members in ((), *((candidate,) for candidate in d.candidates)) if members not in given]
    left = [RankedSet(members, -1e9, 0.0, fits.get(members)) for members in others]
    judgement = replace(
        d.judgement, verdict=verdict, ranking=(*rows, *left), credible=tuple(rows), named=inclusion(rows), **further
    )
    return replace(d, judgement=judgement)


def unexplained(d: DiagnosisData, spread: float) -> DiagnosisData:
    """As if heat were missing at every station: 20 kW/m3, with this standard deviation."""
    outside = RankedSet((), 0.0, 0.97, None, outside=True)
    judgement = replace(
        d.judgement, verdict=UNEXPLAINED, ranking=(outside, *d.judgement.ranking), credible=(outside,), named={}
    )
    heat = np.full_like(d.missing.heat, 2e4)
    missing = replace(d.missing, kind="heat", heat=heat, heat_sd=np.full_like(heat, spread))
    patch = next(unknown for unknown in d.gap.unknowns if unknown.effect == "missing-heat")
    return replace(
        d, judgement=judgement, missing=missing, best=d.null, changes=(Change(patch, 2e4, spread, True, "test"),)
    )
