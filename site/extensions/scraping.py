"""Pictures of examples: matplotlib's, and 3D views that turn in the browser where this machine can write them."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path
from typing import Any

#: 3D scenes need trame's exporter; without it, 3D views are pictures.
INTERACTIVE = all(importlib.util.find_spec(name) is not None for name in ("trame_vtk", "trame_vuetify", "trame"))
EXTENSIONS = ["pyvista.ext.viewer_directive"] if INTERACTIVE else []


def scrapers() -> tuple[Any, ...]:
    """The scrapers of sphinx-gallery's ``image_scrapers``."""
    from pyvista.plotting.utilities.sphinx_gallery import DynamicScraper, Scraper

    return ("matplotlib", DynamicScraper() if INTERACTIVE else Scraper())


def note_example(_configuration: dict[str, Any], name: str) -> None:
    """Remember which example runs: tables of references are kept by its name. Forget another's folder of effects."""
    os.environ.pop("TYREFEM_EFFECTS", None)
    os.environ["TYREFEM_SITE_EXAMPLE"] = Path(name).stem
