"""A study and its section carried over to another tyre size of the same kind.

`scaled_tyre` says what was scaled, and what was dropped because it belonged to the first tyre.
"""

from tyrefem.inputs.other_size.scaled_tyre import ScaledTyre, scaled_tyre

__all__ = ["ScaledTyre", "scaled_tyre"]
