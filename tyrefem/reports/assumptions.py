"""Assumptions of a run in its report, each with its consequence."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from tyrefem.materials.card import strain_laws
from tyrefem.mechanics.strain_laws import strain_law

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.inputs.study_card import Feedback


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
        always[-1] = ("Feedback of temperature on the strain cycle", _feedback_assumptions(study, mechanics.feedback))
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
        every = (
            f"Every harmonic of the strain round the wheel loses 2π tan δ of its strain energy per cycle; tan δ {laws}."
        )
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
    if not _friction_follows_temperature(study):
        return "The coefficient of friction does not depend on the temperature."
    if feedback is None or not feedback.friction:
        return (
            "The coefficient of friction is that of the drive's initial temperature; [mechanics.feedback] changes it."
        )
    return "The coefficient of friction follows the mean temperature of the tread."


def _friction_follows_temperature(study: StudyData) -> bool:
    return any(card.friction is not None and card.friction.follows_temperature for card in study.materials.values())


def _feedback_assumptions(study: StudyData, choice: Feedback) -> str:
    rubs = choice.friction and study.card.boundaries.sliding.rolls and _friction_follows_temperature(study)
    acts = ((choice.pressure, "its pressure"), (choice.modulus, "every modulus"), (rubs, "the coefficient of friction"))
    acting = ", ".join(text for on, text in acts if on) or "nothing"
    return (
        "The contained air has one temperature and a constant volume. The temperature acts on: "
        f"{acting}. A modulus follows its region's mean temperature if the card gives a softening."
    )
