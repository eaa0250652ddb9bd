"""Reduced models: a rolling tyre's temperatures from a few dozen POD modes instead of thousands of nodes.

This package does not import sweeps, diagnoses or reports.
"""
