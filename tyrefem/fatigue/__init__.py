"""How long a tyre lasts: growth of small cracks by the strain cycle of every point, at the temperatures of a run.

It takes a finished run or computes one. It does not know variants, questions and reports.
"""
