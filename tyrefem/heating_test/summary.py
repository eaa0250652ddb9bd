"""Plain data of an identification."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.heating_test.parameters import PROPERTY
from tyrefem.heating_test.selection import COVERAGE
from tyrefem.heating_test.verdict import sentences
from tyrefem.output import versions
from tyrefem.plugins.named import named_plugins, rows_of_plugins

if TYPE_CHECKING:
    from tyrefem.heating_test.identification import IdentificationData


def summary(identification: IdentificationData) -> dict[str, Any]:
    """Contents of ``rig.json``: estimates, correlation, verdict, selection, noise, misfit."""
    names = [item.name for item in identification.estimates]
    return {
        "rig": identification.card.title,
        "file": identification.file,
        "tests": [
            {
                "run": test.name,
                "table": test.file,
                "power_W": test.run.power,
                "until_s": test.clock.end,
                "readings": {item.sensor: int(item.counts.sum()) for item in test.series},
            }
            for test in identification.tests
        ],
        "reference_temperatures_degC": {item.name: item.reference_temperature for item in identification.card.layers},
        "estimates": [item.to_dict() for item in identification.estimates],
        "coverage_factor": COVERAGE,
        "diffusivities": diffusivities(identification),
        "determined": [item.name for item in identification.properties if item.verdict == "determined"],
        "not_determined": [item.name for item in identification.properties if item.verdict == "not determined"],
        "poorly_determined": [item.name for item in identification.properties if item.verdict == "poor"],
        "doubtful": [item.name for item in identification.properties if item.verdict == "doubtful"],
        "words": list(sentences(identification)),
        "correlation": {"names": names, "matrix": identification.correlation.round(4)},
        "linear_in_temperature": {
            "chosen": list(identification.selection.chosen),
            "probability": dict(identification.selection.probability),
            "log_evidence_over_constant": [
                {"slopes": list(key), "log_evidence": value} for key, value in ranked(identification, 20)
            ],
        },
        "model_error": {
            "relative_to_rise": dict(identification.fit.noise.model),
            "correlation_time_s": identification.fit.noise.tau,
        },
        "residuals": [
            {
                "run": block.series.test,
                "sensor": block.series.sensor,
                "mean_K": float(np.average(block.residual, weights=block.series.counts)),
                "rms_K": float(np.sqrt(np.average(block.residual**2, weights=block.series.counts))),
            }
            for block in identification.fit.blocks
        ],
        "solutions": identification.fit.solutions,
        "versions": versions(),
        "plugins": rows_of_plugins(named_plugins(identification.card.model_dump())),
    }


def ranked(identification: IdentificationData, most: int) -> list[tuple[tuple[str, ...], float]]:
    """Combinations of linear properties by evidence, best first."""
    return sorted(identification.selection.log_evidence.items(), key=lambda pair: -pair[1])[:most]


def diffusivities(identification: IdentificationData) -> list[dict[str, Any]]:
    """k/(rho c) of every layer, m2/s, with its relative standard deviation."""
    place = {estimate.name: i for i, estimate in enumerate(identification.estimates) if estimate.group == PROPERTY}
    out = []
    for layer in identification.card.layers:
        a, b = (place[f"{layer.name}.{key}"] for key in ("conductivity", "specific_heat"))
        k, c = identification.estimates[a], identification.estimates[b]
        sa, sb = (float(estimate.relative_sd or 0.0) for estimate in (k, c))
        variance = sa**2 + sb**2 - 2 * float(identification.correlation[a, b]) * sa * sb
        value = k.value / (layer.density.value * c.value)
        out.append({"layer": layer.name, "value_m2_s": value, "relative_sd": float(np.sqrt(max(variance, 0.0)))})
    return out
