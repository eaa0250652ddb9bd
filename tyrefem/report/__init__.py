"""The report of a run: one HTML file with everything in it, pictures included; no script, no links."""

from __future__ import annotations

import base64
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.output import atomic_path

if TYPE_CHECKING:
    from tyrefem.result import Result

#: Picture -> what it shows.
CAPTIONS = {
    "temperature.png": "Temperature on the section at the end of the run, with the thermocouples' readings.",
    "temperature-hottest.png": "The same at the moment when the tyre was hottest.",
    "histories.png": "Readings over time.",
    "sliding.png": "The contact in every phase with slip; the exit edge is the hottest a tread point gets.",
    "heat-budget.png": "Left: the heat that was generated (rising) equals what was stored and lost (falling). "
    "Right: the powers over time.",
    "heat-source.png": "Strain energy per revolution, and the heat it becomes, by zone, at the end of the last "
    "phase that rolls under load.",
    "strain-cycle.png": "The section before and under the largest load, and the strain cycle along the meridian.",
    "mesh.png": "The mesh, as modelled.",
    "3d": "Surface temperature, a quarter of the tyre cut away.",
}


def write_report(result: Result, path: Path, *, three_d: bool = False) -> Path:
    """Write the report; the pictures already drawn for this result are used again.

    Parameters
    ----------
    three_d : also a 3D picture, where the machine can render one.

    Raises
    ------
    InputError : the file cannot be written.
    """
    path = Path(path)
    page = render(result, three_d=three_d)
    with atomic_path(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return path


def render(result: Result, *, three_d: bool = False) -> str:
    """The report's HTML."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from tyrefem.plotting import pictures
    from tyrefem.report.content import content

    drawn = dict(pictures(result))
    picture = _three_d(result) if three_d else None
    if picture is not None:
        drawn["3d"] = picture
    embedded = [
        {"data": base64.b64encode(png).decode("ascii"), "caption": CAPTIONS.get(name, ""), "name": name}
        for name, png in drawn.items()
    ]
    environment = Environment(
        loader=PackageLoader("tyrefem.report", "."), autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True,
    )  # fmt: skip
    return environment.get_template("report.html.j2").render(pictures=embedded, **content(result))


def _three_d(result: Result) -> bytes | None:
    from tyrefem.view3d import screenshot
    from tyrefem.vtk import write_series

    with tempfile.TemporaryDirectory() as folder:
        last = replace(result, field_times=result.times[-1:])
        collection = write_series(last, Path(folder), revolved=True)
        ring = collection.with_name(f"{collection.stem}-revolved.pvd")
        drawn = screenshot(ring, Path(folder) / "3d.png")
        return drawn.read_bytes() if drawn else None
