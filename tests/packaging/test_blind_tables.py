"""The tables of blind cases: written from the case files, and the page's table of goals with them."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest
from script_module import script_module

import tyrefem as tf
from tyrefem.diagnose.blind.rates import Blind, tag_of

ROOT = Path(__file__).resolve().parents[2]
MODEL = {"strain_law": None, "strain_modes_rms": 0.25, "film_speed_exponents": {}}


def case(number: int, **more: Any) -> dict[str, Any]:
    return {
        "number": number, "kind": "one", "hidden": ["sun"], "verdict": "identified", "named": ["sun"], "set": ["sun"],
        "identifiable": True, "amplitude": {"sun": 2.0}, "probability": 0.97, "best": "sun", "reasons": ["the reason"],
        "held_out_rms_K": {"before": 4.0, "after": 0.55}, "noise_K": 0.5, "missing_station_m": 0.1, "station_m": 0.1,
        "length_m": 0.15, "rms_K": {"before": 4.0, "after": 0.6}, "leading": [["sun", 0.97]], "other_model": MODEL,
    } | more  # fmt: skip


def test_tables_picture_and_page_come_from_the_case_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = script_module("benchmarks/blind_tables.py")
    folder = tmp_path / "cases"
    folder.mkdir()
    wrong = case(1, named=["leak"], set=["leak"], other_model=MODEL | {"strain_law": "barrel"})
    for row in (wrong, case(0)):
        (folder / f"tag-{row['number']:05d}.json").write_text(json.dumps(row), encoding="utf-8")
    page = tmp_path / "page.md"
    begin, end = module.BEGIN.format(name="structural"), module.END.format(name="structural")
    page.write_text(f"# Page\n\n{begin}\n\nold\n\n{end}\n\nafter\n", encoding="utf-8")
    for name, place in (("PAGE", page), ("TABLES", tmp_path), ("PICTURES", tmp_path)):
        monkeypatch.setattr(module, name, place)
    rows = module.finished(folder)
    assert [row["number"] for row in rows] == [0, 1]
    benchmark, records = script_module("benchmarks/blind.py"), tmp_path / "records.jsonl"
    benchmark.record(records, {7: case(7), 1: case(1)}, folder.glob("*.json"))
    assert [row["number"] for row in module.finished(records)] == [0, 1, 7]
    assert benchmark.recorded(records)[1] == wrong
    module.write(Blind("s", 7, rows, data_model="structural"))
    text = page.read_text(encoding="utf-8")
    assert "old" not in text
    assert text.endswith(f"{end}\n\nafter\n")
    assert "2 cases, seed 7: 2 with one hidden effect" in text
    assert "| all cases: confident wrong name | 1 of 2 | 50 % (9 to 91) | at most 2 % |" in text
    with (tmp_path / "diagnosis-blind-structural-failures.csv").open(encoding="utf-8") as file:
        (failure,) = csv.DictReader(file)
    assert (failure["case"], failure["strain energy"], failure["named"]) == ("1", "barrel", "leak")
    assert failure["fault"] == "a hidden effect is not in the reported set; named, but not hidden: leak"
    assert (tmp_path / "blind-structural.png").stat().st_size > 10_000


def test_cases_of_another_test_in_the_same_folder_are_not_recorded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    benchmark, records = script_module("benchmarks/blind.py"), tmp_path / "records.jsonl"
    finished = {number: case(number) for number in (0, 1)}
    benchmark.record(records, finished, [])
    out = tmp_path / "out"
    (out / "cases").mkdir(parents=True)
    options = {"reduced": "auto", "truth": "ordinary"}
    tags = [tag_of(tf.study("hidden-effect"), 2, seed, **options) for seed in (3, 4)]
    for tag, verdict in zip(tags, ("no gap", "unexplained"), strict=True):
        (out / f"cases/{tag}-00001.json").write_text(json.dumps(case(1, verdict=verdict)), encoding="utf-8")
    words = ["--cases", "2", "--seed", "3", "--out", str(out), "--records", str(records), "--workers", "1"]
    monkeypatch.setattr("sys.argv", ["blind.py", *words])
    benchmark.main()
    assert benchmark.recorded(records) == {0: finished[0], 1: case(1, verdict="no gap")}


def test_the_page_has_the_places_that_the_script_fills() -> None:
    module = script_module("benchmarks/blind_tables.py")
    text = (ROOT / module.PAGE).read_text(encoding="utf-8")
    for name in ("ordinary", "structural"):
        assert text.count(module.BEGIN.format(name=name)) == 1
        assert text.index(module.BEGIN.format(name=name)) < text.index(module.END.format(name=name))
