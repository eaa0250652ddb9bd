"""What the model leaves out or takes on trust, as far as it concerns a study."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tyrefem.mechanics import PRESSES

if TYPE_CHECKING:
    from tyrefem.studies import Study
    from tyrefem.study_card import Feedback

ALWAYS = {
    "Axisymmetric deformation": "A material point passes once per revolution from the inflated section to the section "
    "under the footprint's centre, as if the whole tyre were pressed in a barrel; what happens at the footprint's "
    "edges and along the circumference is not resolved.",
    "Films averaged over the revolution": "The tread sees road and air for their shares of a revolution; flash "
    "temperatures during contact, and any change around the circumference, are averaged out. At standstill the road "
    "takes no heat.",
    "Contained air of one temperature": "The strain cycle uses the drive's pressure; the pressure that rises with the "
    "air's temperature is reported but does not change the deflection.",
}


#: Effects that are exceptions to free, straight rolling of a new tyre.
BESIDE = ("tread-slip", "yaw", "camber", "worn-tread", "brake-heat", "brake-power")
FREE = {
    "Free, straight rolling": "No slip, steering, camber, braking or wear: no heat from sliding in the footprint.",
}
FEM = (
    "A small deflection about the inflated tyre",
    "The section is inflated in large displacement and pressed on the road by Fourier harmonics of small motion about "
    "that state: without friction, and with too much load at a large deflection. Nothing of it is compared with a "
    "measured tyre.",
)
BARREL = (
    "Every meridian deflected alike, by finite elements",
    "The section is inflated in large displacement and the whole tyre pressed inside a rigid cylinder, as the report "
    "assumes: each hoop is shortened, none is bent flat. Nothing of it is compared with a measured tyre.",
)
BY_ELEMENTS = {"fem": FEM, "barrel": BARREL}
SLIDING = {
    "Friction even over the footprint": "All of the footprint slides at one speed under one pressure. Its heat divides "
    "between tread and road as they conduct; wear, water, tread gaps, camber and the strain of braking and cornering "
    "are left out.",
}
GIVEN = (
    "The study gives every region's strain energy, in proportion to the deflection squared: temperatures and rolling "
    "resistance are as good as these numbers."
)
LOCKED = {
    "A locked wheel's section stands for its patch": "The section modelled is the one on the road, and conduction "
    "along the circumference is neglected: afterwards the tyre is as hot all round as at that patch, and the heat "
    "budget counts a ring of such sections.",
}


def assumptions(study: Study, estimates: list[str]) -> list[tuple[str, str]]:
    """(what, why it matters); ``estimates`` are the material entries that are marked as estimates."""
    mechanics = study.card.mechanics
    drive = study.card.drive
    slip = SLIDING if any(phase.slides for phase in drive.phases) else FREE
    locked = LOCKED if any(drive.locked_since(start) is not None for start in drive.starts) else {}
    always = [*ALWAYS.items()]
    given = mechanics.energy if mechanics.strain == "given" else None
    if given is not None:
        always[0] = ("Strain energy given, not computed", f"{GIVEN} Their source: {given.source}.")
    if mechanics.strain in BY_ELEMENTS:
        always[0] = BY_ELEMENTS[mechanics.strain]
    if mechanics.feedback is not None:
        always[-1] = ("Feedback of temperature on the strain cycle", _feedback(mechanics.feedback))
    if slip is FREE and any(effect.name in BESIDE for effect in study.effects):
        slip = {name: f"{text} What the study's effects add stands beside this." for name, text in FREE.items()}
    found = [always[0], *slip.items(), *locked.items(), *always[1:]]
    over_frequency = [region for region, card in study.materials.items() if card.loss_tangent.frequency is not None]
    laws = "depends on temperature, not on frequency"
    if over_frequency:
        laws = f"depends on temperature, and on frequency in: {', '.join(over_frequency)}"
    cycle = (
        "The strain energy times tan δ is lost once per revolution (convention "
        f"{mechanics.loss_convention}); higher harmonics are neglected. tan δ {laws}."
    )
    every = f"Every harmonic of the strain round the wheel loses π tan δ of its energy per cycle; tan δ {laws}."
    harmonics = ("Loss of every harmonic", every)
    by_harmonic = mechanics.strain == "fem" and mechanics.revolution == "harmonics"
    found.insert(1, harmonics if by_harmonic else ("One loss cycle per revolution", cycle))
    if study.effects:
        added = "; ".join(dict.fromkeys(f"{one.name}: {one.sentence.rstrip('.')}" for one in study.effects))
        found.append(("Effects beside the base model", f"{added}. Each says in the study where its values come from."))
    presses = mechanics.strain in PRESSES
    if mechanics.load_law.law == "tr-r-64" and not presses:
        memory = "The load-deflection formula is quoted from memory of NASA TR R-64; a measured stiffness is better."
        found.append(("Load and deflection from memory", memory))
    if mechanics.footprint.law == "tr-r-64" and not presses:
        found.append(("Footprint from memory", "The footprint's length is that of NASA TR R-64, quoted from memory."))
    if estimates:
        found.append(("Estimated material numbers", f"Marked in the table of materials: {'; '.join(estimates)}."))
    measured = (
        "This study names measured tables; the comparison with them is a report of its own."
        if study.measured
        else "No measured temperatures belong to this study."
    )
    if mechanics.strain in BY_ELEMENTS:
        return [*found, ("Validation", f"The strain cycle by finite elements is verified, not validated. {measured}")]
    if given is not None:
        return [*found, ("Validation", f"The strain energy is given, so nothing of it is validated. {measured}")]
    scan = (
        "The model follows Clark & Dodge (1980), whose measured temperature curves are illegible in the scan, so it "
        f"has not been validated against them. {measured}"
    )
    return [*found, ("Validation", scan)]


def _feedback(choice: Feedback) -> str:
    acting = [text for on, text in ((choice.pressure, "its pressure"), (choice.modulus, "every modulus")) if on]
    return (
        "The contained air has one temperature and a constant volume. What follows the temperature: "
        f"{' and '.join(acting) or 'nothing'}. A modulus is taken at its region's mean temperature, where the card "
        "gives a softening."
    )
