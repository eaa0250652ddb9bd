"""Materials: cards, properties over temperature, tan delta, cord layers.

Knows nothing of drives and runs.
"""
