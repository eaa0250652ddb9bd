"""Real-time models: certified, exported, stepped with numpy alone, packed as FMU.

Knows nothing of sweeps, diagnoses and reports.
"""
