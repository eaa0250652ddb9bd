"""Inputs of a run in its report: materials with sources, boundary laws, mechanics, study file, assumptions."""

from __future__ import annotations

import math
import tomllib
import typing
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from tyrefem.inputs.uncertain_numbers import stated_deviations
from tyrefem.materials.card import strain_laws
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.quantity import Unit
from tyrefem.reports.words import motion_words, number

if TYPE_CHECKING:
    from tyrefem.cards import Card
    from tyrefem.inputs.study import StudyData
    from tyrefem.inputs.study_card import Feedback, Mechanics
    from tyrefem.materials.card import MaterialCard
    from tyrefem.materials.elasticity import Cords
    from tyrefem.materials.properties import Softening
    from tyrefem.materials.strain_dependence import StrainDependence
    from tyrefem.materials.tan_delta_law import TanDeltaLaw
    from tyrefem.mechanics.stored_cycles import PressedCycle


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
    from tyrefem.materials.card import LossTangent

    if not isinstance(loss, LossTangent):
        return f"{loss.law}: {'; '.join(_numbers(loss))}"
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


def boundary_rows(study: StudyData) -> list[list[str]]:
    """One row per side: side, law, its description, and its numbers in SI."""
    laws = study.card.boundaries
    rows = []
    rubs = laws.sliding.rolls or any(phase.slides for phase in study.card.drive.phases)
    for side in ("road", "outside_air", "contained_air", "rim", *(["sliding"] if rubs else [])):
        law = getattr(laws, side)
        words = (type(law).__doc__ or "").strip().partition("\n")[0]
        rows.append([side.replace("_", " "), str(law.law), words, "; ".join(_numbers(law))])
    return rows


def mechanics_rows(study: StudyData, cycle: PressedCycle | None = None) -> list[list[str]]:
    """Name and value of every setting of strain and load; ``cycle``: a strain cycle by finite elements of the run."""
    mechanics = study.card.mechanics
    law, energy = mechanics.load_law, mechanics.energy if mechanics.strain == "given" else None
    rows = [
        ["strain cycle", mechanics.strain],
        _load(study)
        if strain_law(study).presses
        else ["load and deflection", "; ".join([str(law.law), *_numbers(law)])],
        *_motion(study, cycle),
        ["loss convention", mechanics.loss_convention],
        *_feedback(mechanics, rolls=study.card.boundaries.sliding.rolls),
    ]
    if energy is not None:
        load = f"{number(energy.load)} N, {number(energy.pressure / 1e3)} kPa"
        rows.append(["strain energy given for", f"{load}; {energy.source}"])
        for region, table in energy.regions.items():
            places = (f"{number(u / 1e3)} at s = {number(s * 1e3)} mm" for s, u in table)
            rows.append([f"U of {region} [kJ/m³]", number(table[0][1] / 1e3) if len(table) == 1 else ", ".join(places)])
        return rows
    if mechanics.strain != "arcs":
        return rows
    return [
        *rows,
        ["Poisson term c_a", number(mechanics.poisson_term)],
        ["membrane shear", "counted" if mechanics.membrane_shear else "left out"],
    ]


def _load(study: StudyData) -> list[str]:
    """Row on load and deflection for a strain law that computes them by pressing the tyre."""
    words = "by finite elements, with footprint and rolling radius; the study's load law and footprint law are not used"
    if any(effect.name in ("pressure-rise", "pressure-loss") for effect in study.effects):
        words += ", except for the change of deflection by effects on the pressure"
    return ["load and deflection", words]


def _motion(study: StudyData, cycle: PressedCycle | None) -> list[list[str]]:
    """Row on the footprint's motion, with what a linear one leaves out; none if the law does not press the tyre."""
    if not strain_law(study).presses:
        return []
    motion = study.card.mechanics.motion
    error = cycle.linearisation_error if cycle is not None and motion == "linear" else None
    return [["motion of the footprint", motion_words(motion, error)]]


def _feedback(mechanics: Mechanics, *, rolls: bool) -> list[list[str]]:
    choice = mechanics.feedback
    if choice is None:
        return []
    parts = ((choice.pressure, "pressure"), (choice.modulus, "modulus"), (choice.friction and rolls, "friction"))
    acting = [text for on, text in parts if on]
    return [["feedback of temperature", f"{', '.join(acting) or 'nothing'}, within {number(choice.tolerance)} K"]]


def effect_rows(study: StudyData) -> list[list[str]]:
    """One row per active effect: name, sentence, values with standard deviations, and their source."""
    rows = []
    for effect in study.effects:
        values = [f"{name} {text}" for name, text in effect.choice.items()]
        values += [f"only in {', '.join(effect.runs)}"] if effect.runs else []
        for parameter in effect.parameters():
            sd = f" ± {effect.sd[parameter.name]}" if parameter.name in effect.sd else ""
            values.append(
                f"{parameter.name.replace('_', ' ')} {parameter.prior.text(getattr(effect, parameter.name))}{sd}"
            )
        rows.append([effect.name, effect.sentence, "; ".join(values), effect.provenance or "the study"])
    return rows


def _numbers(card: Card) -> list[str]:
    """Every field with its unit; default values are marked."""
    numbers = []
    for name, info in type(card).model_fields.items():
        value = getattr(card, name)
        if name == "law" or value is None:
            continue
        unit = _unit([*info.metadata, info.annotation])
        if isinstance(value, float):
            text = f"{number(value)} {unit.replace('**', '')}".strip()
        else:
            text = f"table of {len(value)} rows" if isinstance(value, list) else str(value)
        default = "" if name in card.model_fields_set else " (default)"
        numbers.append(f"{name.replace('_', ' ')} {text}{default}")
    return numbers


def _unit(parts: list[Any]) -> str:
    """The unit in a field's annotation, also a nested one; empty if there is none."""
    for part in parts:
        if isinstance(part, Unit):
            return "" if part.unit == "1" else part.unit.replace("delta_degC", "K").replace("degC", "°C")
        unit = _unit(list(typing.get_args(part)))
        if unit:
            return unit
    return ""


def section_sources(study: StudyData) -> list[list[str]]:
    """Tables of the section's card and their sources."""
    from tyrefem import library

    data, _, _ = library.load("section", study.data["section"], study.folder)
    return [[where, source] for where, source in _sources(data, "")]


def _sources(data: Any, where: str) -> Iterator[tuple[str, str]]:
    if isinstance(data, Mapping):
        label = f"{where} {data['name']}" if isinstance(data.get("name"), str) and where else where
        for key, value in data.items():
            if key == "source":
                yield label or "section", str(value)
            else:
                yield from _sources(value, f"{label}, {key}" if label else key.replace("_", " "))
    elif isinstance(data, list):
        for entry in data:
            yield from _sources(entry, where)


def study_text(study: StudyData) -> tuple[str, bool]:
    """The study's file and True; if values were changed, the study as it was run and False."""
    if study.file is not None and study.file.is_file():
        text = study.file.read_text(encoding="utf-8-sig")
        try:
            if tomllib.loads(text) == dict(study.data):
                return text, True
        except tomllib.TOMLDecodeError:
            pass  # edited since the run: show the study that was run
    import tomli_w

    return tomli_w.dumps(dict(study.data)), False


ALWAYS = {
    "Axisymmetric deformation": "Once per revolution, a material point moves from the inflated section to the section "
    "under the footprint's centre, as if the tyre were a barrel, compressed evenly all round. The footprint's edges "
    "and changes along the circumference are not resolved.",
    "Films averaged over the revolution": "The tread exchanges heat with road and air for their shares of a "
    "revolution. Flash temperatures during contact and changes around the circumference are averaged out. At "
    "standstill, no heat flows into the road.",
    "Contained air of one temperature": "The strain cycle uses the drive's pressure. The pressure rise with the air's "
    "temperature is reported, but it does not change the deflection.",
}


FREE = {
    "Free, straight rolling": "No slip, steering, camber, braking or wear: no heat from sliding in the footprint.",
}
SLIDING = {
    "Uniform friction in the footprint": "The whole footprint slides at one speed under one pressure. The effusivities "
    "of tread and road divide its heat. Wear, water, tread gaps, camber and the strain of braking and cornering "
    "are left out.",
}
ROLLING = {
    "Steady rolling with friction": "Each state of slip, torque, slip angle and camber is steady rolling. "
    "Friction heat of every ring of the tread is its mean over the revolution; the "
    "effusivities of tread and road divide it. Wear, water and tread gaps are left out.",
}
GIVEN = (
    "The study gives every region's strain energy, proportional to the deflection squared. Temperatures and rolling "
    "resistance are as accurate as these numbers."
)
LOCKED = {
    "The section of a locked wheel is the one on the road": "Conduction along the circumference is neglected. After "
    "the skid, the model's whole circumference is as hot as the section on the road, and the heat budget counts a "
    "ring of such sections.",
}


def assumptions(study: StudyData, estimates: list[str]) -> list[tuple[str, str]]:
    """Pairs of assumption and consequence; ``estimates``: material entries that are marked as estimates."""
    mechanics, drive = study.card.mechanics, study.card.drive
    always = [*ALWAYS.items()]
    given = mechanics.energy if mechanics.strain == "given" else None
    if given is not None:
        always[0] = ("Strain energy given, not computed", f"{GIVEN} Their source: {given.source}.")
    if any(assumption := strain_law(study).assumption_of(study)):
        always[0] = assumption
    if mechanics.feedback is not None:
        always[-1] = ("Feedback of temperature on the strain cycle", _feedback_assumptions(mechanics.feedback))
    locked = LOCKED if any(drive.locked_since(start) is not None for start in drive.starts) else {}
    stated = [always[0], _loss_assumption(study), *_slip_assumptions(study).items(), *locked.items(), *always[1:]]
    stated += [*_effect_assumptions(study), *_formulas_from_memory(study)]
    if estimates:
        stated.append(("Estimated material numbers", f"Marked in the table of materials: {'; '.join(estimates)}."))
    return [*stated, ("Validation", _validation(study))]


def _slip_assumptions(study: StudyData) -> dict[str, str]:
    """How the tyre slips on the road."""
    if study.card.boundaries.sliding.rolls:
        return {name: f"{text} {_friction_assumption(study)}" for name, text in ROLLING.items()}
    if any(phase.slides for phase in study.card.drive.phases):
        return SLIDING
    if all(effect.free_rolling for effect in study.effects):
        return FREE
    return {name: f"{text} The study's effects are added to this." for name, text in FREE.items()}


def _loss_assumption(study: StudyData) -> tuple[str, str]:
    """What of the strain energy becomes heat, and on what tan delta depends."""
    mechanics = study.card.mechanics
    over_frequency = [region for region, card in study.materials.items() if card.loss_tangent.depends_on_frequency]
    laws = "depends on temperature, not on frequency"
    if over_frequency:
        laws = f"depends on temperature, and on frequency in: {', '.join(over_frequency)}"
    over_strain = list(strain_laws(study.materials))
    if over_strain and mechanics.strain == "fem":
        laws += f"; the loss modulus follows each point's strain amplitude in: {', '.join(over_strain)}"
        if mechanics.moduli == "secant":
            laws += "; their storage modulus is that of the region's strain amplitude under load"
    if mechanics.strain == "fem" and mechanics.revolution == "harmonics":
        every = f"Every harmonic of the strain round the wheel loses π tan δ of its energy per cycle; tan δ {laws}."
        return "Loss of every harmonic", every
    cycle = (
        "The strain energy times tan δ is lost once per revolution (convention "
        f"{mechanics.loss_convention}); higher harmonics are neglected. tan δ {laws}."
    )
    return "One loss cycle per revolution", cycle


def _effect_assumptions(study: StudyData) -> Iterator[tuple[str, str]]:
    """The effects beside the base model, and those of other runs."""
    if study.effects:
        added = "; ".join(dict.fromkeys(f"{effect.name}: {effect.sentence.rstrip('.')}" for effect in study.effects))
        yield "Effects beside the base model", f"{added}. The study states the source of their values."
    elsewhere = [effect for effect in study.card.effects if not effect.acts_in(study.card.run)]
    if elsewhere:
        left_out = "; ".join(" ".join(effect.label) for effect in elsewhere)
        at = f"This drive is of the run '{study.card.run}'." if study.card.run else "This drive is of no measured run."
        yield "Effects of measured runs that do not act here", f"{left_out}. {at}"


def _formulas_from_memory(study: StudyData) -> Iterator[tuple[str, str]]:
    """Formulas whose report was not at hand."""
    mechanics = study.card.mechanics
    if strain_law(study).presses:
        return
    if mechanics.load_law.law == "tr-r-64":
        memory = "The load-deflection formula of NASA TR R-64 is quoted from memory; a measured stiffness is better."
        yield "Load and deflection from memory", memory
    if mechanics.footprint.law == "tr-r-64":
        yield "Footprint from memory", "The formula of the footprint's length, of NASA TR R-64, is quoted from memory."


def _validation(study: StudyData) -> str:
    """What the model was compared with."""
    measured = (
        "This study names measured tables; 'tyrefem compare' writes the comparison with them."
        if study.measured
        else "The study names no measured temperatures."
    )
    if strain_law(study).by_elements:
        return f"The strain cycle by finite elements is verified, not validated. {measured}"
    if study.card.mechanics.strain == "given":
        return f"The strain energy is an input, and is not validated. {measured}"
    return (
        "The model follows Clark & Dodge (1980). Their measured temperature curves are illegible in the scan, so it "
        f"has not been validated against them. {measured}"
    )


def _friction_assumption(study: StudyData) -> str:
    feedback = study.card.mechanics.feedback
    if not any(card.friction is not None and card.friction.follows_temperature for card in study.materials.values()):
        return "The coefficient of friction does not depend on the temperature."
    if feedback is None or not feedback.friction:
        return (
            "The coefficient of friction is that of the drive's initial temperature; [mechanics.feedback] changes it."
        )
    return "The coefficient of friction follows the mean temperature of the tread."


def _feedback_assumptions(choice: Feedback) -> str:
    acting = [text for on, text in ((choice.pressure, "its pressure"), (choice.modulus, "every modulus")) if on]
    return (
        "The contained air has one temperature and a constant volume. The temperature acts on: "
        f"{' and '.join(acting) or 'nothing'}. A modulus follows its region's mean temperature if the card gives a "
        "softening."
    )
