"""The footprint by Fourier harmonics about the inflated tyre.

Knows nothing of heat conduction and results.
"""
