"""Design studies: many variants of one study, answers in a table, and what they say to a designer.

Knows nothing of diagnoses, pages and pictures.
"""
