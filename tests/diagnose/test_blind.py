"""Blind cases: the truth is made otherwise than it is analysed, seeded, and kept when it is done."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.diagnose.blind import rates as blind_rates
from tyrefem.diagnose.blind.blind_case import KINDS, cases
from tyrefem.diagnose.blind.rates import Blind, BlindTest, Rate
from tyrefem.diagnose.blind.synthetic import backward
from tyrefem.errors import InputError
from tyrefem.reports import blind as blind_picture
from tyrefem.simulation.rolling_tyre import RollingTyre


def test_the_truth_s_own_time_integration_agrees_with_the_solver() -> None:
    study = tf.study("example-validation").replace({"mesh.size": "6 mm", "mesh.element": "P1"})
    tyre = RollingTyre(study)
    times = np.linspace(0.0, 1200.0, 601)
    values, gas = backward(tyre.problem, times, 25.0)
    exact = tyre.problem.transient(times, 25.0, 0.002, breakpoints=[600.0])
    # Just after a jump its first step is of first order only.
    settled = (np.mod(times, 600.0) > 60.0) | (times == 600.0)
    assert np.abs(values - exact.values)[settled].max() < 0.1
    assert np.abs(gas[:, 0] - exact.reservoirs["contained-air"]).max() < 0.05
    # Second order: half the step leaves about a quarter.
    finer, _ = backward(tyre.problem, np.linspace(0.0, 1200.0, 1201), 25.0)
    coarse, fine = (np.abs(result[-1] - exact.values[-1]).max() for result in (values, finer))
    assert fine < 0.5 * coarse + 0.003


def test_cases_are_seeded_and_of_every_kind() -> None:
    study = tf.study("hidden-effect")
    first, again, other = cases(study, 60, 3), cases(study, 60, 3), cases(study, 60, 4)
    assert [item.names for item in first] == [item.names for item in again]
    assert first[0].values == again[0].values
    assert [item.names for item in first] != [item.names for item in other]
    for kind, share in KINDS.items():
        assert abs(sum(item.kind == kind for item in first) - 60 * share) <= 3
    for item in first:
        assert all(unknown.low <= x <= unknown.high for unknown, x in item.values.items())
        assert len(item.hidden) == {"one": 1, "two": 2, "none": 0, "outside": 0}[item.kind]


def test_wilson_intervals() -> None:
    # Agresti & Coull 1998: 0 of 10 gives 0 to 0.278.
    assert Rate(0, 10).interval == pytest.approx((0.0, 0.2775), abs=1e-3)
    assert Rate(0, 0).interval == (0.0, 1.0)


def _row(kind: str, hidden: list[str], verdict: str, named: list[str], **more: Any) -> dict[str, Any]:
    common = {
        "kind": kind, "hidden": hidden, "verdict": verdict, "named": named, "set": named or ["no effect"],
        "identifiable": bool(hidden), "amplitude": dict.fromkeys(hidden, 2.0), "probability": 0.97, "best": "",
        "held_out_rms_K": {"before": 4.0, "after": 0.55}, "noise_K": 0.5, "missing_station_m": 0.1, "station_m": 0.1,
        "length_m": 0.15,
    }  # fmt: skip
    return common | more


def test_rates_count_what_they_say() -> None:
    rows = (
        _row("one", ["sun"], "identified", ["sun"]),
        _row("one", ["sun"], "identified", ["leak"]),
        _row("one", ["sun"], "confounded", [], set=["sun", "leak"]),
        _row("none", [], "no gap", []),
        _row("none", [], "identified", ["sun"]),
        _row("outside", ["stranger"], "unexplained", [], station_m=0.02),
        _row("two", ["sun", "leak"], "identified", ["leak", "sun"]),
    )
    rates = Blind("s", 1, rows).rates
    got = {name: (rate.right, rate.of) for name, rate in rates.items()}
    assert got["identifiable: named correctly"] == (1, 3)
    assert got["identifiable: true effect in the reported set"] == (2, 3)
    assert got["one effect: wrong name"] == (1, 3)
    assert got["no effect: no gap"] == (1, 2)
    assert got["outside the catalogue: unexplained"] == (1, 1)
    assert got["outside the catalogue, unexplained: place right"] == (0, 1)
    assert got["two effects: both named"] == (1, 1)
    assert got["strong and identifiable: held-out gap shrunk 3 times"] == (3, 3)
    assert got["verdicts 'identified': right"] == (2, 4)


def test_finished_cases_are_not_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study, ran = tf.study("hidden-effect"), []

    def case(test: BlindTest, number: int) -> dict[str, Any]:
        ran.append(number)
        if len(ran) == 3:
            raise KeyboardInterrupt
        return _row("none", [], "no gap", [])

    monkeypatch.setattr(blind_rates, "_case", case)
    monkeypatch.setattr(blind_rates, "responses", lambda evaluations, unknowns: ())
    with pytest.raises(KeyboardInterrupt):
        blind_rates.run_blind(study, 4, 7, tmp_path)
    assert not (tmp_path / "blind.json").exists()
    result = blind_rates.run_blind(study, 4, 7, tmp_path)
    blind_picture.save(result, tmp_path)
    assert ran == [0, 1, 2, 2, 3]
    assert result.rates["no effect: no gap"].right == 4
    assert (tmp_path / "blind.json").is_file()
    # Rows of an earlier test count as finished, too.
    known = {number: _row("none", [], "no gap", []) for number in (0, 2)}
    blind_rates.run_blind(study, 3, 8, tmp_path, finished=known)
    assert ran[5:] == [1]
    # Some cases alone.
    result = blind_rates.run_blind(study, 3, 9, tmp_path, only=[2, 0])
    assert ran[6:] == [0, 2]
    assert len(result.rows) == 2
    with pytest.raises(InputError, match="there is no case 3; the cases are 0 to 2"):
        blind_rates.run_blind(study, 3, 9, tmp_path, only=[3])
