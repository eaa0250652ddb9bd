"""Records of fitted cases (benchmarks/calibration.py): finished ones are kept, and not run again."""

from __future__ import annotations

import json
from pathlib import Path

from script_module import script_module

from tyrefem.diagnose.blind.kept_cases import kept_cases
from tyrefem.diagnose.layout.quick_cases import QuickCase

ROW = {
    "hidden": ["hot-road"], "outside": False, "verdict": "identified", "best": "hot-road", "stated": 0.98765432,
    "right": True, "of_truth": 0.98765432, "before_truth": 0.0, "effect_leads": True,
    "leading": [0.98765432, 0.01234567, 1e-10], "inclusion": [[0.98, True]], "amplitude_ranks": [0.5], "base_rank": 0.5,
    "p_value": 0.5,
}  # fmt: skip


def test_recorded_cases_are_finished_cases(tmp_path: Path) -> None:
    module = script_module("benchmarks/calibration.py")
    first, second, records = tmp_path / "first", tmp_path / "second", tmp_path / "records.jsonl"
    module.restore(records, first, "tag")
    for number in (3, 0):
        (first / f"tag-{number:05d}.json").write_text(json.dumps(ROW), encoding="utf-8")
    (first / "other-00001.json").write_text(json.dumps(ROW), encoding="utf-8")
    module.record(records, first, "tag")
    assert [json.loads(line)["number"] for line in records.read_text(encoding="utf-8").splitlines()] == [0, 3]
    # A case that ran again keeps its new row.
    second.mkdir()
    (second / "tag-00003.json").write_text(json.dumps(ROW | {"verdict": "confounded"}), encoding="utf-8")
    module.restore(records, second, "tag")
    rows = kept_cases(second, "tag")
    assert {number: row["verdict"] for number, row in rows.items()} == {0: "identified", 3: "confounded"}
    assert rows[0]["leading"] == [0.98765, 0.012346]
    assert QuickCase.of_row(rows[0]).verdict == "identified"
