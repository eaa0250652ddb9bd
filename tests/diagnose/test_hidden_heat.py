"""A sink on one sidewall, and heat that begins late: hidden in data, and told by a diagnosis."""

from __future__ import annotations

import json
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from documented_keys import checked
from hidden import COARSE_MESH, FINER_MESH, HASTY, measure, study

from tyrefem.diagnose.verdicts.verdict import IDENTIFIED, PARTLY, UNEXPLAINED
from tyrefem.diagnose.words.heat import inside_share
from tyrefem.diagnose.words.missing_heat import missing_heat_words
from tyrefem.diagnose.words.sentences import verdict_words
from tyrefem.reports.diagnosis_law import leading_signatures
from tyrefem.reports.diagnosis_missing import by_run, drawn_sources

COARSE = replace(HASTY, mesh_size=COARSE_MESH)
PLACE = {"station": "100 mm", "width": "13 mm"}


def test_a_sidewall_that_is_cooled_from_outside_is_a_sink(tmp_path: Path) -> None:
    owner = study(tmp_path / "study", COARSE_MESH)
    measure(owner, [{"name": "missing-flux", **PLACE, "into": "-1500 W/m**2"}], FINER_MESH)
    d = owner.diagnose(settings=COARSE, rerun=False, verdict_only=True)
    assert d.verdict == UNEXPLAINED
    assert d.missing.over_time is not None
    largest = d.missing.over_time.clear[0]
    assert largest.amount < 0
    assert abs(largest.station - 0.1) < 0.02
    assert "The model has too much heat, cooling is missing," in verdict_words(d)[1]
    # These runs do not cool at rest.
    assert not d.missing.over_time.cools


def test_heat_that_begins_late_is_dated_and_its_draft_effect_is_identified(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    owner = study(tmp_path / "study", COARSE_MESH)
    measure(owner, [{"name": "missing-heat", **PLACE, "heat": "400 kW/m**3", "begins": "70 s"}], FINER_MESH)
    d = owner.diagnose(settings=COARSE)
    d.save(tmp_path / "out")
    assert pickle.loads(pickle.dumps(d)).to_dict() == d.to_dict()
    text = (tmp_path / "out" / "verdict.json").read_text(encoding="utf-8")
    checked("diagnose", text)
    missing = json.loads(text)["missing_heat"]
    first = missing["sources"][0]
    assert first["stated"]
    assert first["sign"] == "heat is missing"
    assert abs(first["station_m"] - 0.1) < 0.02
    assert first["course"] == "begins"
    assert first["time_s"] == pytest.approx(70.0, abs=max(3 * first["time_sd_s"], 8.0))
    assert {"kind", "region", "station_m", "stations_m", "watts", "runs"} <= set(missing)
    assert first["sentence"] in verdict_words(d)[1]
    # What the source moves (linear model) is the gap at the sensor: there the amended study's change is the source's.
    moves = first["moves"]
    assert moves["sensor"] == "sidewall-outer"
    largest = max(float(np.abs(d.after[run] - d.before[run]).max()) for run in d.before)
    assert moves["largest_K"] == pytest.approx(largest, rel=0.15)
    stated = drawn_sources(d)
    assert [source.amount for source in stated] == [source.amount for source in d.missing.over_time.clear]
    strength, spread = by_run(stated[0], d.missing.over_time)
    assert np.all(np.abs(strength - stated[0].amount) < 3 * spread)
    # The amended study has the source with its time, and its run explains the readings.
    (effect,) = (entry for entry in d.study.data["effects"] if entry["name"].startswith("missing-"))
    assert float(effect["begins"].split()[0]) == pytest.approx(70.0, abs=8.0)
    assert d.rms(after=True, held_out=False) < 0.5 * d.rms(after=False, held_out=False)
    assert (tmp_path / "out" / "missing-heat-course.png").stat().st_size > 10_000
    assert d.missing.over_time is not None
    # The law: begins, and is the same at every load; the two speeds of the fitted runs are equal.
    law = missing["law"]
    assert law["holds"]
    assert law["switch"] == "begins"
    assert law["time_s"] == pytest.approx(70.0, abs=max(4 * law["time_sd_s"], 8.0))
    assert "speed" in law["hardly_vary"]
    assert ["load", "pressure"] in law["vary_together"]
    assert not any(entry["in_law"] for entry in law["exponents"])
    assert law["amplitude_W_m3"] == pytest.approx(4e5, rel=0.25)
    assert all(sentence in verdict_words(d) for sentence in law["sentences"])
    # Beside a partly identified effect the law is told as that of the heat beside it.
    beside = replace(d, judgement=replace(d.judgement, verdict=PARTLY))
    assert missing_heat_words(beside)[0].startswith("The heat that is missing beside it has a law over these runs: ")
    assert missing_heat_words(beside)[1:] == missing_heat_words(d)[2:]
    rows = {row["name"]: row for row in law["signatures"]}
    assert rows["sun"]["kind"] == "effect"
    # The page shows every mechanism, and every effect by the variant that is most alike.
    shown = leading_signatures(d.signatures)
    assert {row.name for row in d.signatures if not row.effect} <= {row.name for row in shown}
    names = [row.name.split(" (")[0] for row in shown if row.effect]
    assert len(names) == len(set(names)) == len({row.name.split(" (")[0] for row in d.signatures if row.effect})
    assert [row.likeness for row in shown] == sorted((row.likeness for row in shown), reverse=True)
    assert rows["sun"]["likeness"] < 0.9
    assert "The law of the missing heat" in (tmp_path / "out" / "diagnosis.html").read_text(encoding="utf-8")
    # The heat is large beside its prior; the flux would be smaller beside its own. That tells no surface.
    assert first["place"].startswith("in mid sidewall")
    assert first["depth"]["outer surface"] < 0.5
    assert inside_share(d.missing.over_time.sources[0]) == pytest.approx(
        sum(share for where, share in first["depth"].items() if "surface" not in where and where != "rim")
    )
    # The draft effect runs as any other: it is named, and closes the gap in the held-out run, too.
    monkeypatch.setenv("TYREFEM_EFFECTS", "")
    monkeypatch.setenv("TYREFEM_PLUGINS", "")
    (draft,) = (tmp_path / "out" / "effects").glob("*.py")
    assert law["draft_effect"] == f"effects/{draft.name}"
    assert any(f"effects/{draft.name}" in sentence for sentence in verdict_words(d))
    assert "inferred from" in draft.read_text(encoding="utf-8")
    second = owner.diagnose(settings=COARSE, effects=draft.parent, rerun=False, verdict_only=True)
    assert second.verdict == IDENTIFIED
    (member,) = second.best.members
    assert member.name == draft.stem.replace("_", "-")
    fitted = second.best.values[member.amplitudes[0]]
    assert fitted == pytest.approx(4e5, abs=4 * second.best.sd[member.amplitudes[0]])
    assert second.rms(after=True, held_out=True) < 0.3 * second.rms(after=False, held_out=True)
