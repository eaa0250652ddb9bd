"""The section's temperatures at one time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.brief import Brief
from tyrefem.simulation.result import ResultData

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SectionField(Brief):
    """Temperatures of a run at the reading ``number``. Made by `Result.field`.

    >>> import tyrefem as tf
    >>> run = tf.study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.duration": "60 s"}).run()
    >>> field = run.field(30.0)
    >>> field.time, field.temperature.shape == field.r.shape
    (30.0, True)
    """

    result: ResultData
    number: int

    def _title(self) -> str:
        return f"of {self.result.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        values = self.temperature
        return {
            "time": f"{self.time:g} s",
            "temperature": f"{values.min():.1f} to {values.max():.1f} degC at {len(values)} nodes",
        }

    @property
    def time(self) -> float:
        """Time of the reading, s."""
        return float(self.result.times[self.number])

    @property
    def temperature(self) -> Array:
        """(n,) degC at the nodes."""
        return np.asarray(self.result.history.values[self.number])

    @property
    def r(self) -> Array:
        """(n,) radius of the nodes, m."""
        return np.asarray(self.result.history.points[0])

    @property
    def z(self) -> Array:
        """(n,) axial position of the nodes, m."""
        return np.asarray(self.result.history.points[1])

    def at(self, points: ArrayLike) -> Array:
        """Temperatures at points (n, 2) in (r, z), m: (n,) degC; errors as `Result.at`."""
        return np.asarray(self.result.at(points)[self.number])

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw the section on matplotlib axes; None: in a new figure. Returns the axes."""
        from tyrefem.reports.figures.on_axes import draw

        return draw(self.result, "temperature", self.time, axes)

    def to_xarray(self) -> xarray.Dataset:
        """Temperature at the nodes with their places, cells and regions, with units.

        Raises
        ------
        MissingLibraryError : xarray is not installed.
        """
        from tyrefem.reports.datasets import run_dataset

        return run_dataset(self.result, range(self.number, self.number + 1)).squeeze("time")

    def to_pyvista(self, *, revolved: bool = False) -> Any:
        """A pyvista grid of the section, or of the whole ring: temperature, heat source, strain energy, region."""
        from tyrefem.reports.grids import pyvista_grid

        return pyvista_grid(self.result, self.number, revolved=revolved)
