"""Seeded cases for the rig: true tyres and rigs drawn at random about what the card says."""

from __future__ import annotations

import numpy as np
import pandas as pd
from curved_patch import CurvedPatch, TrueLayer, Truth

from tyrefem.heating_test.card import RigCard
from tyrefem.measured import MeasuredRun

TIMES = np.arange(0.0, 1661.0, 5.0)


def truth(seed: int, card: RigCard, *, linear: bool) -> Truth:
    """A tyre and a rig: properties within +-35 % of the guesses, everything else as uncertain as the card says."""
    rng = np.random.default_rng(20_000 + seed)
    slopes = rng.normal(0.0, 1.5e-3, 4) * (rng.random(4) < 0.5) if linear else np.zeros(4)
    layers = tuple(
        TrueLayer(
            layer.thickness,
            layer.density.value,
            layer.conductivity.value * float(np.exp(rng.uniform(-0.35, 0.35))),
            layer.specific_heat.value * float(np.exp(rng.uniform(-0.25, 0.25))),
            float(slopes[2 * i]),
            float(slopes[2 * i + 1]),
        )
        for i, layer in enumerate(card.layers)
    )
    laser, around, couple = card.laser, card.surroundings, card.sensors["interface"]
    names = ("outer", "inner", "interface")
    return Truth(
        layers,
        absorptance=min(float(rng.normal(laser.absorptance, laser.absorptance_sd)), 0.999),
        emissivity=min(float(rng.normal(around.emissivity, around.emissivity_sd)), 0.99),
        films=tuple(np.exp(rng.normal(0, around.convection_sd, 2)).tolist()),
        radii=(card.patch.circumferential_radius, card.patch.lateral_radius),
        spot_offset=float(np.hypot(*rng.normal(0, laser.placing_sd, 2))),
        offset_along=bool(rng.random() < 0.5),
        depth=float(couple.depth + rng.normal(0, couple.depth_sd)),
        lag=float(couple.lag * np.exp(rng.normal(0, couple.lag_sd))),
        phases=(card.phases.idle, card.phases.heating, card.phases.cooling),
        biases=tuple(float(rng.normal(0, card.sensors[n].offset_sd)) for n in names),
    )


def measured(seed: int, card: RigCard, true: Truth) -> list[MeasuredRun]:
    """Tables of every run of the card."""
    rng = np.random.default_rng(40_000 + seed)
    patch = CurvedPatch(true)
    times = TIMES[card.phases.end >= TIMES]
    return [
        MeasuredRun(
            name, times, pd.DataFrame(patch.readings(run.power, times, rng), columns=["outer", "inner", "interface"])
        )
        for name, run in card.runs.items()
    ]


def properties(card: RigCard, true: Truth) -> dict[str, float]:
    """True conductivity and specific heat by the name of their parameter, at the reference temperature."""
    values = {}
    for layer, true_layer in zip(card.layers, true.layers, strict=True):
        T = layer.reference_temperature
        values[f"{layer.name}.conductivity"] = float(true_layer.conductivity(T))
        values[f"{layer.name}.specific_heat"] = float(true_layer.capacity(T)) / true_layer.density
    return values
