"""Known numbers of a lumped tyre come back out of noise, and out of runs of a tyre of well conducting rubber."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

import tyrefem as tf
from tyrefem.cards import merged, read_toml
from tyrefem.lumped.card import ThermalCard
from tyrefem.lumped.identification import LumpedIdentification, identify

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = ROOT / "studies/thermal-passenger/thermal.toml"


def shipped(changes: dict[str, Any] | None = None) -> ThermalCard:
    return ThermalCard.check(merged(read_toml(SHIPPED), changes or {}))


def numbers(found: LumpedIdentification) -> dict[str, tuple[float, float]]:
    return {number.name: (number.value, number.sd) for number in found.numbers}


def test_noise_is_covered_by_the_standard_deviations() -> None:
    """Forty noisy copies: two standard deviations hold the true number in 95 % of all, the misfit is about 1."""
    card = shipped({"heat_sd": 0.0})
    best = identify(card)
    exact, exact_numbers = best.network, best.numbers
    random = np.random.default_rng(3)
    inside, misfits = [], []
    for _ in range(40):
        runs = []
        for run in card.runs:
            changed = {}
            for quantity in ("plateau", "warm_up", "cool_down"):
                values = dict(zip(card.bodies, getattr(exact, quantity)(run), strict=True))
                sd = {name: card.temperature_sd if quantity == "plateau" else card.time_sd * value
                      for name, value in values.items()}  # fmt: skip
                changed[quantity] = {name: values[name] + sd[name] * random.normal()
                                     for name in getattr(run, quantity)}  # fmt: skip
            runs.append(run.model_copy(update=changed))
        found = identify(card.model_copy(update={"runs": tuple(runs)}))
        values = {number.name: number.value for number in exact_numbers}
        inside += [abs(number.value - values[number.name]) < 2 * number.sd for number in found.numbers]
        misfits.append(found.misfit)
    assert 0.9 < np.mean(inside) <= 1.0
    assert 0.7 < np.mean(misfits) < 1.4


def crossing(times: Any, temperatures: Any) -> float:
    """Time to 63 % of the way from the first to the last temperature."""
    way = (temperatures - temperatures[0]) / (temperatures[-1] - temperatures[0])
    return float(np.interp(1 - math.exp(-1), way, times))


def test_known_films_come_back_from_runs_of_a_tyre() -> None:
    """A tyre of well conducting rubber is a lump: outside film 5.44 + 1.674 v, gas film 1 W/m2/K, known capacities."""
    changes: dict[str, Any] = {
        "mesh.size": "12 mm", "mesh.element": "P1", "drive.duration": "14000 s", "output.every": "10 s",
        "boundaries.road.fraction": 0.0, "boundaries.rim.film": "0 W/m**2/K",
        "boundaries.contained_air.film": "1 W/m**2/K", "numerics.tolerance": "0.05 K",
    }  # fmt: skip
    for region in ("carcass", "tread", "sidewall", "bead"):
        changes[f"materials.{region}.conductivity.value"] = "2000 W/m/K"
        changes[f"materials.{region}.loss_tangent"] = {"law": "constant", "value": 0.1, "source": "test"}
    study, runs = tf.study("nasa-22x5.5-8pr", changes), []
    for speed in ("10 mph", "30 mph"):
        result = study.replace({"drive.speed": speed}).run()
        readings = result.readings
        tyre = readings[list(study.sensors)].mean(axis=1).to_numpy()
        gas, times = readings["contained-air"].to_numpy(), readings["time_s"].to_numpy()
        runs.append({
            "name": speed, "speed": speed, "rolling_resistance": f"{result.rolling_resistance.force} N",
            "air": "25 degC", "plateau": {"tyre": f"{tyre[-1]} degC", "gas": f"{gas[-1]} degC"},
            "warm_up": {"tyre": f"{crossing(times, tyre)} s", "gas": f"{crossing(times, gas)} s"},
        })  # fmt: skip
    mesh = study.mesh()
    p, facets = mesh.mesh.p, [mesh.mesh.facets[:, mesh.mesh.boundaries[name]] for name in ("road", "outside_air")]
    outside = 2 * sum(
        float((2 * np.pi * p[0, ends].mean(axis=0) * np.hypot(*(p[:, ends[1]] - p[:, ends[0]]))).sum())
        for ends in facets
    )
    inside, section = result.summary()["section"]["inner_surface_m2"], study.section
    card = ThermalCard.check({
        "title": "a run", "bodies": {"tyre": {"heat_share": 1.0}, "gas": {}},
        "films": [{"between": ["tyre", "air"], "area": f"{outside} m**2", "speed": "linear"},
                  {"between": ["tyre", "gas"], "conductance": f"{inside * 1.0} W/K"}],
        "runs": runs, "temperature_sd": "0.5 K", "time_sd": "1 %", "heat_sd": "1 %",
    })  # fmt: skip
    found = identify(card)
    films = {number.name: (number.value / outside, number.sd / outside) for number in found.numbers}
    for name, known in (("conductance tyre-air at rest", 5.4392), ("conductance tyre-air per speed", 1.6736)):
        value, sd = films[name]
        assert abs(value - known) < 2 * sd, name
        assert sd < 0.1 * known, name
    capacity, sd = numbers(found)["heat capacity tyre"]
    known = 2 * 2.092e6 * sum(section.volume(region) for region in section.regions)
    assert abs(capacity - known) < 2 * sd
    assert sd < 0.1 * known
