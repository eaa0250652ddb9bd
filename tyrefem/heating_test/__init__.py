"""The heating test of the laser rig (Allouis et al. 2016): card, heated patch, readings, fit, model selection.

This package does not import tyres, drives or studies. Its public interface is `tyrefem.rig`.
"""
