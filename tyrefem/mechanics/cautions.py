"""What a person should know of a study's input, with its effects beside a strain law that presses the tyre itself."""

from __future__ import annotations

from collections.abc import Iterator

from tyrefem.errors import InputWarning
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.strain_laws import strain_laws


def warnings_of(study: StudyData) -> tuple[InputWarning, ...]:
    """All warnings of a study, each once: of unusual input, and of its effects beside its strain law."""
    return tuple(dict.fromkeys((*study.input_warnings, *_beside_pressing(study))))


def _beside_pressing(study: StudyData) -> Iterator[InputWarning]:
    """`Effect.beside_pressing` of the study's effects, where its law says that it `presses`."""
    law = strain_laws().get(study.card.mechanics.strain)
    if law is None or not law.presses:
        return
    for effect in study.effects:
        words = effect.beside_pressing(study)
        if words:
            yield InputWarning(f"{words}; the strain law is '{law.name}'", f"effects.{effect.name}", study.file)
