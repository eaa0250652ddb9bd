"""Arrays that an object or a cache shares with those who use it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def read_only(values: Any) -> NDArray[Any]:
    """A view of an array in which no number can be set; the array itself stays as it is.

    >>> shared = read_only(np.array([60.0, 120.0]))
    >>> shared /= 60
    Traceback (most recent call last):
    ...
    ValueError: output array is read-only
    >>> shared / 60
    array([1., 2.])
    """
    view = np.asarray(values).view()
    view.flags.writeable = False
    return view
