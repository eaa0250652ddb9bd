"""`tyrefem slide` from another folder: numbers, JSON, a picture, and refusals in one line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tyrefem.cli import main

PAD = ["--speed", "0.35 m/s", "--length", "225 mm", "--friction", "0.5"]


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("TYREFEM_PATH", raising=False)
    return tmp_path


def printed(capfd: pytest.CaptureFixture[str], *arguments: str) -> Any:
    assert main(["slide", *arguments, "--json"]) == 0
    return json.loads(capfd.readouterr().out)


def test_rise_by_load_is_that_by_pressure(capfd: pytest.CaptureFixture[str]) -> None:
    by_load = printed(
        capfd, "rise", *PAD, "--load", "12.8 kgf", "--breadth", "153 mm", "--behind", "15 mm", "--slid", "1 m"
    )
    assert by_load["rise_behind_K"] == pytest.approx(1.113, abs=1e-3)
    assert by_load["exit_rise_shared_K"] == pytest.approx(by_load["exit_rise_K"] * by_load["share_into_track_at_start"])
    pressure = f"{by_load['contact_pressure_Pa']} Pa"
    assert printed(capfd, "rise", *PAD, "--pressure", pressure)["exit_rise_K"] == pytest.approx(by_load["exit_rise_K"])


def test_tables_as_text_and_json_name_what_does_not_follow(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["slide", "tables", "--out", "wood.png"]) == 0
    assert (here / "wood.png").read_bytes().startswith(b"\x89PNG")
    text = capfd.readouterr().out
    rows = printed(capfd, "tables")["rubber_on_wood"]
    failed = [row["name"] for row in rows if not row["printed_follows"]]
    assert (
        [line.split()[0] for line in text.splitlines() if "does NOT follow" in line]
        == failed
        == ["40x36-slow", "22x15"]
    )


def test_locked_wheel_is_printed_and_drawn(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    record = printed(capfd, "locked-wheel", "--out", "skid.png", "--friction", "0.9")
    assert (here / "skid.png").read_bytes().startswith(b"\x89PNG")
    assert [row["mean_rise_K"] > 200 for row in record["rows"] if row["speed_km_h"] >= 50] == [True] * 5
    rises = [row["uncapped_exit_rise_K"] for row in record["rows"]]
    assert rises == sorted(rises)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["rise", *PAD], "--pressure or --load"),
        (["rise", *PAD, "--load", "10 N"], "--breadth"),
        (["rise", *PAD, "--pressure", "1 m"], "--pressure"),
        (["rise", *PAD, "--pressure", "1 bar", "--track", "iec"], "did you mean 'ice'"),
        (["rise", *PAD, "--pressure", "1 bar", "--slid", "1 mm"], "tyrefem: --slid: "),
        (
            ["rise", *PAD, "--pressure", "1 bar", "--behind", "-1 mm"],
            "tyrefem: --behind: must be finite and at least 0",
        ),
        (
            ["rise", *PAD, "--pressure", "1 bar", "--slid", "30 cm", "--slider", "ice", "--track", "rubber"],
            "tyrefem: --slid: must be 1.04 m or more",
        ),
        (["rise", *PAD, "--pressure", "1 bar", "--breadth", "9 mm"], "tyrefem: --breadth: goes with --load"),
        (["rise", "--speed", "0 m/s", *PAD[2:], "--pressure", "1 bar"], "--speed"),
        (["rise", *PAD[:4], "--friction=-0.5", "--pressure", "1 bar"], "--friction"),
        (["locked-wheel", "--length", "0 mm"], "tyrefem: --length: "),
        (["locked-wheel", "--decomposition", "0 K"], "tyrefem: --decomposition: '0 K' is out of range"),
        (["locked-wheel", "--friction", "0"], "tyrefem: --friction: '0' is out of range: must be at least 1e-06"),
        (["locked-wheel", "--pressure", "1e-300 Pa"], "tyrefem: --pressure: '1e-300 Pa' is out of range"),
        (["locked-wheel", "--out", "skid.gif"], "--out"),
    ],
)
def test_refused_in_one_line(arguments: list[str], words: str, here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["slide", *arguments]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.startswith("tyrefem: ")
    assert err.count("\n") == 1
    assert words in err
    assert not list(here.iterdir())
