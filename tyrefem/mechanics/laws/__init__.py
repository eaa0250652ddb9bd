"""The strain laws that a study may name, one module each: `tyrefem.mechanics.strain_laws` finds them.

A law may import the study's data and the mechanics, but not drives, runs and reports.
"""
