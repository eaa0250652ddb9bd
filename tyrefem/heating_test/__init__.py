"""The heating test of the laser rig (Allouis et al. 2016) as data: card, patch of tread, readings, fit, selection.

Knows nothing of tyres, drives and studies, and nothing of `tyrefem.rig`, where people find it.
"""
