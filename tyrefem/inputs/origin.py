"""What made a folder of results: the study beside the files, and the part of ``summary.json`` that tells of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.output import SUMMARY, versions, write_json

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData

#: The study of a folder of results, with all changes: `tyrefem.load` of the folder reads it.
STUDY = "study.toml"


def study_names(study: StudyData, folder: str | Path) -> tuple[str, ...]:
    """Name of the study's file in a folder of results; empty where the study's own file stands in its place."""
    target = Path(folder) / STUDY
    return () if study.file is not None and target.resolve() == study.file.resolve() else (STUDY,)


def write_study_beside(study: StudyData, folder: Path) -> list[str]:
    """Write the study into a folder of results, unless its own file stands there; return the name."""
    names = list(study_names(study, folder))
    for name in names:
        study.save(folder / name)
    return names


def origin(
    study: StudyData, *also: Any, tolerance: float | None = None, random_seed: int | None = None
) -> dict[str, Any]:
    """What made a result: study, mesh, versions, plugins, seed and the study's data with all changes.

    Parameters
    ----------
    also : plain data that may name more plugins. tolerance : of the time steps, K; None: nothing is simulated.
    random_seed : None: nothing is random.
    """
    return {
        "study": study.name,
        "title": study.title,
        **({} if tolerance is None else {"tolerance_K": tolerance}),
        "mesh": mesh_summary(study),
        "versions": versions(),
        **plugin_summary(study, *also),
        "random_seed": random_seed,
        "input": dict(study.data),
    }


def mesh_summary(study: StudyData) -> dict[str, Any]:
    """How the study is meshed: mesher and size, or the user's file."""
    choice = study.card.mesh
    made = {"mesher": choice.mesher, "size_m": choice.size, "cell": choice.cell, "through": choice.through}
    read = {"mesher": "file", "size_m": None, "file": choice.file}
    return (made if choice.file is None else read) | {"element": choice.element, "section": choice.section}


def write_origin(
    study: StudyData,
    folder: Path,
    *also: Any,
    tolerance: float | None = None,
    random_seed: int | None = None,
) -> None:
    """Write the study, and `origin` as ``summary.json``: for a command whose answer is another file."""
    write_study_beside(study, folder)
    write_json(origin(study, *also, tolerance=tolerance, random_seed=random_seed), folder / SUMMARY)
