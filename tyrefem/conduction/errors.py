"""What a conduction solve reports when it fails."""

from __future__ import annotations


class SolverError(RuntimeError):
    """The equations could not be solved: no convergence, or a vanishing time step."""
