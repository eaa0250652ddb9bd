"""A small tyre's exploration, made once: two phases, a lumped rim, a lagging sensor, odd names, measured runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tyrefem
from tyrefem.api import Exploration, Study

VARY = {
    "drive.speed": ("10 mph", "30 mph"),
    "drive.load": ("2000 lbf", "3200 lbf"),
    "drive.ambient": ("10 degC", "40 degC"),
    "materials.tread.loss_tangent.value": {"factor": [0.7, 1.3]},
    "materials.carcass.conductivity.value": {"factor": [0.8, 1.25]},
    "materials.sidewall.specific_heat.value": {"factor": [0.8, 1.2]},
    "boundaries.road.coefficient": {"from": "2000 W/m**2/K", "to": "12000 W/m**2/K", "scale": "log"},
}


@pytest.fixture(scope="session")
def small(tmp_path_factory: pytest.TempPathFactory) -> Study:
    folder = tmp_path_factory.mktemp("a tyre's page")
    times = np.arange(0.0, 121.0, 20.0)
    rows = [f"{t:g},{25 + 6 * (1 - np.exp(-t / 60)):.3f},{25 + 2 * (1 - np.exp(-t / 90)):.3f}" for t in times]
    for name in ("slow.csv", "other.csv"):
        (folder / name).write_text("time [s],skin [degC],deep [degC]\n" + "\n".join(rows) + "\n")
    text = """
title = "Small tyre <of the tests>"
section = "nasa-22x5.5-8pr"
materials = { carcass = "nasa-carcass", tread = "nasa-tread", sidewall = "nasa-sidewall", bead = "nasa-bead" }
mesh = { size = "20 mm", through = 1 }

[drive]
speed = "20 mph"
load = "2700 lbf"
pressure = "83 psi"

[[drive.phases]]
name = "rolling"
duration = "80 s"

[[drive.phases]]
name = "standing"
speed = "0 mph"
duration = "40 s"

[boundaries]
rim = { law = "lumped", mass = "4 kg", cooling = "2 W/K", air = "0.5 W/K" }

[sensors]
skin = { s = "0.3 in", depth = "0.60 in" }
deep = { s = "2 in", depth = "0.1 in", lag = "4 s" }
tread = { s = "2 in", depth = "0.02 in" }               # named as a region
lost-max = { s = "1 in", depth = "0.2 in" }             # named as losses and highest temperatures are

[[measured]]
table = "slow.csv"
drive = { "phases.rolling.speed" = "12 mph", load = "2500 lbf" }

[[measured]]
table = "other.csv"
drive = { pressure = "90 psi" }
"""
    (folder / "study.toml").write_text(text)
    # As `tyrefem explore study.toml --set ...`: the copied command must have the changes, too.
    return tyrefem.study(folder / "study.toml", {"mesh.size": "14 mm"})


@pytest.fixture(scope="session")
def explored(small: Study) -> Exploration:
    return small.explore(VARY, limits={"hottest_degC": {"below": 40}}, tolerance=0.5)


@pytest.fixture(scope="session")
def page(explored: Exploration, tmp_path_factory: pytest.TempPathFactory) -> str:
    file: Path = explored.save(tmp_path_factory.mktemp("page") / "explore.html")
    return file.read_text(encoding="utf-8")
