"""The directive ``offlineviewer`` of pyvista's scraper, with scene and viewer in one file.

pyvista's own directive has the viewer ask for the scene, which browsers refuse in pages opened from a folder.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx.application import Sphinx
from trame_vtk.tools.vtksz2html import embed_data_to_viewer_file


class OfflineViewer(Directive):
    """A 3D scene, ``.vtksz``, that turns, moves and zooms in the page."""

    required_arguments = 1
    final_argument_whitespace = True

    def run(self) -> list[nodes.Node]:
        environment = self.state.document.settings.env
        page = Path(self.state.document.current_source)
        scene = (page.parent / self.arguments[0]).resolve()
        folder = Path(environment.app.outdir) / "_static" / "scenes"
        folder.mkdir(parents=True, exist_ok=True)
        file = folder / f"{scene.stem}.html"
        embed_data_to_viewer_file(scene.read_bytes(), file)
        target = Path(environment.app.outdir) / environment.app.builder.get_target_uri(environment.docname)
        address = Path(os.path.relpath(file, target.parent)).as_posix()
        title = "3D scene: drag to turn, scroll to zoom"
        frame = f'<iframe class="scene" src="{address}" title="{title}" loading="lazy"></iframe>'
        return [nodes.raw("", frame, format="html")]


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_directive("offlineviewer", OfflineViewer)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
