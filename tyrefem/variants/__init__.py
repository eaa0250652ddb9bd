"""Variants of a study: what varies, where variants run, where their answers are stored.

This package does not import sweeps, reduced models, comparisons or diagnoses.
"""
