"""How much of the friction heat still goes into a slider that has slid some way."""

from __future__ import annotations

import math

from tyrefem.errors import InputError
from tyrefem.sliding.solid import Solid, positive


def share_into_slider(length: float, slid: float, slider: Solid, track: Solid) -> float:
    """F_r/F_0 = (2 K_r/(pi K_w)) sqrt(k_w t_c/(k_r T))   (9), with t_c/T = l/L at constant speed.

    The slider's surface stands at equation 1's rise since the start: the worst case, the real share is less. For rubber
    on teak the factor before sqrt(l/L) is 0.96 (10). Valid for l much less than L.

    Parameters
    ----------
    length : l of the slider, m. slid : L, the whole way slid, m, at least the length.

    Returns a number. Raises InputError for lengths that are not positive or a way shorter than the slider.
    Source: Roberts, *Temperature rise when rubber slides*.

    >>> from tyrefem.sliding import RUBBER, TEAK
    >>> round(share_into_slider(0.04, 1.0, RUBBER, TEAK), 3)
    0.193
    """
    _slid_far_enough(length, slid)
    ratio = slider.conductivity / track.conductivity * math.sqrt(track.diffusivity / slider.diffusivity)
    return 2.0 / math.pi * ratio * math.sqrt(length / slid)


def share_of_like_solids(length: float, slid: float) -> float:
    """F_r/F_0 = sqrt(l/L)   (11): equation 10 with its 0.96 taken as 1, for rubber on wood only.

    Parameters and errors as `share_into_slider`.

    >>> share_of_like_solids(0.04, 1.0)
    0.2
    """
    _slid_far_enough(length, slid)
    return math.sqrt(length / slid)


def _slid_far_enough(length: float, slid: float) -> None:
    positive(length=length, slid=slid)
    if slid < length:
        raise InputError(f"must be at least the slider's length, {length:g} m, not {slid:g} m", field="slid")
