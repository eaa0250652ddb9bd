"""Deflection of a tyre whose pressure is not the drive's: what a leak and warm air share."""

from __future__ import annotations

from tyrefem.effects.tyre import StudyOfTyre, Tyre


def deflection_change(tyre: Tyre, t: float, pressure_factor: float) -> float:
    """D(F, factor p) / D(F, p) of the load-deflection law; 1 without load, or where the drive gives the deflection."""
    law, rating = tyre.study.card.mechanics.load_law, tyre.study.section.rating
    load, pressure = (tyre.schedule.mean(quantity, t) for quantity in (lambda c: c.load, lambda c: c.pressure))
    if load <= 0 or tyre.drive.phases[tyre.drive.locate(t)[0]].load is None:
        return 1.0
    return law.deflection(load, pressure_factor * pressure, rating) / law.deflection(load, pressure, rating)


#: What to do beside a strain law that presses the tyre on the road itself.
INSTEAD = "a ramp of the drive's pressure, or mechanics.feedback.pressure, is pressed at its own deflections"


def no_load(study: StudyOfTyre) -> str | None:
    """Why pressure does not matter in a study: its drive gives the deflection, or its law knows no pressure."""
    if study.card.mechanics.load_law.law == "vertical-stiffness":
        return (
            "the deflection is that of mechanics.load_law, and 'vertical-stiffness' does not depend on pressure; "
            f"beside a strain law that presses the tyre itself, such as 'fem', {INSTEAD}"
        )
    if all(phase.load is None for phase in study.card.drive.phases):
        return "the drive gives the deflection, which pressure then does not change"
    return None


def of_load_law(study: StudyOfTyre) -> str:
    """What to know beside a strain law that presses the tyre: the change of deflection is still the load law's."""
    law = study.card.mechanics.load_law.law
    return f"changes the deflection by mechanics.load_law '{law}', not by pressing the tyre: an estimate; {INSTEAD}"
