"""The model of all settings of a box, as a page."""

from __future__ import annotations

from pathlib import Path

from tyrefem.output import as_path
from tyrefem.realtime import box_model


class Exploration(box_model.BoxModel):
    """A certified model of all settings of a box, shown in a notebook as its page; with `save`."""

    def _repr_html_(self) -> str:
        from tyrefem.reports.explore import framed, page

        return framed(page(self))

    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the page of `tyrefem explore`: one HTML file that needs no network, and beside it the study.

        ``force``: replace files that this tool did not make, or that have changed since.

        Raises
        ------
        InputError : the file cannot be written, or is not of this tool.
        """
        from tyrefem.api.saving import saving_file
        from tyrefem.inputs.origin import StudyOrigin
        from tyrefem.reports.explore import write_page

        with saving_file(path, (".html",), StudyOrigin.beside(self.study, as_path(path, "path")), force=force) as place:
            return write_page(self, place)
