"""A 3D picture of a VTK file by pyvista, drawn in a child process, which may crash on a machine without graphics."""

from __future__ import annotations

import logging
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from tyrefem.output import atomic_path

#: Largest drawing time, with software rendering, s.
PATIENCE = 120.0
_LOG = logging.getLogger(__name__)


def screenshot(source: str | Path, png: str | Path, *, timeout: float = PATIENCE) -> Path | None:
    """Draw the temperature of a .pvd (its last time) or .vtu file, or the contact of a pressed or rolling tyre, into a
    PNG.

    Returns None and logs one line if the machine cannot render; this raises no error.
    """
    source, png = Path(source), Path(png)
    with atomic_path(png.with_suffix(".tmp.png")) as temporary:
        command = [sys.executable, "-m", "tyrefem.reports.view3d", str(source.resolve()), str(temporary.resolve())]
        # The modules of this process: none from the current folder, where a user's file may have the name of one.
        environment = {**os.environ, "PYTHONSAFEPATH": "1", "PYTHONPATH": os.pathsep.join(sys.path)}
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, errors="replace", timeout=timeout, check=False, env=environment
            )
            failed = done.returncode != 0 and f"the renderer ended with code {done.returncode}{_last_line(done.stderr)}"
        except subprocess.TimeoutExpired:
            failed = f"the renderer took longer than {timeout:g} s"
        drawn = temporary.read_bytes() if not failed and temporary.is_file() else b""
        temporary.write_bytes(drawn)
    png.with_suffix(".tmp.png").unlink()
    if not drawn:
        reason = failed or "the renderer wrote nothing"
        _LOG.warning("no 3D picture of %s: %s (VTK and matplotlib pictures are not affected)", source.name, reason)
        return None
    with atomic_path(png) as temporary:
        temporary.write_bytes(drawn)
    return png


def _last_line(text: str) -> str:
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return f": {lines[-1][:120]}" if lines else ""


def _draw(source: Path, png: Path) -> None:
    import pyvista

    if source.suffix == ".pvd":
        reader = pyvista.get_reader(str(source))
        reader.set_active_time_value(reader.time_values[-1])
        grid = reader.read()[0]
    else:
        grid = pyvista.read(str(source))
    plotter = pyvista.Plotter(off_screen=True, window_size=(1200, 900))
    plotter.set_background("white")
    bar = {
        "title": "temperature [degC]", "color": "black", "vertical": True, "position_x": 0.87, "position_y": 0.2,
        "height": 0.6, "width": 0.07, "fmt": "%.0f",
    }  # fmt: skip
    if "contact_pressure_Pa" in grid.point_data:
        _add_contact(plotter, grid, grid["contact_pressure_Pa"], bar | {"title": "contact pressure [kPa]"})
        plotter.view_xy()
        plotter.camera.azimuth, plotter.camera.elevation = 55.0, -28.0
        plotter.camera.zoom(1.35)
    elif "traction_Pa" in grid.point_data:
        traction = (grid["traction_Pa"] ** 2).sum(axis=1) ** 0.5
        _add_contact(plotter, grid, traction, bar | {"title": "friction [kPa]"})
        plotter.view_vector((0.9, -0.5, -0.95), viewup=(0.0, 0.0, 1.0))
        plotter.camera.zoom(1.3)
    else:
        _add_temperature(plotter, grid, bar)
    plotter.screenshot(str(png))


def _add_temperature(plotter: Any, grid: Any, bar: dict[str, Any]) -> None:
    from tyrefem.reports.figures.style import temperature_map

    flat = grid.bounds[5] - grid.bounds[4] < 1e-9
    if not flat:
        # A quarter is cut away to show the inside; a half tyre gets its mirror image.
        centres = grid.cell_centers().points
        grid = grid.extract_cells(~((centres[:, 1] > 0) & (centres[:, 2] > 0)))
        if grid.bounds[0] > -1e-6:
            grid = grid.merge(grid.reflect((1.0, 0.0, 0.0)))
    plotter.add_mesh(
        grid, scalars="temperature_degC", cmap=temperature_map(), scalar_bar_args=bar, ambient=0.45, diffuse=0.6
    )
    plotter.view_xy()
    if not flat:
        plotter.camera.azimuth, plotter.camera.elevation = 40.0, 25.0
        plotter.camera.zoom(1.35)


def _add_contact(plotter: Any, grid: Any, values: Any, bar: dict[str, Any]) -> None:
    """Show values of the points, Pa, in the contact; the tyre is grey outside it."""
    import numpy as np

    grid["contact"] = np.asarray(values) / 1e3
    surface = grid.extract_surface(algorithm="dataset_surface")
    inside = np.asarray(surface["contact"])
    touching = inside[inside > 0]
    surface["contact"] = np.where(inside > 0, inside, np.nan)
    most = float(np.quantile(touching, 0.97)) if len(touching) else 1.0
    plotter.add_mesh(
        surface, scalars="contact", cmap="viridis", clim=(0, most), nan_color="#c8c8c8", scalar_bar_args=bar,
        ambient=0.35, diffuse=0.7, smooth_shading=False,
    )  # fmt: skip


if __name__ == "__main__":
    _draw(Path(sys.argv[1]), Path(sys.argv[2]))
