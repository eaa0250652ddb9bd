"""Bayesian inference in linear models: evidence, posterior, errors that readings share."""
