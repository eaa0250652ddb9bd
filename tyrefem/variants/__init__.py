"""What varies: variants of a study, where they run, where their answers are kept.

Knows nothing of the questions that are asked of them.
"""
