"""What a person gives: the study as data, its drive, its cases, and changes by dotted names.

Knows nothing of runs, results and reports.
"""
