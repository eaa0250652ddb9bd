"""An inflated body with other moduli of its compounds for small further motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.body import Prestressed

Array = NDArray[np.float64]


def stiffened(state: Prestressed, factors: Array) -> Prestressed:
    """The state with the compounds' tangent and the bulk stiffness times factors; stresses and cords do not change.

    c = c_cords + f c_compound: the body is in equilibrium as before, small motions about it meet the dynamic modulus of
    their strain amplitude. The state keeps no law of large motions.

    Parameters
    ----------
    factors : (n_elements, n_points) dynamic modulus over the modulus of the state.
    """
    rubber = state.storage if state.rubber is None else state.rubber
    more = (factors - 1) * rubber
    return replace(
        state,
        tangent=state.tangent + more,
        storage=state.storage + more,
        rubber=rubber + more,
        bulk=factors * state.bulk,
        law=None,
    )
