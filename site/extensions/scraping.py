"""Pictures of examples: matplotlib's, and 3D scenes of pyvista that turn in the browser.

Scenes and their viewer (vtk.js, in the trame-vtk package) need no network: every scene is one HTML file, which also
opens from a folder.
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import os
import tempfile
from pathlib import Path
from typing import Any

#: 3D scenes need trame's exporter; without it, 3D views are pictures.
INTERACTIVE = all(
    importlib.util.find_spec(name) is not None for name in ("trame_vtk", "trame_pyvista", "nest_asyncio2")
)
EXTENSIONS = ["scenes"] if INTERACTIVE else []


def scrapers() -> tuple[Any, ...]:
    """The scrapers of sphinx-gallery's ``image_scrapers``."""
    from pyvista.plotting.utilities.sphinx_gallery import DynamicScraper, Scraper

    if INTERACTIVE:
        start_exporter()
    return ("matplotlib", DynamicScraper() if INTERACTIVE else Scraper())


def start_exporter() -> None:
    """Export an empty scene: the exporter prints a line when it starts, which would stand on an example's page.

    trame would also download a second viewer, of WebAssembly, which no page shows: an empty folder in its place.
    """
    import pyvista

    os.environ.setdefault("VTK_WASM_DIR_OVERRIDE", tempfile.mkdtemp(prefix="no-wasm-"))
    with contextlib.redirect_stdout(io.StringIO()):
        pyvista.Plotter(off_screen=True).trame.export_vtksz(filename=None)
        pyvista.close_all()


def note_example(_configuration: dict[str, Any], name: str) -> None:
    """Remember which example runs: tables of references are kept by its name. Forget another's plugins."""
    for variable in ("TYREFEM_EFFECTS", "TYREFEM_PLUGINS"):
        os.environ.pop(variable, None)
    os.environ["TYREFEM_SITE_EXAMPLE"] = Path(name).stem
