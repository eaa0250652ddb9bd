"""The table of a strain cycle by region, and `tyrefem show strain` of every strain law."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.mechanics.footprint.strain_amplitude import StrainAmplitude
from tyrefem.mechanics.rolling.turning import cycle_of
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.strain_by_region import WHOLE, StrainByRegion

COARSE = {"mesh.size": "8 mm", "drive.duration": "60 s", "drive.initial": "25 degC"}


@pytest.mark.fast
def test_the_heat_is_the_cold_rolling_resistance_times_speed() -> None:
    study = tf.study("nasa-22x5.5-8pr", COARSE)
    strains, result = StrainByRegion.of(RollingTyre(study)), study.run()
    table = strains.table.set_index("region")
    load, speed = strains.case.load, result.tyre.motion(0.0).speed
    cold = result.rolling_resistance.cold_coefficient * load * speed
    assert table.loc[WHOLE, "heat_W"] == pytest.approx(cold, rel=1e-3)
    assert table["heat_share"].iloc[:-1].sum() == pytest.approx(1.0)
    assert table["heat_W"].iloc[:-1].is_monotonic_decreasing
    volume = sum(study.section.as_full().volume(region) for region in study.section.regions)
    assert table.loc[WHOLE, "volume_m3"] == pytest.approx(volume, rel=5e-3)
    assert table["amplitude_mean"].isna().all()


@pytest.mark.fast
def test_given_energies_come_out_as_they_were_given() -> None:
    """Region by region the mean of a constant energy is that energy, the highest of rows is their highest."""
    energy = {
        "load": "2700 lbf", "pressure": "83 psi", "source": "test",
        "regions": {"carcass": "10 kJ/m**3", "tread": [["0 mm", "1 kJ/m**3"], ["40 mm", "5 kJ/m**3"]],
                    "sidewall": "2 kJ/m**3", "bead": "0 J/m**3"},
    }  # fmt: skip
    study = tf.study("nasa-22x5.5-8pr", {**COARSE, "mechanics.strain": "given", "mechanics.energy": energy})
    table = StrainByRegion.of(RollingTyre(study)).table.set_index("region")
    assert table.loc["carcass", "energy_mean_J_m3"] == pytest.approx(10e3)
    assert table.loc["sidewall", "energy_highest_J_m3"] == pytest.approx(2e3)
    assert table.loc["tread", "energy_highest_J_m3"] == pytest.approx(5e3)
    assert table.loc["tread", "highest_s_m"] >= 0.04 - 2e-3
    assert table.loc["bead", "heat_W"] == 0
    assert table.loc[WHOLE, "energy_highest_J_m3"] == pytest.approx(10e3)


def test_finite_elements_have_strains_and_a_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    changes = {"mesh.size": "12 mm", "mechanics.strain": "fem", "mechanics.motion": "linear", "drive.duration": "60 s"}
    study = tf.study("nasa-22x5.5-8pr", changes)
    strains = StrainByRegion.of(RollingTyre(study))
    table = strains.table.set_index("region")
    cycle = cycle_of(strains.cycle.footprint)  # type: ignore[attr-defined]
    amplitudes = StrainAmplitude(cycle, {}).amplitudes
    assert table.loc[WHOLE, "amplitude_highest"] == pytest.approx(amplitudes.max())
    assert (table["amplitude_mean"].iloc[:-1] < table["amplitude_highest"].iloc[:-1]).all()
    assert 0.01 < table.loc["tread", "amplitude_mean"] < 0.3
    picture = tmp_path / "strain.png"
    flags = [f"--set={key}={value}" for key, value in changes.items()]
    assert main(["show", "strain", "nasa-22x5.5-8pr", *flags, "--out", str(picture)]) == 0
    output = capsys.readouterr().out
    for word in ("tread", "whole tyre", "strain", "U: strain energy per cycle", "deflection_m"):
        assert word in output
    assert all(len(line) <= 100 for line in output.splitlines() if "drawn in" not in line)
    assert picture.stat().st_size > 20_000
    assert np.isfinite(table["heat_W"]).all()
