"""The answers to a design study."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from tyrefem.api.result import Result
from tyrefem.api.verbs import shown, with_verbs
from tyrefem.sweep import design


class Design(design.DesignData):
    """The answers to a design study, with `save`; `run` and `to_vtk` of variants."""

    def _repr_html_(self) -> str | None:
        from tyrefem.reports.notebook import design_page

        return shown(lambda: design_page(self))

    def save(self, folder: str | Path, *, pictures: bool = True) -> Path:
        """Write every table (CSV and Parquet), ``summary.json``, and with pictures the PNG files and ``sweep.html``.

        Returns the folder.

        Raises
        ------
        InputError : the folder cannot be written.
        """
        from tyrefem.reports.sweep_files import save

        save(self, Path(folder), pictures=pictures)
        return Path(folder)

    def run(self, variant: str | int) -> Result:
        """A full run of a variant of the sample, by its name in the table.

        Raises
        ------
        InputError : no sample, or no variant of that name; errors of a run.
        """
        from tyrefem.simulation.run import run

        return with_verbs(Result, run(self.variant_study(variant)))

    def to_vtk(
        self, folder: str | Path, variants: Iterable[str | int] | None = None, *, revolved: bool = False
    ) -> dict[str, Path]:
        """Run chosen variants in full, and write the VTK files of each as ``variants/NAME``: name -> its .pvd.

        ``variants``: names in the table; None: those on the Pareto front. ``revolved``: also as a whole ring.

        Raises
        ------
        InputError : no sample, or no variant of that name; none on the front; the folder cannot be written.
        """
        from tyrefem.reports.sweep_variants import write_variants

        return write_variants(self, Path(folder), variants, revolved=revolved)
