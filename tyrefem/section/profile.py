"""A quantity tabulated along the meridian, such as a layer's thickness."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.brief import Stated
from tyrefem.errors import InputError

Array = NDArray[np.float64]
#: No layer of any tyre is thinner or thicker [m]; beyond that elements degenerate.
THINNEST, THICKEST = 1e-5, 1.0


@dataclass(frozen=True)
class Profile(Stated):
    """Values at stations ``s`` along the meridian [m], even in ``s``.

    Parameters
    ----------
    s : stations, rising, none twice [m]; the profile is held constant outside them.
    values : one value per station [m].
    interpolation : ``"linear"``, or ``"pchip"`` (smooth, and monotone between stations).

    Raises
    ------
    InputError : tables of different length, stations out of order, a value that is not positive.

    >>> thickness = Profile((0.0, 0.1), (0.02, 0.01))
    >>> thickness([0.05, -0.05, 0.2]).tolist()
    [0.015, 0.015, 0.01]
    >>> thickness.slope([0.05, -0.05]).round(12).tolist()
    [-0.1, 0.1]
    """

    s: tuple[float, ...]
    values: tuple[float, ...]
    interpolation: str = "linear"

    def __post_init__(self) -> None:
        s, values = np.asarray(self.s, dtype=float), np.asarray(self.values, dtype=float)
        if len(s) == 0 or len(s) != len(values):
            raise InputError(f"has {len(values)} values for {len(s)} stations s; one each is wanted")
        if not (np.isfinite(s).all() and np.isfinite(values).all()):
            raise InputError("holds a number that is not finite")
        if (np.diff(s) <= 0).any():
            first = int(np.argmax(np.diff(s) <= 0))
            raise InputError(f"stations s must rise, but {s[first + 1]:g} m follows {s[first]:g} m")
        if (values <= 0).any():
            raise InputError(f"must be positive everywhere, but is {values.min():g} m")
        if values.min() < THINNEST or values.max() > THICKEST:
            raise InputError(
                f"must be from {THINNEST:g} to {THICKEST:g} m, but goes from {values.min():g} to {values.max():g} m"
            )
        if self.interpolation == "pchip" and len(s) < 2:
            raise InputError("pchip interpolation needs two stations or more")

    @cached_property
    def _pchip(self) -> tuple[Any, Any]:
        from scipy.interpolate import PchipInterpolator

        curve = PchipInterpolator(self.s, self.values)
        return curve, curve.derivative()

    def __call__(self, s: ArrayLike) -> Array:
        """The value at ``s`` (any shape) [m]."""
        x = np.abs(np.asarray(s, dtype=float))
        if self.interpolation == "pchip":
            return np.asarray(self._pchip[0](np.clip(x, self.s[0], self.s[-1])))
        return np.asarray(np.interp(x, self.s, self.values))

    def slope(self, s: ArrayLike) -> Array:
        """d value/ds at ``s`` (any shape); at a kink, the slope towards larger ``|s|``."""
        s = np.asarray(s, dtype=float)
        stations, x = np.asarray(self.s), np.abs(s)
        inside = (x >= stations[0]) & (x < stations[-1])
        if self.interpolation == "pchip":
            slope = self._pchip[1](np.clip(x, stations[0], stations[-1]))
        elif len(stations) == 1:
            slope = np.zeros_like(x)
        else:
            pieces = np.diff(self.values) / np.diff(stations)
            slope = pieces[np.clip(np.searchsorted(stations, x, side="right") - 1, 0, len(pieces) - 1)]
        return np.asarray(np.where(inside, slope, 0.0) * np.where(s < 0, -1.0, 1.0))
