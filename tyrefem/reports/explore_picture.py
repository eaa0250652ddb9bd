"""Picture of the section for the page of an exploration: nodes, triangles, modes, outlines, sensors."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.geometry.outlines import label_place
from tyrefem.geometry.place_names import place
from tyrefem.reports.figures.cells import triangles

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.realtime.box_model import BoxModel

Array = NDArray[Any]
#: Nodes of the picture: all unknowns of the mesh up to this number, above it the corners of its elements.
MOST_NODES = 16_000
_KINDS = {"f8": np.float64, "f4": np.float32, "i2": np.int16, "i4": np.int32, "u2": np.uint16}


def packed(values: Any, kind: str | None = None) -> dict[str, Any]:
    """An array for the page: shape, kind of its numbers, base64 of its bytes; single precision where it is exact."""
    array = np.asarray(values)
    if kind is None:
        plain = array.astype(np.float64)
        kind = "f4" if plain.size and np.array_equal(plain.astype(np.float32).astype(float), plain) else "f8"
    data = np.ascontiguousarray(array, dtype=np.dtype(_KINDS[kind]).newbyteorder("<"))
    return {"shape": list(data.shape), "type": kind, "data": base64.b64encode(data.tobytes()).decode()}


def picture(model: BoxModel) -> dict[str, Any]:
    """Nodes, triangles and modes of the picture; the modes as integers, column by column: V = low + step q."""
    reduced, section = model.reduced, model.study.section
    operators = reduced.operators
    corners, _ = triangles(operators)
    points, modes = operators.points, reduced.V
    if len(modes) > MOST_NODES:
        vertices = np.asarray(operators.element_dofs)[: 3 if len(operators.element_dofs) in (3, 6) else 4]
        cells = [vertices[[0, 1, 2]]] + ([vertices[[0, 2, 3]]] if len(vertices) == 4 else [])
        used, corners = np.unique(np.concatenate(cells, axis=1).T, return_inverse=True)
        corners = corners.reshape(-1, 3)
    else:
        used = np.arange(len(modes))
    hot = model.arrays["hot_nodes"].astype(int)
    rows = modes[used]
    low, step = rows.min(axis=0), np.maximum(np.ptp(rows, axis=0), 1e-300) / 65000.0
    size = reduced.size
    return {
        "points": packed(points[:, used].T * 1e3, "f4"),
        "triangles": packed(corners, "u2" if len(used) < 65536 else "i4"),
        "modes": packed(np.round((rows - low) / step) - 32500, "i2"),
        "low": packed(low + 32500 * step, "f8"),
        "step": packed(step, "f8"),
        "turn": packed(model.arrays["turn"][:size, :size], "f8"),
        "hot": packed(points[:, hot].T * 1e3, "f8"),
        "where": [place(section, *_located(section, points[:, node])) for node in hot],
        "outlines": [packed(line * 1e3, "f4") for line in outlines(section)],
        "mirror": bool(section.half),
        "regions": region_places(section),
        "colours": base64.b64encode(colours()).decode(),
    }


def _located(section: Any, point: Array) -> tuple[float, float]:
    s, depth = section.locate(point[None])
    return float(np.ravel(s)[0]), float(np.ravel(depth)[0])


def outlines(section: Any) -> list[Array]:
    """Borders of all regions, (k, 2) m in (r, z), broken at the mid plane of a half section."""
    lines = []
    for region in section.regions:
        for polygon in section.outline(region, 1e-3):
            closed = np.vstack([polygon, polygon[:1]])
            cut = (np.abs(closed[:-1, 1]) < 1e-9) & (np.abs(closed[1:, 1]) < 1e-9) & section.half
            begin = 0
            for end in [*(np.flatnonzero(cut) + 1).tolist(), len(closed)]:
                if end - begin > 1:
                    lines.append(closed[begin:end])
                begin = end
    return lines


def region_places(section: Any) -> list[dict[str, Any]]:
    """Every region with the place of its name, mm."""
    places = []
    for region in section.regions:
        r, z = label_place(section, region)
        places.append({"name": region, "r": float(r) * 1e3, "z": float(z) * 1e3})
    return places


def colours() -> bytes:
    """256 colours of temperature, red, green and blue bytes, from cold to hot."""
    from matplotlib import colormaps

    from tyrefem.reports.figures.style import temperature_map

    chosen: Any = temperature_map()
    table = colormaps[chosen] if isinstance(chosen, str) else chosen
    return bytes((table(np.linspace(0, 1, 256))[:, :3] * 255).round().astype(np.uint8).tobytes())


def sensors(study: StudyData) -> list[dict[str, Any]]:
    """Name, place in mm, region and lag of every sensor."""
    from tyrefem.simulation.sensors import true_places

    section, listed = study.section, []
    for name, (r, z) in true_places(study).items():
        s, depth = _located(section, np.array([r, z]))
        listed.append(
            {
                "name": name, "r": r * 1e3, "z": z * 1e3, "where": place(section, s, depth),
                "noise": study.sensors[name].noise, "lag": study.sensors[name].lag,
            }
        )  # fmt: skip
    return listed
