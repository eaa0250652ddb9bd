"""Whether a study goes with a model in real time, as far as its file tells: before any run."""

from __future__ import annotations

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData

#: Keys of a drive whose friction heats the tread.
MOTION = ("slip_ratio", "slip_speed", "slip_angle", "torque", "camber")
#: Port of an effect -> what acts there, that a model in real time does not have.
PORTS = {
    "heat_factor": "changes the heat source; a real-time model has the strain cycle's heat only",
    "heat_addend": "adds a heat source; a real-time model has the strain cycle's heat only",
    "rim_power": "heats the rim; a real-time model has no such heat",
}
#: Port of an effect on a surface -> the same.
SURFACE_PORTS = {
    "flux": "gives heat to a surface; a real-time model has films only",
    "radiation": "radiates; a real-time model has films only",
}


def check_suitable(study: StudyData) -> None:
    """Raise an error for a study that a model in real time cannot represent.

    Raises
    ------
    InputError : slip, torque, camber or friction of a rolling tyre; feedback of temperature on the strain cycle; a
        material card over temperature or frequency; an effect with states, or with heat beside that of the strain
        cycle. The message names card and effect.
    """
    check_motion(study)
    check_materials(study)
    if study.card.mechanics.feedback is not None:
        raise InputError(
            "a real-time model has no feedback of temperature on the strain cycle", field="mechanics.feedback"
        )
    for effect in study.effects:
        problems = [words for port, words in PORTS.items() if effect.overrides(port)]
        problems += [words for port, words in SURFACE_PORTS.items() if effect.surfaces and effect.overrides(port)]
        problems += ["has a state; a real-time model has those of rubber, air and rim"] if effect.states else []
        if problems:
            raise InputError(problems[0], field=f"effects.{effect.name}")


def check_materials(study: StudyData) -> None:
    """Raise an error for cards with conductivity or heat capacity over temperature, or tan delta over frequency."""
    for region, card in study.materials.items():
        for name in ("conductivity", "density", "specific_heat"):
            if getattr(card, name).table is not None:
                raise InputError(
                    "depends on temperature; a real-time model has a single value, without 'table'",
                    field=f"materials.{region}.{name}",
                )
        if card.loss_tangent.depends_on_frequency:
            raise InputError(
                "depends on frequency; in a real-time model it depends on temperature only",
                field=f"materials.{region}.loss_tangent",
            )


def check_motion(study: StudyData) -> None:
    """Raise an error for a drive with friction of the tread on the road."""
    if study.card.boundaries.sliding.rolls:
        raise InputError("a real-time model has no friction of a rolling tyre", field="boundaries.sliding")
    drive = study.data["drive"]
    for key in (key for part in (drive, *drive.get("phases", [])) for key in part):
        if key in MOTION:
            raise InputError(f"a real-time model has no slip, torque or camber: remove '{key}'", field="drive")
