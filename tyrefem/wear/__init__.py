"""Wear of a tread by ring from friction power, and the worn section.

It takes a rolling tyre of the mechanics. It does not know runs, variants, questions and reports.
"""
