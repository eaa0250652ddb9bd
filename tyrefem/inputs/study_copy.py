"""A study with all of its cards as plain data: what it was, though its files change or go."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

from tyrefem.inputs.study import StudyData
from tyrefem.inputs.study_parts import StudyParts
from tyrefem.quantity import written

Kind = TypeVar("Kind", bound=StudyData)


def copied(study: StudyData) -> dict[str, Any]:
    """Name, data, file and folder of a study, and its cards as they were read."""
    content, path, name = study.parts.section_card
    return {
        "name": study.name,
        "data": written(study.data),
        "file": None if study.file is None else str(study.file),
        "folder": None if study.folder is None else str(study.folder),
        "section": [written(content), str(path), name],
        "materials": {region: [written(card), str(file)] for region, (card, file) in study.material_data.items()},
    }


def study_of(kind: type[Kind], copy: Mapping[str, Any]) -> Kind:
    """The study of a copy, as an object of ``kind``; no card is read from a file.

    Raises
    ------
    InputError : a value that is no longer allowed, or an effect that is unknown here.
    """
    file, folder = (None if copy[key] is None else Path(copy[key]) for key in ("file", "folder"))
    section, path, name = copy["section"]
    cards = {region: (card, Path(place)) for region, (card, place) in copy["materials"].items()}
    parts = StudyParts.of_cards(copy["data"], file, folder, (section, Path(path), name), cards)
    return kind(copy["name"], copy["data"], file, folder, None, parts)
