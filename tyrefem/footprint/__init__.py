"""The footprint: its length by law, and its mechanics by Fourier harmonics about the inflated tyre.

`length` holds the laws of a study's ``[mechanics] footprint``. The mechanics are imported from their own modules, as
they load scikit-fem: `harmonics`, `contact`, `cycle`, `loss`.
"""

from tyrefem.footprint.length import TR_R_64, FootprintLaw, GivenFootprint, HedekelFootprint, TrR64Footprint

__all__ = ["TR_R_64", "FootprintLaw", "GivenFootprint", "HedekelFootprint", "TrR64Footprint"]
