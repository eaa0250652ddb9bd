"""Pictures of a run, a section, a mesh and a strain cycle. matplotlib is imported when a picture is drawn."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.cache import Cache, fingerprint
from tyrefem.output import atomic_path

if TYPE_CHECKING:
    from tyrefem.simulation.result import ResultData

#: File names of the standard pictures.
PICTURES = (
    "temperature.png", "temperature-hottest.png", "histories.png", "sliding.png", "heat-budget.png", "heat-source.png",
    "strain-cycle.png", "mesh.png",
)  # fmt: skip
#: Number of results whose pictures are kept, for the page and the files; about 1 MB each.
_DRAWN: Cache[dict[str, bytes]] = Cache(size=4)


def _figures(result: ResultData) -> dict[str, Callable[[], Any]]:
    """File name -> function that draws it, in the order of a report."""
    from tyrefem.reports.figures.budget import budget_figure
    from tyrefem.reports.figures.heat_source import heat_source_figure
    from tyrefem.reports.figures.histories import histories_figure
    from tyrefem.reports.figures.mesh import mesh_figure
    from tyrefem.reports.figures.road import sliding_figure
    from tyrefem.reports.figures.strain import cycle_figure
    from tyrefem.reports.figures.temperature import temperature_figure

    drawings: dict[str, Callable[[], Any]] = {"temperature.png": lambda: temperature_figure(result)}
    hottest, sliding = result.history.maximum, result.sliding
    if hottest.time < result.times[-1] and hottest.temperature > float(result.history.values[-1].max()) + 0.1:
        drawings["temperature-hottest.png"] = lambda: temperature_figure(result, hottest.time)
    drawings |= {
        "histories.png": lambda: histories_figure(result),
        **({"sliding.png": lambda: sliding_figure(sliding)} if sliding is not None else {}),
        "heat-budget.png": lambda: budget_figure(result),
        "heat-source.png": lambda: heat_source_figure(result),
    }
    if hasattr(result.tyre.schedule.cycles[0][0], "inflated"):
        drawings["strain-cycle.png"] = lambda: cycle_figure(result.study, result.tyre.schedule)
    return drawings | {"mesh.png": lambda: mesh_figure(result.tyre.mesh)}


def pictures(result: ResultData) -> dict[str, bytes]:
    """File name -> PNG of the standard pictures of a run; those of the 4 latest results are cached.

    ``temperature`` at the end, and at the time of its maximum if that is earlier; ``histories``; ``heat-budget``;
    ``heat-source``; ``strain-cycle``; ``mesh``; with slip ``sliding``.
    """
    from tyrefem.reports.figures.style import png

    return _DRAWN.get(_content(result), lambda: {name: png(draw()) for name, draw in _figures(result).items()})


def _content(result: ResultData) -> tuple[Any, ...]:
    """All data of the pictures: the study with its cards, the mesh, the temperatures."""
    study, mesh = result.study, result.tyre.mesh.mesh
    arrays = (mesh.p, mesh.t, result.times, result.field_times, np.asarray(result.history.values))
    return study.name, study.section, repr(study.data), repr(study.material_data), fingerprint(*arrays)


def write_pictures(result: ResultData, folder: Path) -> list[Path]:
    """Write the standard pictures as PNG files, each completely or not at all.

    Raises
    ------
    InputError : the folder cannot be written.
    """
    paths = []
    for name, content in pictures(result).items():
        path = Path(folder) / name
        with atomic_path(path) as temporary:
            temporary.write_bytes(content)
        paths.append(path)
    return paths
