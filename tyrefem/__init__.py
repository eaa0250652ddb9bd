"""Thermo-mechanical finite elements of a rolling tyre."""
