"""What a person should know of a study's effects beside a strain law that presses the tyre on the road itself."""

from __future__ import annotations

from tyrefem.errors import InputWarning
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.strain_laws import strain_laws


def cautions(study: StudyData) -> tuple[InputWarning, ...]:
    """`Effect.beside_pressing` of the study's effects, where its law says that it `presses`."""
    law = strain_laws().get(study.card.mechanics.strain)
    if law is None or not law.presses:
        return ()
    words = ((effect, effect.beside_pressing(study)) for effect in study.effects)
    return tuple(
        InputWarning(f"{text}; the strain law is '{law.name}'", f"effects.{effect.name}", study.file)
        for effect, text in words
        if text
    )


def warnings_of(study: StudyData) -> tuple[InputWarning, ...]:
    """All warnings of a study: its own and `cautions`."""
    return tuple(dict.fromkeys((*study.warnings, *cautions(study))))
