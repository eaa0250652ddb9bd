"""A user's input: the study as data, its drive, its cases, and changes by dotted names.

This package does not import runs, results or reports.
"""
