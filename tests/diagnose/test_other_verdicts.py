"""The page and the record of verdicts other than "identified", drawn from one diagnosis judged otherwise."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hidden import Case

from tyrefem.diagnose import DiagnosisData
from tyrefem.diagnose.heat_words import NOT_CLEAR
from tyrefem.diagnose.result_tables import competing_sets, inclusion_probability
from tyrefem.diagnose.verdict import CONFOUNDED, IDENTIFIED, NO_GAP, UNEXPLAINED, RankedSet
from tyrefem.diagnose.words import verdict_words

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


def test_confounded_names_the_rivals_and_what_would_decide(case: Case, tmp_path: Path) -> None:
    d = confounded(case.diagnosis)
    # The hot road with an idle effect beside it is no rival of the hot road, but speaks for it.
    assert [unknown.key for unknown in competing_sets(d)] == ["hot-road", "sun"]
    assert inclusion_probability(d, competing_sets(d)[0]) == pytest.approx(0.74)
    d.save(tmp_path)
    record = json.loads((tmp_path / "verdict.json").read_text(encoding="utf-8"))
    rivals = {row["name"]: row["confounded_with"] for row in record["candidates"] if row["runs"] is None}
    assert rivals["hot-road"] == ["sun"]
    assert rivals["sun"] == ["hot-road"]
    assert rivals["sensor-offset"] == []
    assert record["next_experiment"]["sensors"][0]["largest_K"] == 2.5
    assert [unknown["name"] for unknown in record["effects"]] == ["hot-road"]
    words = " ".join(verdict_words(d))
    assert "cannot show which: hot-road (74 %), or sun (25 %)" in words
    assert "A thermocouple at s = 0 mm, outside" in words
    assert "twice the speed" not in words
    page = (tmp_path / "diagnosis.html").read_text(encoding="utf-8")
    assert words.split(". ")[0] in page
    assert not (tmp_path / "missing-heat.png").exists()


def test_unexplained_draws_the_missing_heat_and_names_nothing(case: Case, tmp_path: Path) -> None:
    d = case.diagnosis
    outside = RankedSet((), 0.0, 0.97, None, outside=True)
    judged = replace(
        d.judgement, verdict=UNEXPLAINED, ranking=(outside, *d.judgement.ranking), credible=(outside,), named={}
    )
    missing = replace(
        d.missing, flux=np.full_like(d.missing.flux, 10.0), flux_sd=np.full_like(d.missing.flux, 50.0),
        heat=np.full_like(d.missing.heat, 2e4), heat_sd=np.full_like(d.missing.heat, 1e3),
        station=float(d.missing.stations[0]), region="tread",
    )  # fmt: skip
    d = replace(d, judgement=judged, missing=missing, best=d.null)
    d.save(tmp_path)
    record = json.loads((tmp_path / "verdict.json").read_text(encoding="utf-8"))
    assert record["effects"] == []
    assert record["missing_heat"]["kind"] == "heat"
    assert len(record["missing_heat"]["runs"]) == 2
    assert record["missing_heat"]["runs"][0]["heat_W_m3"] == [2e4] * len(missing.stations)
    words = verdict_words(d)
    assert words[0] == "No effect in the catalogue explains the deviation."
    # The patch fills the thickness, so no layer is named.
    assert words[1].startswith("Heat is missing in the crown (s = ")
    assert "all layers: +20.0 ± 1.0 kW/m³, while the tyre rolls" in words[1]
    assert "tread" not in words[1]
    sink = replace(d, missing=replace(missing, heat=-missing.heat))
    assert verdict_words(sink)[1].startswith("The model has too much heat, cooling is missing, in the crown")
    weak = replace(d, missing=replace(missing, heat=missing.heat_sd * 1.9))
    assert verdict_words(weak)[1] == f"{NOT_CLEAR}."
    for name in ("missing-heat.png", "missing-heat-stations.png"):
        assert (tmp_path / name).stat().st_size > 10_000


@pytest.mark.parametrize("verdict", [IDENTIFIED, CONFOUNDED, UNEXPLAINED, NO_GAP])
def test_what_stands_behind_the_verdict_does_not_begin_with_it_again(verdict: str, case: Case) -> None:
    d = replace(case.diagnosis, judgement=replace(case.diagnosis.judgement, verdict=verdict))
    assert not verdict_words(d)[0].lower().startswith(verdict)
