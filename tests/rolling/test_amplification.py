"""Heat and strain of a rolling tyre rise with inertia, and with it alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.cli.critical_speed import _rise_words
from tyrefem.errors import InputError
from tyrefem.mechanics.rolling.amplification import Amplification, Onset, amplification
from tyrefem.mechanics.rolling.press import press
from tyrefem.reports.figures.rise import rise_figure

COARSE = {"mesh.size": "16 mm", "mechanics.strain": "fem"}


def study(**changes: Any) -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", COARSE | changes)


@pytest.fixture(scope="module")
def rise() -> Amplification:
    return amplification(study(), 84.0, speeds=[1.0, 25.0, 45.0, 60.0, 90.0])


def test_heat_rises_towards_the_critical_speed(rise: Amplification) -> None:
    losses, strains = (np.array([getattr(each, name) for each in rise.rises]) for name in ("loss", "strain"))
    assert losses[0] == strains[0] == 1.0
    assert (np.diff(losses, n=2) > 0).all()
    assert (np.diff(strains) > 0).all()
    assert losses[2] == pytest.approx(1.17, abs=0.03)
    assert rise.refused is not None
    assert rise.refused[0] == 90.0


def test_its_resistance_is_that_of_a_press(rise: Amplification) -> None:
    changes = {"mechanics.rolling": True, "mechanics.motion": "linear", "drive.speed": "45 m/s"}
    loss = press(study(**changes)).loss
    assert loss is not None
    assert rise.rises[2].resistance == pytest.approx(loss.rolling_resistance, rel=1e-9)


def test_without_mass_nothing_rises() -> None:
    tyre = study()
    for name in tyre.materials:
        tyre = tyre.scaled(f"materials.{name}.density.value", 1e-6)
    rise = amplification(tyre, 84.0, speeds=[1.0, 60.0])
    assert rise.rises[1].loss == pytest.approx(1.0, abs=2e-3)
    assert rise.rises[1].strain == pytest.approx(1.0, abs=2e-3)


def test_a_tyre_without_loss_has_no_heat_that_rises() -> None:
    tyre = study()
    tyre = tyre.replace({f"materials.{name}.loss_tangent.value": 0.0 for name in tyre.materials})
    with pytest.raises(InputError, match="every tan delta is 0"):
        amplification(tyre, 84.0, speeds=[1.0])


def test_the_nearest_effect_is_the_effect(rise: Amplification) -> None:
    """The factor is that of the catalogue's effect; a rise made by it is given back."""
    from tyrefem.effects.standing_wave import StandingWave

    class Rolling:
        @staticmethod
        def region(zone: str) -> str:
            return zone

        @staticmethod
        def speed(time: float) -> float:
            return time

    made = StandingWave.model_validate({"gain": 3.0, "critical_speed": "50 m/s"})
    speeds = np.linspace(5, 60, 9)
    factors = np.array([made.heat_factor(Rolling(), "tread", np.zeros((2, 1)), v, np.zeros(1)) for v in speeds])  # type: ignore[arg-type]
    onset = Onset.of(speeds, factors)
    assert (onset.gain, onset.critical_speed, onset.error) == pytest.approx((3.0, 50.0, 0.0), rel=1e-4, abs=1e-5)
    assert rise.onset is not None
    assert rise.onset.error < 0.15


def test_rises_at_several_temperatures_are_told_apart(rise: Amplification) -> None:
    assert rise.temperature == study().card.drive.initial
    warm = replace(rise, temperature=80.0)
    assert warm.summary()["temperature_degC"] == 80.0
    assert {row["temperature_degC"] for row in warm.rows()} == {80.0}
    assert "kPa, 80 degC, " in _rise_words(warm, several=True)
    assert "degC" not in _rise_words(warm, several=False)
    _, labels = rise_figure([rise, warm]).axes[0].get_legend_handles_labels()
    told = [label for label in labels if "kPa" in label]
    assert len(set(told)) == len(told) == 4
    assert "°C" not in "".join(rise_figure([warm]).axes[0].get_legend_handles_labels()[1])


def test_limited_by_loss_is_a_truth_with_its_words(rise: Amplification) -> None:
    limited = replace(rise, rises=(rise.rises[0], replace(rise.rises[1], limited="waves stand")))
    told = [(row["limited_by_loss_only"], row["limited_because"]) for row in limited.rows()]
    assert told == [(False, ""), (True, "waves stand")]


def test_command_prints_and_writes_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    line = ["press", "nasa-22x5.5-8pr", "--set", "mesh.size=16 mm", "--critical-speed", "--rise", "--out", "out"]
    assert main(line) == 2
    assert "strains by finite elements" in capfd.readouterr().err
    assert main(["press", "nasa-22x5.5-8pr", "--rise"]) == 2
    assert "--rise" in capfd.readouterr().err
    assert main([*line, "--set", "mechanics.strain=fem"]) == 0
    text = capfd.readouterr().out
    assert "heat and strain over those without inertia" in text
    assert "nearest effect: standing-wave with gain" in text
    assert (tmp_path / "out" / "rise.csv").read_text().startswith("pressure_Pa,temperature_degC,load_N,speed_m_s")
    assert (tmp_path / "out" / "rise.png").stat().st_size > 5000
