"""Readings of a simulated drive: temperatures at points of the section, and the columns that a logger records."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.conduction.points import OutsideMeshError, as_points, located
from tyrefem.geometry.meshing.sagitta import kept_inside, snapped
from tyrefem.simulation.sensors import logged
from tyrefem.simulation.surroundings import GAS

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]


def temperatures_at(tyre: RollingTyre, values: Array, points: ArrayLike) -> Array:
    """(n_times, n_points) degC at points (n_points, 2) in (r, z), m, from ``values`` (n_times, n) at the unknowns.

    A point between the section's curved outline and the mesh's straight edges gets the temperature of the nearest point
    of the mesh.

    Raises
    ------
    InputError : a point is farther outside; names the point and its distance.
    """
    operators = tyre.problem.operators
    try:
        place = located(operators, points)
    except OutsideMeshError as error:
        places = as_points(points).copy()
        places[error.numbers] = snapped(tyre.mesh, places[error.numbers])
        place = located(operators, places)
    return np.asarray((place.value() @ values.T).T)


def within(tyre: RollingTyre, points: ArrayLike) -> Array:
    """Points (n, 2) of the rubber, m, those outside the straight-sided elements moved to the nearest edge."""
    section = tyre.study.section
    s, depth = section.locate(np.asarray(points, dtype=float).reshape(-1, 2))
    return kept_inside(tyre.mesh, section.place(*section.clamp(s, depth)))


def contained_air(study: StudyData, times: Array, reservoirs: Mapping[str, Array]) -> Array:
    """Temperature of the contained air, (n_times,) degC: a lumped body's, or the study's."""
    if GAS in reservoirs:
        return np.asarray(reservoirs[GAS])
    return np.full(len(times), study.card.boundaries.contained_air.fixed_temperature)


def logged_columns(
    study: StudyData, times: Array, sensors: Mapping[str, Array], lumped: Mapping[str, Array]
) -> dict[str, Array]:
    """``time_s``, one column per sensor, contained air and rim; degC.

    Parameters
    ----------
    sensors : recorded readings. lumped : temperatures of contained air and rim, which the logger's clock shifts too.
    """
    return {"time_s": times, **sensors, **{name: logged(study, times, column) for name, column in lumped.items()}}
