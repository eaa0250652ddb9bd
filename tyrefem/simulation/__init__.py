"""The rolling tyre: one drive in, one result out.

Knows nothing of measurements, sweeps and reports.
"""
