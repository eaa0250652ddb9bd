"""The answers to a design study."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from tyrefem.api.result import Result
from tyrefem.api.verbs import shown, with_verbs
from tyrefem.output import as_path
from tyrefem.sweep import design


class Design(design.DesignData):
    """The answers to a design study, with `save`; `run` and `to_vtk` of variants."""

    def _repr_html_(self) -> str | None:
        from tyrefem.reports.notebook import design_page

        return shown(lambda: design_page(self))

    def save(self, folder: str | Path, *, pictures: bool = True, force: bool = False) -> Path:
        """Write the files of `tyrefem sweep`: every table (CSV and Parquet), ``study.toml``, ``summary.json``, and with
        pictures the PNG files and ``sweep.html``; return the folder.

        ``force``: replace the user's files and the results of other commands.

        Raises
        ------
        InputError : the folder cannot be written; files in it are not of this command.
        """
        from tyrefem.api.saving import saving
        from tyrefem.inputs.origin import StudyOrigin
        from tyrefem.reports.sweep_files import save, saved_names

        with saving(folder, "sweep", saved_names(), StudyOrigin(self.study), force=force) as place:
            save(self, place, pictures=pictures)
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

        return write_variants(self, as_path(folder, "folder"), variants, revolved=revolved)
