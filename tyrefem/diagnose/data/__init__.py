"""Measured runs as residuals with their noise and sensitivities."""
