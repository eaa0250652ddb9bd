"""The answers to a design study."""

from __future__ import annotations

from pathlib import Path

from tyrefem.api.verbs import shown
from tyrefem.sweep import design


class Design(design.DesignData):
    """The answers to a design study, with `save`."""

    def _repr_html_(self) -> str | None:
        from tyrefem.reports.notebook import design_page

        return shown(lambda: design_page(self))

    def save(self, folder: str | Path, *, pictures: bool = True) -> Path:
        """Write every table (CSV and Parquet), ``summary.json``, and with pictures the PNG files and ``sweep.html``.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.sweep_files import save

        save(self, Path(folder), pictures=pictures)
        return Path(folder)
