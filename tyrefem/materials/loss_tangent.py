"""tan delta of a compound over frequency and temperature."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError

Array = NDArray[np.float64]
#: Largest x of a Prony series: its square is still a number.
LARGEST = 1e150


class Loss(Protocol):
    """tan delta at a frequency, Hz, and temperatures, degC."""

    def __call__(self, frequency: float, temperature: Array) -> Array:
        """Same shape as the temperatures."""


@dataclass(frozen=True)
class Shift:
    """Williams, Landel and Ferry: log10 a_T = -c1 (T - T_ref) / (c2 + T - T_ref); constant for c2 + T - T_ref < 10 K.

    >>> float(Shift(17.44, 51.6, -50.0)(np.array(-50.0)))
    1.0
    """

    c1: float
    c2: float
    reference: float

    def __call__(self, temperature: Array) -> Array:
        above = np.maximum(np.asarray(temperature, dtype=float) - self.reference, 10.0 - self.c2)
        return np.asarray(10 ** np.minimum(-self.c1 * above / (self.c2 + above), 300.0))


@dataclass(frozen=True)
class OfTemperature:
    """A law of temperature only, e.g. the ``loss_tangent`` of a material card, or a number."""

    law: Callable[[Array], Array] | float

    def __call__(self, frequency: float, temperature: Array) -> Array:
        temperature = np.asarray(temperature, dtype=float)
        if callable(self.law):
            return np.asarray(self.law(temperature))
        return np.full_like(temperature, self.law)


@dataclass(frozen=True)
class PowerLaw:
    """tan d = law(T) (f / f_ref)^exponent.

    >>> float(PowerLaw(0.1, 0.5, 10.0)(40.0, np.array(25.0)))
    0.2
    """

    law: Callable[[Array], Array] | float
    exponent: float
    reference: float = 10.0

    def __call__(self, frequency: float, temperature: Array) -> Array:
        return OfTemperature(self.law)(frequency, temperature) * (frequency / self.reference) ** self.exponent


@dataclass(frozen=True)
class Relative:
    """tan d = law(T) m(f, T) / m(f_ref, T): ``law`` gives the value at f_ref, ``master`` its ratio at other
    frequencies.

    >>> maxwell = Prony(1.0, (2.0,), (1.0,))
    >>> round(float(Relative(0.1, maxwell, 0.5 / np.pi)(0.5 / np.pi, np.array(20.0))), 9)
    0.1
    """

    law: Callable[[Array], Array] | float
    master: Loss
    reference: float = 10.0

    def __call__(self, frequency: float, temperature: Array) -> Array:
        ratio = self.master(frequency, temperature) / self.master(self.reference, temperature)
        return np.asarray(OfTemperature(self.law)(frequency, temperature) * ratio)


@dataclass(frozen=True)
class FrequencyTable:
    """tan d tabulated over f (Hz), linear in log f, constant beyond the ends; ``shift`` multiplies f by a_T."""

    frequencies: tuple[float, ...]
    values: tuple[float, ...]
    shift: Shift | None = None

    def __post_init__(self) -> None:
        f = np.asarray(self.frequencies, dtype=float)
        if len(f) != len(self.values) or len(f) < 2 or (f <= 0).any() or (np.diff(f) <= 0).any():
            raise InputError("a table of tan delta needs two or more rising positive frequencies, one value each")

    def __call__(self, frequency: float, temperature: Array) -> Array:
        temperature = np.asarray(temperature, dtype=float)
        reduced = frequency * (self.shift(temperature) if self.shift else np.ones_like(temperature))
        return np.asarray(np.interp(np.log(reduced), np.log(self.frequencies), self.values))


@dataclass(frozen=True)
class Prony:
    """A generalised Maxwell solid: E' = E_0 + sum E_i x_i^2/(1 + x_i^2), E'' = sum E_i x_i/(1 + x_i^2),
    x_i = 2 pi f a_T tau_i.

    Parameters
    ----------
    equilibrium : E_0, Pa (or a share; only ratios matter).
    moduli, times : E_i, as the equilibrium, and tau_i, s, at the shift's reference temperature.

    >>> float(Prony(1.0, (2.0,), (1.0,))(0.5 / np.pi, np.array(20.0)))
    0.5
    """

    equilibrium: float
    moduli: tuple[float, ...]
    times: tuple[float, ...]
    shift: Shift | None = None

    def __post_init__(self) -> None:
        if len(self.moduli) != len(self.times) or min((*self.moduli, *self.times, self.equilibrium), default=0) <= 0:
            raise InputError("a Prony series needs positive moduli and relaxation times, one each")

    def __call__(self, frequency: float, temperature: Array) -> Array:
        temperature = np.asarray(temperature, dtype=float)
        reduced = 2 * np.pi * frequency * (self.shift(temperature) if self.shift else np.ones_like(temperature))
        x = np.minimum(np.multiply.outer(reduced, np.asarray(self.times)), LARGEST)
        storage = self.equilibrium + (np.asarray(self.moduli) * x**2 / (1 + x**2)).sum(axis=-1)
        return np.asarray((np.asarray(self.moduli) * x / (1 + x**2)).sum(axis=-1) / storage)
