"""Reduced models: a rolling tyre's temperatures from a few dozen numbers instead of thousands.

Knows nothing of sweeps, diagnoses and reports.
"""
