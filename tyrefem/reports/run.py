"""The report of a run: one HTML file with main results, tables and pictures, which needs no other file."""

from __future__ import annotations

import base64
import datetime
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.output import atomic_path
from tyrefem.reports.assumptions import assumptions
from tyrefem.reports.explore_link import ExploreLink, explore_link
from tyrefem.reports.inputs import boundary_rows, effect_rows, mechanics_rows, section_sources, study_text
from tyrefem.reports.materials import material_rows
from tyrefem.reports.run_files import loaded_cycle, of_run
from tyrefem.reports.run_headline import headline
from tyrefem.reports.run_tables import (
    budget_rows,
    extreme_rows,
    numerics_rows,
    phase_rows,
    sensor_rows,
    sliding_rows,
    slip_columns,
)
from tyrefem.reports.template import rendered
from tyrefem.reports.words import seconds

if TYPE_CHECKING:
    from tyrefem.simulation.result import ResultData


def content(result: ResultData) -> dict[str, Any]:
    """All values of the template, as text."""
    study = result.study
    materials, estimates = material_rows(study)
    text, as_written = study_text(study)
    return {
        "title": study.title,
        "name": study.name,
        "written": datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M"),
        "interrupted": _interrupted(result),
        "warnings": result.warnings,
        "sliding": sliding_rows(result),
        "headline": headline(result),
        "published": [value.cells for value in of_run(result)],
        "sensors": sensor_rows(result),
        "thermocouples": bool(result.sensor_places),
        "extremes": extreme_rows(result),
        "phases": phase_rows(result),
        "slip": list(slip_columns(study.card.drive)),
        "budget": budget_rows(result),
        "imbalance": f"{result.heat_budget.imbalance:.1e}",
        "materials": materials,
        "estimates": estimates,
        "boundaries": boundary_rows(study),
        "effects": effect_rows(study),
        "mechanics": mechanics_rows(study, loaded_cycle(result)),
        "sources": section_sources(study),
        "numerics": numerics_rows(result),
        "assumptions": assumptions(study, estimates),
        "study_text": text,
        "as_written": as_written,
    }


def _interrupted(result: ResultData) -> str:
    if not result.history.interrupted:
        return ""
    return f"{seconds(result.times[-1])} of {seconds(result.study.card.drive.end)}"


#: Picture -> caption.
CAPTIONS = {
    "temperature.png": "Temperature on the section at the end of the run, with the thermocouples' readings.",
    "temperature-hottest.png": "Temperature on the section at the time of the highest temperature.",
    "histories.png": "Readings of the thermocouples and temperature of the contained air over time.",
    "sliding.png": "Contact temperatures in every phase with slip. The exit edge is the hottest place of a contact.",
    "heat-budget.png": "Left: generated heat (rising) equals stored and lost heat (falling). Right: powers over time.",
    "heat-source.png": "Heat source by zone, and strain energy per revolution where both sides are alike, at the end "
    "of the rolling phase with most heat.",
    "strain-cycle.png": "The section without load and under the largest load, and the strain cycle along the meridian.",
    "mesh.png": "The modelled mesh.",
    "3d": "Temperature of the tyre, a quarter cut away.",
}
#: Captions of a run without thermocouples.
BARE = {
    "temperature.png": "Temperature on the section at the end of the run.",
    "histories.png": "Temperature of the lumped bodies over time.",
}


def write_report(result: ResultData, path: Path, *, three_d: bool = False) -> Path:
    """Write the report; pictures already drawn for this result are reused.

    Parameters
    ----------
    three_d : add a 3D picture, if the machine can render it.

    Raises
    ------
    InputError : the file cannot be written.
    """
    path = Path(path)
    page = render(result, explore_link(result.study, path), three_d=three_d)
    with atomic_path(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return path


def render(result: ResultData, explored: ExploreLink | None = None, *, three_d: bool = False) -> str:
    """The report's HTML."""
    from tyrefem.reports.figures import pictures

    drawn = dict(pictures(result))
    picture = _three_d(result) if three_d else None
    if picture is not None:
        drawn["3d"] = picture
    captions = CAPTIONS if result.sensor_places else CAPTIONS | BARE
    embedded = [
        {"data": base64.b64encode(png).decode("ascii"), "caption": captions.get(name, ""), "name": name}
        for name, png in drawn.items()
    ]
    return rendered("run.html.j2", pictures=embedded, explored=explored, **content(result))


def _three_d(result: ResultData) -> bytes | None:
    from tyrefem.reports.view3d import screenshot
    from tyrefem.reports.vtk import write_series

    with tempfile.TemporaryDirectory() as folder:
        last = replace(result, field_times=result.times[-1:])
        collection = write_series(last, Path(folder), revolved=True)
        ring = collection.with_name(f"{collection.stem}-revolved.pvd")
        drawn = screenshot(ring, Path(folder) / "3d.png")
        return drawn.read_bytes() if drawn else None
