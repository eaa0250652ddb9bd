"""The strain cycle of a rolling tyre: by arcs, by finite elements, or given; inflation and footprint.

This package does not import heat conduction or results.
"""
