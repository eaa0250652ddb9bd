"""The footprint by Fourier harmonics about the inflated tyre.

This package does not import heat conduction or results.
"""
