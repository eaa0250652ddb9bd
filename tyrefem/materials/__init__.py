"""Materials: cards, properties over temperature, tan delta, cord layers.

This package does not import drives and runs.
"""
