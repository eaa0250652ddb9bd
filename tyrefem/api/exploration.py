"""The model of all settings of a box, as a page."""

from __future__ import annotations

from pathlib import Path

from tyrefem.realtime import box_model


class Exploration(box_model.BoxModel):
    """A certified model of all settings of a box, shown in a notebook as its page; with `save`."""

    def _repr_html_(self) -> str:
        from tyrefem.reports.explore import framed, page

        return framed(page(self))

    def save(self, path: str | Path) -> Path:
        """Write the page of `tyrefem explore`: one HTML file that needs no network.

        Raises
        ------
        InputError : the file cannot be written.
        """
        from tyrefem.reports.explore import write_page

        return write_page(self, path)
