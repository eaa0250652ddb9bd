"""Real-time models: training and certificate, export to a file, time steps with numpy alone, export as FMU.

This package does not import sweeps, diagnoses or reports.
"""
