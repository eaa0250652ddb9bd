"""An identification as plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.heating_test.parameters import PROPERTY
from tyrefem.heating_test.selection import COVERAGE
from tyrefem.heating_test.verdict import sentences
from tyrefem.output import versions

if TYPE_CHECKING:
    from tyrefem.heating_test.identification import IdentificationData


def summary(found: IdentificationData) -> dict[str, Any]:
    """What ``rig.json`` holds: estimates, correlation, verdict, selection, noise, misfit."""
    names = [one.name for one in found.estimates]
    return {
        "rig": found.card.title,
        "file": found.file,
        "tests": [
            {
                "run": test.name,
                "table": test.file,
                "power_W": test.run.power,
                "until_s": test.clock.end,
                "readings": {one.sensor: int(one.counts.sum()) for one in test.series},
            }
            for test in found.tests
        ],
        "reference_temperatures_degC": {one.name: one.reference_temperature for one in found.card.layers},
        "estimates": [one.to_dict() for one in found.estimates],
        "coverage_factor": COVERAGE,
        "diffusivities": diffusivities(found),
        "determined": [one.name for one in found.properties if one.verdict == "determined"],
        "not_determined": [one.name for one in found.properties if one.verdict == "not determined"],
        "poorly_determined": [one.name for one in found.properties if one.verdict == "poor"],
        "words": list(sentences(found)),
        "correlation": {"names": names, "matrix": found.correlation.round(4)},
        "linear_in_temperature": {
            "chosen": list(found.selection.chosen),
            "probability": dict(found.selection.probability),
            "log_evidence_over_constant": [
                {"slopes": list(key), "log_evidence": value} for key, value in ranked(found, 20)
            ],
        },
        "model_error": {
            "relative_to_rise": dict(found.fit.noise.model),
            "correlation_time_s": found.fit.noise.tau,
        },
        "residuals": [
            {
                "run": block.series.test,
                "sensor": block.series.sensor,
                "mean_K": float(np.average(block.residual, weights=block.series.counts)),
                "rms_K": float(np.sqrt(np.average(block.residual**2, weights=block.series.counts))),
            }
            for block in found.fit.blocks
        ],
        "solutions": found.fit.solutions,
        "versions": versions(),
    }


def ranked(found: IdentificationData, most: int) -> list[tuple[tuple[str, ...], float]]:
    """Combinations of linear properties by evidence, best first."""
    return sorted(found.selection.log_evidence.items(), key=lambda pair: -pair[1])[:most]


def diffusivities(found: IdentificationData) -> list[dict[str, Any]]:
    """k/(rho c) of every layer, m2/s, with its relative standard deviation."""
    place = {one.name: i for i, one in enumerate(found.estimates) if one.group == PROPERTY}
    out = []
    for layer in found.card.layers:
        a, b = (place[f"{layer.name}.{key}"] for key in ("conductivity", "specific_heat"))
        k, c = found.estimates[a], found.estimates[b]
        sa, sb = (float(one.relative_sd or 0.0) for one in (k, c))
        variance = sa**2 + sb**2 - 2 * float(found.correlation[a, b]) * sa * sb
        value = k.value / (layer.density.value * c.value)
        out.append({"layer": layer.name, "value_m2_s": value, "relative_sd": float(np.sqrt(max(variance, 0.0)))})
    return out
