"""Steady rolling of a tyre, in Fourier harmonics round the wheel."""
