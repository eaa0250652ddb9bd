"""Simulation of a rolling tyre over one drive.

This package does not import measurements, sweeps or reports.
"""
