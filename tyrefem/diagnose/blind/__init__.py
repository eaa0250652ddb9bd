"""Blind tests: effects hidden in synthetic data, and how often they are named."""
