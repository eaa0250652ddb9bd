"""The error of a conduction solve that fails."""

from __future__ import annotations


class SolverError(RuntimeError):
    """The equations could not be solved: no convergence, or a vanishing time step."""
