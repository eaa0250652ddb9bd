"""Interfaces of the terms of the heat equation: sources, films, fluxes, exchanges, heat capacities."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, Protocol

from numpy.typing import NDArray
from scipy.sparse import csr_matrix

Array = NDArray[Any]

#: Relative change of a frozen coefficient above which it is frozen anew.
STALE = 0.2
#: Half the temperature difference for slopes of user functions, K.
SLOPE_STEP = 1e-4


class State:
    """Unknown temperatures, degC: u (n,) of the body and g (m,) of the reservoirs."""

    __slots__ = ("g", "u")

    def __init__(self, u: Array, g: Array) -> None:
        self.u, self.g = u, g


class Storage(Protocol):
    """The heat capacity of a region."""

    constant: bool

    def mass(self, u: Array) -> Array:
        """Operator values of int C v T dV at the temperatures u."""
        ...


class Added(Protocol):
    """Additional states with a rate: `tyrefem.conduction.added_states.AddedStates`."""

    @property
    def initial(self) -> Array:
        """(k,) initial values."""
        ...

    @property
    def scale(self) -> Array:
        """(k,) changes of the same importance as 1 K."""
        ...

    @property
    def show(self) -> Callable[[Array], None]:
        """The function that receives the states before loads are evaluated."""
        ...


class Boundary(Protocol):
    """The quadrature of a boundary."""

    dofs: Array

    def exchange(self, h: Any) -> tuple[Array, Array]:
        """Positions and operator values of int h v T dA; h: a number or values at the points, W/m2/K."""
        ...

    def load(self, q: Any) -> Array:
        """int q v dA of the boundary's unknowns; q: a number or values at the points."""
        ...


class LinearPart(Protocol):
    """S, B and D under construction."""

    def add_conduction(self, values: Array) -> None:
        """Add int k grad v . grad T dV of a region."""
        ...

    def add_film(self, boundary: Boundary, h: Any, reservoir: int | None = None) -> Array:
        """Add int h (T - T_g) v dA; return the row int h v dA, W/K."""
        ...

    def add_conductance(self, G: float, i: int, j: int | None = None) -> None:
        """Add G (T_i - T_j) of reservoir i."""
        ...


class Load(ABC):
    """One term of the equation. `slot` is its line in the ledger of powers into the body (W)."""

    slot: Any = -1
    #: The user's condition or source; loads of the same cause are equal.
    cause: Any = None
    timed = False
    static = False

    def freeze(self, t: float, y: State, linear: LinearPart) -> None:  # noqa: B027 - most have no linear part
        """Add the frozen linear part."""

    def stale(self, t: float, y: State) -> bool:
        """True if the frozen part differs by more than a fifth from its present value."""
        return False

    @abstractmethod
    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> Any:
        """Add the remainder beside the linear part to G (body) and Gg (reservoirs); return the power, W."""

    def linear_power(self, y: State) -> float:
        """Power of the frozen linear part, W into the body."""
        return 0.0

    def clear_cache(self) -> None:  # noqa: B027 - most cache nothing
        """Clear data cached for a time, as the added states have changed."""

    def jacobian(self, t: float, y: State) -> csr_matrix | None:
        """d(remainder)/du (n, n) at the state of the freeze, where it is not zero."""
        return None
