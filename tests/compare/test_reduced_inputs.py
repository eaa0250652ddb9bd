"""Uncertain inputs by a reduced model: the same u_input as by full runs, and full runs where it does not hold."""

from __future__ import annotations

from concurrent.futures import Executor
from pathlib import Path

import numpy as np
import pytest

from tyrefem.api import Study, study
from tyrefem.compare import ComparisonData
from tyrefem.compare.reduced_inputs import ReducedInputCertificate, ReducedInputSettings
from tyrefem.errors import InputError
from tyrefem.processes import processes
from tyrefem.reduced.pod import modes
from tyrefem.reduced.training import ReducedFineness

#: Coarse in space and time.
QUICK = {"mesh.size": "9 mm", "mesh.element": "P1", "numerics.tolerance": "0.05 delta_degC", "output.every": "20 s"}


@pytest.fixture(scope="module")
def quick() -> Study:
    return study("example-validation").replace(QUICK)


@pytest.mark.parametrize(("cases", "words"), [(1, "; 1 full run differs from"), (3, "; 3 full runs differ from")])
def test_a_certificate_in_words(cases: int, words: str) -> None:
    assert words in ReducedInputCertificate(0.01, 0.1, cases, 2, 1, 0).sentence


class Counting(Executor):
    """Runs here, and counts the full runs."""

    def __init__(self) -> None:
        self.full = 0

    def map(self, function, *given, **_):
        for each in zip(*given, strict=True):
            self.full += function.__name__ in ("base_run", "training_run", "full_run")
            yield function(*each)


@pytest.fixture(scope="module")
def table(quick: Study) -> Path:
    """One run of one drive: fourteen inputs."""
    return Path(quick.measured[0].table)


@pytest.fixture(scope="module")
def counting() -> Counting:
    return Counting()


@pytest.fixture(scope="module")
def reduced(quick: Study, table: Path, counting: Counting) -> ComparisonData:
    return quick.compare(table, executor=counting)


@pytest.fixture(scope="module")
def full(quick: Study, table: Path) -> ComparisonData:
    return quick.compare(table, reduced="never")


def test_reduced_inputs_are_those_of_full_runs(reduced: ComparisonData, full: ComparisonData) -> None:
    certificate = reduced.reduced
    assert certificate is not None
    assert certificate.worst <= 0.8 * certificate.tolerance
    assert list(reduced.inputs["key"]) == list(full.inputs["key"])
    # Means of readings: no more than any reading may be off by, in all runs that no certificate has seen.
    np.testing.assert_allclose(reduced.inputs["change_K"], full.inputs["change_K"], rtol=0, atol=certificate.tolerance)
    np.testing.assert_allclose(reduced.table["u_input_K"], full.table["u_input_K"], rtol=0, atol=certificate.tolerance)
    # What is not about inputs is from the same full runs.
    np.testing.assert_allclose(reduced.residuals["error_K"], full.residuals["error_K"], rtol=0, atol=1e-9)
    assert list(reduced.table["verdict"]) == list(full.table["verdict"])


def test_few_runs_are_full_and_the_comparison_says_so(
    reduced: ComparisonData, full: ComparisonData, counting: Counting
) -> None:
    certificate = reduced.reduced
    assert certificate is not None
    assert counting.full == 1 + certificate.full <= 7
    assert certificate.reduced + certificate.full == 14
    assert reduced.to_dict()["reduced"]["worst"] == certificate.worst
    assert any("reduced model" in note for note in reduced.notes)
    assert full.to_dict()["reduced"] is None


def test_what_does_not_hold_is_run_in_full(quick: Study, table: Path) -> None:
    """No model can be so near: every run is made, and none twice."""
    rough, counting = quick.replace({"numerics.tolerance": "1 delta_degC"}), Counting()
    comparison = rough.compare(table, executor=counting, settings=ReducedInputSettings(safety=1e-9))
    assert comparison.reduced is None
    assert counting.full == 15
    assert comparison.inputs["key"].nunique() == 14
    assert any("full runs" in note for note in comparison.notes)


def test_one_model_for_all_drives_and_in_processes(quick: Study, full: ComparisonData) -> None:
    with processes(2) as pool:
        comparison = quick.compare(executor=pool)
    assert comparison.reduced is not None
    assert comparison.reduced.reduced >= 36
    first = comparison.inputs[comparison.inputs["run"] == full.inputs["run"].iloc[0]]
    np.testing.assert_allclose(first["change_K"], full.inputs["change_K"], rtol=0, atol=comparison.reduced.tolerance)


def test_other_words_are_refused(quick: Study) -> None:
    with pytest.raises(InputError, match="never"):
        quick.compare(reduced="always")


def test_a_pattern_of_one_input_in_a_hundred_has_a_mode() -> None:
    """The rms over the fields of all inputs is a tenth of what one of a hundred adds: a cut there hides it."""
    settings = ReducedInputSettings()
    fields = np.ones((300, 64)) * np.linspace(20.0, 80.0, 300)[:, None]
    pattern = settings.least_tolerance / 20 * np.where(np.arange(64) % 2, 1.0, -1.0)
    fields[:3] += pattern
    fineness = ReducedFineness.of(settings.modes_share * settings.least_tolerance)
    V = modes(fields, np.ones(64), fineness.modes_tolerance, settings.most_modes)
    assert np.abs(pattern - V @ (V.T @ pattern) / 64).max() < 0.01 * np.abs(pattern).max()
