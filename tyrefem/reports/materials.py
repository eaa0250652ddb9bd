"""Materials of a run in its report: every number with its uncertainty and source."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from tyrefem.inputs.uncertain_numbers import stated_deviations
from tyrefem.reports.card_numbers import card_numbers
from tyrefem.reports.words import number

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.materials.card import MaterialCard
    from tyrefem.materials.elasticity import Cords
    from tyrefem.materials.properties import Softening
    from tyrefem.materials.strain_dependence import StrainDependence
    from tyrefem.materials.tan_delta_law import TanDeltaLaw


def material_rows(study: StudyData) -> tuple[list[dict[str, Any]], list[str]]:
    """One row per number: region, card, property, value, uncertainty, source, whether estimated; and the estimates."""
    rows, estimates = [], []
    idle = {table for number in study.uncertain_numbers if number.idle for table in number.tables}
    names = {id(entry): where for card in study.materials.values() for where, entry in stated_deviations(card)}
    for region, card in study.materials.items():
        for row, (label, entry, value) in enumerate(_properties(card)):
            guess = "estimate" in entry.source.lower()
            if guess:
                estimates.append(f"{region}: {label}")
            heads = ["", ""] if row else [region, card.title]
            sd = "–" if entry.relative_sd is None else f"± {number(100 * entry.relative_sd, 2)} %"
            if f"materials.{region}.{names.get(id(entry), '')}" in idle:
                sd += ", not used here"
            rows.append({"cells": [*heads, label, value, sd, entry.source], "estimate": guess, "first": not row})
    return rows, estimates


def _properties(card: MaterialCard) -> Iterator[tuple[str, Any, str]]:
    k, loss = card.conductivity, card.loss_tangent
    if k.along is not None and k.across is not None:
        yield "conductivity", k, f"{number(k.along)} along, {number(k.across)} across the plies W/m/K"
    else:
        yield "conductivity", k, _law(k.law(), "W/m/K")
    yield "density", card.density, _law(card.density.law(), "kg/m³")
    yield "specific heat", card.specific_heat, _law(card.specific_heat.law(), "J/kg/K")
    yield "tan δ", loss, _loss(loss)
    for label, entry in (("softening", card.softening), ("softening of the cords", _cord_softening(card))):
        if entry is not None:
            yield label, entry, _softening(entry)
    if card.strain_dependence is not None:
        yield "strain dependence", card.strain_dependence, _strain_dependence(card.strain_dependence)
    for label, modulus in (("shear modulus", card.shear_modulus), ("Young's modulus", card.youngs_modulus)):
        if modulus is not None:
            yield label, modulus, f"{number(modulus.value / 1e6)} MPa"
    if card.cord is not None:
        angle, shear = card.cord.crown_angle, card.cord.ply_shear_modulus
        texts = [] if angle is None else [f"crown angle {number(math.degrees(angle))}°"]
        texts += [] if shear is None else [f"ply shear modulus {number(shear / 1e6)} MPa"]
        yield "cords", card.cord, ", ".join(texts)
    if card.elasticity is not None:
        moduli = f"G {number(card.elasticity.initial_shear_modulus / 1e6)} MPa"
        yield "elasticity", card.elasticity, f"{card.elasticity.law}, {moduli}"
    if card.expansion is not None:
        yield "thermal expansion", card.expansion, f"{number(card.expansion.coefficient * 1e6)} 1e-6/K"
    if card.cords is not None:
        yield "cords", card.cords, _cords(card.cords)


def _loss(loss: TanDeltaLaw) -> str:
    from tyrefem.materials.tan_delta_card import LossTangent

    if not isinstance(loss, LossTangent):
        return f"{loss.law}: {'; '.join(card_numbers(loss))}"
    if loss.law == "exponential":
        law = f"{number(loss.value or 0)} exp(−{number(loss.rate or 0)} (T − {number(loss.at)} °C))"
    else:
        law = number(loss.value or 0) if loss.law == "constant" else f"table of {len(loss.table or [])} rows"
    over = loss.frequency
    if over is None:
        return law
    if loss.law == "frequency":
        return f"{over.law} over frequency"
    shape = f"(f / {number(over.reference)} Hz)^{number(over.exponent)}" if over.law == "power" else f"{over.law}"
    return f"{law}, over frequency {shape}"


def _cord_softening(card: MaterialCard) -> Softening | None:
    return next((part.softening for part in (card.cord, card.cords) if part is not None and part.softening), None)


def _softening(law: Softening) -> str:
    if law.law == "table":
        return f"table of {len(law.table or [])} rows"
    return f"modulus times exp(−{number(law.rate or 0)} (T − {number(law.at)} °C))"


def _strain_dependence(law: StrainDependence) -> str:
    return (
        f"Kraus: G′ {number(law.small_strain_modulus / 1e6)} to {number(law.large_strain_modulus / 1e6)} MPa, "
        f"G″ up to {number(law.greatest_loss_modulus / 1e6)} MPa at {number(100 * law.critical_strain)} %; card's "
        f"modulus at {number(100 * law.modulus_amplitude)} %, tan δ at {number(100 * law.loss_amplitude)} %"
    )


def _cords(cords: Cords) -> str:
    texts = [
        f"{number(cords.modulus / 1e9)} GPa",
        f"diameter {number(cords.diameter * 1e3)} mm",
        f"{number(cords.ends)} ends/m in {cords.plies} {'ply' if cords.plies == 1 else 'plies'}",
        f"at {number(math.degrees(cords.angle))}°",
    ]
    return ", ".join(texts)


def _law(law: Any, unit: str) -> str:
    """A number, or the first and last value of a table over temperature."""
    if not callable(law):
        return f"{number(law)} {unit}"
    temperatures = getattr(law, "temperatures", None)
    if temperatures is None:
        return f"depends on temperature, {unit}"
    low, high = temperatures[0], temperatures[-1]
    ends = f"{number(float(law(low)))} to {number(float(law(high)))}"
    return f"{ends} {unit} from {number(low)} to {number(high)} °C"
