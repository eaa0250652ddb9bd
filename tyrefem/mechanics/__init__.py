"""The strain cycle of a rolling tyre: by arcs, by finite elements, given; inflation and footprint.

Knows nothing of heat conduction and results.
"""
