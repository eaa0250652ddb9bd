"""Quick cases that are simulated and fitted: their readings, verdicts, and what is kept of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hidden import Case
from numpy.typing import NDArray
from typer.testing import CliRunner

from tyrefem.cli import app
from tyrefem.diagnose.blind import fitted_cases as module
from tyrefem.diagnose.blind.fitted_cases import SETTINGS, FittedLayout, fitted_case, fitted_cases
from tyrefem.diagnose.data.sensitivities import Sensitivities
from tyrefem.diagnose.forward.evaluations import evaluating
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.layout.calibration import calibrated
from tyrefem.diagnose.layout.quick_cases import DrawnCause, QuickCase, quick_case, readings


@pytest.fixture
def layout(case: Case, known: Sensitivities) -> FittedLayout:
    return FittedLayout(case.study, known, 1)


def cause(layout: FittedLayout, key: str, share: float, heat: float = 0.0) -> DrawnCause:
    """An effect and all base numbers at a share of their sd, and every patch of heat in all runs."""
    place = next(n for n, members in enumerate(layout.linear.sets) if [each.key for each in members] == [key])
    members = layout.linear.sets[place]
    unknowns = [*layout.linear.design.unknowns[: layout.linear.design.nuisance], *members[0].amplitudes]
    values = {unknown: share * unknown.sd for unknown in unknowns}
    return DrawnCause(place, members, values, heat * np.ones(len(layout.linear.heat_sd) if heat else 0))


def drawn_readings(layout: FittedLayout, chosen: DrawnCause, patch: pytest.MonkeyPatch) -> list[NDArray[np.float64]]:
    """Whitened readings of a cause with noise, by run."""
    patch.setattr(module, "drawn", lambda _layout, _rng: chosen)
    with evaluating(ForwardModel(layout.study, layout.known.drives, settings=SETTINGS)) as evaluations:
        _, residuals = layout.drawn_residuals(evaluations, np.random.default_rng(3))
    return [drive.whitened(drive.measured) for drive in residuals.runs]


@pytest.mark.parametrize("heat", [0.0, 0.02])
def test_readings_of_a_small_cause_are_linear(
    layout: FittedLayout, heat: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    some, none = cause(layout, "hot-road", 0.02, heat), replace(cause(layout, "hot-road", 0.0), members=())
    # The noise is the same.
    pairs = zip(drawn_readings(layout, some, monkeypatch), drawn_readings(layout, none, monkeypatch), strict=True)
    change = [one - other for one, other in pairs]
    rng = np.random.default_rng(4)
    noiseless = np.array(readings(layout.linear, some, rng)[0]) - np.random.default_rng(4).normal(
        size=len(layout.linear.design.jacobian)
    )
    of_fitted = np.concatenate([change[number] for number in layout.known.fitted])
    assert np.abs(noiseless).max() > 0.1
    assert np.abs(of_fitted - noiseless).max() < 0.03 * np.abs(noiseless).max()


def test_readings_scatter_as_stated(layout: FittedLayout, monkeypatch: pytest.MonkeyPatch) -> None:
    none = replace(cause(layout, "hot-road", 0.0), members=())
    (drive, *_) = layout.known.drives
    noise = drawn_readings(layout, none, monkeypatch)[0] - drive.whitened(layout.known.computed[0])
    correction = drive.whitened(layout.known.correction[0])
    z = noise - correction
    # chi-squared of n independent standard normal numbers: n +- 4 sqrt(2 n).
    assert abs(z @ z - len(z)) < 4 * np.sqrt(2 * len(z))


def test_a_strong_cause_is_identified(layout: FittedLayout, monkeypatch: pytest.MonkeyPatch) -> None:
    chosen = cause(layout, "hot-road", 0.2)
    (road,) = chosen.members[0].amplitudes
    chosen.values[road] = 1.5 * road.sd
    monkeypatch.setattr(module, "drawn", lambda _layout, _rng: chosen)
    with evaluating(ForwardModel(layout.study, layout.known.drives, settings=SETTINGS)) as evaluations:
        judged = fitted_case(layout, evaluations, 0)
    assert (judged.hidden, judged.verdict, judged.best, judged.right) == (("hot-road",), "identified", "hot-road", True)
    assert 0.001 < judged.amplitude_ranks[0] < 0.999
    assert judged.of_truth > 0.8


def test_finished_cases_are_kept(
    case: Case, known: Sensitivities, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ran: list[int] = []

    def quick(layout: FittedLayout, _evaluations: object, number: int) -> QuickCase:
        ran.append(number)
        return quick_case(layout.linear, np.random.default_rng([layout.seed, number]))

    monkeypatch.setattr(module, "fitted_case", quick)
    first = fitted_cases(case.study, known, 2, 5, tmp_path)
    again = fitted_cases(case.study, known, 3, 5, tmp_path)
    assert ran == [0, 1, 2]
    assert [each.leading for each in again[:2]] == [each.leading for each in first]
    result = calibrated(case.study, known, 3, 5, fitted=again)
    assert result.to_dict()["fitted"] is True
    assert result.words()[0].startswith("3 fitted cases of study, seed 5")


def test_fitted_needs_a_number_of_cases(case: Case, tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["isolability", str(case.study.file), "--fitted", "--out", str(tmp_path / "out")])
    assert str(result.exception) == "--fitted: needs --calibrate, the number of cases"
    assert not (tmp_path / "out").exists()
