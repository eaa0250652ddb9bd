"""The strain laws that a study may name, one module each: `tyrefem.mechanics.strain_laws` finds them.

A law knows the study's data and the mechanics; it knows nothing of drives, runs and reports.
"""
