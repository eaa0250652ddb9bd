"""Long work is warned of, with its minutes, before it begins; short work is not."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import pytest

import tyrefem
from tyrefem.cli import main
from tyrefem.diagnose.forward.effort import CASE, check_effort
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.layout.planned_runs import planned
from tyrefem.errors import InputError
from tyrefem.estimates.work import LongWorkWarning, warn_if_long
from tyrefem.mechanics.footprint.press import press
from tyrefem.realtime.certificate import export
from tyrefem.sweep.sweep import sweep
from tyrefem.variants.plan import plan_of

NASA = "nasa-22x5.5-8pr"
STOP = "work begins"
BEGINNINGS = (
    "simulation.run.simulate",
    "sweep.evaluation.VariantEvaluation._train_model", "sweep.evaluation.VariantEvaluation._run_in_full",
    "realtime.certificate.RollingTyre", "diagnose.blind.rates.evaluating", "mechanics.solid.inflation.inflate",
)  # fmt: skip


@pytest.fixture(autouse=True)
def work_stops(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever was about to begin is an error; the machine has memory for all of it."""

    def begun(*_given: Any, **_named: Any) -> None:
        raise InputError(STOP)

    for place in BEGINNINGS:
        monkeypatch.setattr(f"tyrefem.{place}", begun)
    monkeypatch.setattr("tyrefem.estimates.memory.free_memory", lambda: 64.0 * 2**30)


@pytest.mark.parametrize(
    ("seconds", "words"), [(601.0, "10 minutes"), (5400.0, "90 minutes"), (86400.0, "24 hours"), (1e7, "120 days")]
)
def test_how_long_is_said_in_fitting_units(seconds: float, words: str) -> None:
    with pytest.warns(LongWorkWarning, match=f"work will take about {words}$"):
        warn_if_long(seconds, "work")


def test_ten_minutes_are_not_long() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_if_long(600.0, "work")


RANGE = {"drive.speed": ("10 mph", "40 mph")}
#: Nine footprints.
RAMP = {"from": "1 kN", "to": "4825 N"}


@pytest.mark.parametrize(
    ("work", "words"),
    [
        (
            lambda _: tyrefem.study(NASA, {"numerics.tolerance": "2e-11 K", "mesh.size": "2 mm"}).run(),
            r"of nasa-22x5.5-8pr \(9,\d+ unknowns, 4\d,\d+ time steps, 134 readings\) will take about 16 minutes",
        ),
        (
            lambda _: tyrefem.study("passenger-205-55r16", {"mesh.size": "1.3 mm", "drive.load": RAMP}).run(),
            r"most of it strain cycles by finite elements\) will take about \d+ minutes"
            r'; mechanics.motion = "linear" is the quick look: \d+ s',
        ),
        (
            lambda _: press(tyrefem.study(NASA, {"mesh.size": "0.38 mm"}), motion="large"),
            r'footprint of .* minutes; mechanics.motion = "linear" is the quick look',
        ),
        (
            lambda _: sweep(plan_of(tyrefem.study(NASA), {"drive.speed": ("1 mph", "40 mph", 2000)}), reduced="never"),
            "2,000 variants of nasa-22x5.5-8pr will take about 30 minutes",
        ),
        (
            lambda _: sweep(plan_of(tyrefem.study(NASA), RANGE, sample="sobol", count=2**18)),
            "will take about 14 minutes by a reduced model, or 3 days by full runs if none can be certified",
        ),
        (
            lambda folder: export(tyrefem.study(NASA), folder / "x.npz", duration=1e6),
            "training and certifying a real-time model of nasa-22x5.5-8pr will take about 3. minutes",
        ),
    ],
)
def test_work(work: Any, words: str, tmp_path: Path) -> None:
    with pytest.warns(LongWorkWarning, match=words), pytest.raises(InputError, match=STOP):
        work(tmp_path)


def test_campaigns() -> None:
    campaign = tyrefem.study("nasa-campaign", {"mesh.size": "0.5 mm"}).campaign()
    with pytest.warns(LongWorkWarning, match="19 cases of nasa-campaign will take about 1. minutes"):
        assert next(campaign.runs())[1] == STOP


def test_blind_cases() -> None:
    study = tyrefem.study("hidden-effect")
    bench = ForwardModel(study, planned(study))
    with pytest.warns(LongWorkWarning, match="10,000 blind cases will take about 2 days"):
        check_effort(bench, "10,000 blind cases", 10_000 * CASE, workers=2)


@pytest.mark.parametrize(
    "work",
    [
        lambda _: tyrefem.study(NASA).run(),
        lambda _: press(tyrefem.study(NASA)),
        lambda _: sweep(plan_of(tyrefem.study(NASA), {"drive.speed": ("1 mph", "40 mph", 20)})),
        lambda _: sweep(plan_of(tyrefem.study(NASA), RANGE, sample="sobol", count=4096)),
        lambda folder: export(tyrefem.study(NASA), folder / "x.npz"),
    ],
)
def test_usual_work_is_begun_without_a_word(work: Any, tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(InputError, match=STOP):
            work(tmp_path)


def test_usual_diagnoses_and_campaigns_are_not_long() -> None:
    study = tyrefem.study("hidden-effect")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_effort(ForwardModel(study, planned(study)), "a diagnosis", 1.0)
        check_effort(ForwardModel(study, planned(study)), "blind cases", 20 * CASE, workers=2)
        assert next(tyrefem.study("nasa-campaign").campaign().runs())[1] == STOP


def test_the_command_line_warns_in_one_line_before_it_begins(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["run", NASA, "--set", "numerics.tolerance=2e-11 K", "--set", "mesh.size=2 mm"]) == 2
    first, last = capfd.readouterr().err.splitlines()
    assert first.startswith("tyrefem: warning: a run of nasa-22x5.5-8pr (")
    assert first.endswith(" will take about 16 minutes")
    assert last == f"tyrefem: {STOP}"


def test_the_command_line_says_nothing_of_usual_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["run", NASA]) == 2
    assert capfd.readouterr().err == f"tyrefem: {STOP}\n"
