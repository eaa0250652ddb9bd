"""Forces and moments of a tyre at points of load, slip, slip angle and camber."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError, nearest

Array = NDArray[np.float64]
#: Slip and angles smaller than this count as zero, 1 and rad.
ZERO = 1e-9


@dataclass(frozen=True, eq=False)
class ForcePoints(Brief):
    """(n,) points of a tyre's forces, in the axes ISO-W: x forward, y to the left, z up, at the centre of contact.

    A positive slip angle is a wheel that moves to the left, v_y / v_x = tan(alpha), and so has a force to the right,
    F_y < 0. A positive slip drives, F_x > 0; -1 is a locked wheel. A positive camber leans the top to the right.

    Parameters
    ----------
    load : F_z, N. slip : longitudinal slip, 1. slip_angle, camber : rad. pressure : Pa.
    longitudinal, lateral : F_x, F_y, N. aligning : M_z, N m.

    Raises
    ------
    InputError : lists of different length, a number that is not finite, a load that is not positive, no points.

    >>> points = ForcePoints.of({"load": [4e3, 4e3], "slip_angle": [0.0, 0.02], "lateral": [0.0, -1.1e3]})
    >>> len(points), points.slip.tolist()
    (2, [0.0, 0.0])
    """

    load: Array
    slip: Array
    slip_angle: Array
    camber: Array
    pressure: Array
    longitudinal: Array
    lateral: Array
    aligning: Array

    @classmethod
    def of(cls, columns: Mapping[str, object]) -> ForcePoints:
        """Points of named columns; columns that are not given are zero."""
        names = [field.name for field in fields(cls)]
        for name in columns:
            if name not in names:
                raise InputError(f"no column '{name}' of forces{nearest(name, names)}", field=name)
        given = {name: np.atleast_1d(np.asarray(values, dtype=float)) for name, values in columns.items()}
        if "load" not in given:
            raise InputError("forces need the load of each point", field="load")
        count = given["load"].shape
        return cls(**{name: given.get(name, np.zeros(count)) for name in names})

    def __post_init__(self) -> None:
        count = len(self.load)
        if not count:
            raise InputError("no points of forces", field="load")
        for field in fields(self):
            values = getattr(self, field.name)
            if values.shape != (count,):
                raise InputError(f"has {values.shape} values, but there are {count} loads", field=field.name)
            if not np.isfinite(values).all():
                where = int(np.flatnonzero(~np.isfinite(values))[0]) + 1
                raise InputError(f"value {where} is not finite", field=field.name)
        if not (self.load > 0).all():
            raise InputError("loads must be positive", field="load")

    def __len__(self) -> int:
        return len(self.load)

    def where(self, chosen: NDArray[np.bool_]) -> ForcePoints:
        """The points with a flag (n,); at least one."""
        return ForcePoints(**{field.name: getattr(self, field.name)[chosen] for field in fields(self)})

    def where_if(self, chosen: NDArray[np.bool_]) -> ForcePoints | None:
        """The points with a flag (n,); None without any."""
        return self.where(chosen) if chosen.any() else None

    @property
    def straight(self) -> NDArray[np.bool_]:
        """(n,) True where neither slip angle nor camber acts."""
        return (np.abs(self.slip_angle) <= ZERO) & (np.abs(self.camber) <= ZERO)

    @property
    def free(self) -> NDArray[np.bool_]:
        """(n,) True where the wheel neither drives nor brakes: its slip is zero."""
        return np.abs(self.slip) <= ZERO
