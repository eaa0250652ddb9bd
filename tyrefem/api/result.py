"""Result of a run, and results of the cases of a study."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from tyrefem.api.field import SectionField
from tyrefem.api.verbs import shown, with_verbs
from tyrefem.output import as_path
from tyrefem.simulation import result
from tyrefem.sweep import campaign

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

    from tyrefem.measured.cases import Case


class Result(result.ResultData):
    """Result of a run, with methods to write and plot it. `tyrefem.load` reads it from its folder."""

    def _repr_html_(self) -> str | None:
        from tyrefem.reports.notebook import result_page

        return shown(lambda: result_page(self))

    def summary(self) -> dict[str, Any]:
        """Contents of `summary.json`: inputs, versions, mesh, tolerance and main results."""
        from tyrefem.reports.run_files import summary

        return summary(self)

    def field(self, time: float | None = None) -> SectionField:
        """The temperatures at the reading nearest to a time, s; None: the last.

        Raises
        ------
        InputError : a time outside the run.
        """
        return SectionField(self, self.reading_at(time))

    @overload
    def plot(
        self,
        folder: None = None,
        *,
        picture: str = "temperature",
        time: float | None = None,
        axes: Axes | None = None,
    ) -> Axes: ...

    @overload
    def plot(self, folder: str | Path) -> list[Path]: ...

    def plot(
        self,
        folder: str | Path | None = None,
        *,
        picture: str = "temperature",
        time: float | None = None,
        axes: Axes | None = None,
    ) -> Axes | list[Path]:
        """Draw a picture on matplotlib axes, and return the axes; with a folder write the standard pictures as PNG.

        Parameters
        ----------
        folder : for the files; returns their paths.
        picture : "temperature" of the section, "histories" of the sensors, or "heat" of the whole tyre over time.
        time : s; None: the last. Histories and heat end there. axes : None: those of a new figure.

        Raises
        ------
        InputError : no such picture; a time outside the run; the folder cannot be written.
        """
        if folder is not None:
            from tyrefem.reports.figures import write_pictures

            return write_pictures(self, as_path(folder, "folder"))
        from tyrefem.reports.figures.on_axes import draw

        return draw(self, picture, time, axes)

    def to_xarray(self) -> xarray.Dataset:
        """Readings, temperatures at the nodes, heat and contained air over time, with units (CF conventions).

        Raises
        ------
        MissingLibraryError : xarray is not installed.
        """
        from tyrefem.reports.datasets import run_dataset

        return run_dataset(self)

    def to_pyvista(self, time: float | None = None, *, revolved: bool = False) -> Any:
        """A pyvista grid at the reading nearest to a time, s (None: the last): see `SectionField.to_pyvista`."""
        return self.field(time).to_pyvista(revolved=revolved)

    def to_vtk(self, folder: str | Path, *, revolved: bool = False) -> Path:
        """Write ``<name>.pvd``, a .vtu per saved time (regions, T, heat source, strain energy), and ``<name>.py``,
        which shows them in ParaView; return the .pvd. ``revolved``: also ``<name>-revolved.pvd``, the whole ring."""
        from tyrefem.reports.vtk import write_series

        return write_series(self, as_path(folder, "folder"), revolved=revolved)

    def report(self, path: str | Path) -> Path:
        """Write one self-contained HTML report; return its path."""
        from tyrefem.reports.run import write_report

        return write_report(self, as_path(path, "path"))

    def save(self, folder: str | Path, *, parquet: bool = False, force: bool = False) -> Path:
        """Write readings, extremes and heat budget as CSV, ``study.toml``, ``result.npz`` for `tyrefem.load`, and
        ``summary.json``, whose path it returns.

        ``parquet``: the tables also as Parquet, with their units in the columns' metadata. ``force``: replace the
        user's files and the results of other commands.

        Raises
        ------
        InputError : the folder cannot be written; files in it are not of `tyrefem run`.
        """
        from tyrefem.api.saving import saving
        from tyrefem.inputs.origin import StudyOrigin
        from tyrefem.reports.run_files import table_files, write_tables

        with saving(folder, "run", table_files(), StudyOrigin(self.study), force=force) as place:
            return write_tables(self, place, parquet=parquet)


class Campaign(campaign.CampaignData):
    """The cases of a study: each case is a study, whose result can be written and plotted."""

    def outcome(self, case: Case) -> Result | str:
        """The result of a case, or the reason why it failed."""
        outcome = super().outcome(case)
        return outcome if isinstance(outcome, str) else with_verbs(Result, outcome)
