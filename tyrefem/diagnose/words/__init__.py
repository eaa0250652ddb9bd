"""A diagnosis in words, tables and records."""
