"""Laws of tan delta: the base of the shipped ones and of a user's."""

from __future__ import annotations

import functools
from abc import abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.materials.loss_tangent import Loss
from tyrefem.materials.properties import Sourced
from tyrefem.plugins import Kind, Range, Trial, registry, trial
from tyrefem.plugins.guard import plugin_error

Array = NDArray[np.float64]
#: Temperatures at which laws are tried, degC, and frequencies, Hz.
TEMPERATURES = tuple(range(-40, 201, 20))
FREQUENCIES = (1.0, 10.0, 100.0, 1000.0)


class TanDeltaLaw(Sourced):
    """Base of a user's law of tan delta, the table ``[loss_tangent]`` of a material card.

    A subclass sets ``law: Literal["name"]``, its numbers as fields with units, and `tan_delta`. The loss per revolution
    is in proportion to tan delta. With ``of_frequency`` every harmonic of the strain cycle has its own frequency.
    """

    plugin_kind: ClassVar[Kind]
    #: The law's table as in a file, with which `tyrefem check` tries it; only what has no default.
    example: ClassVar[Mapping[str, Any]] = {}
    #: True if `tan_delta` depends on the frequency; such a law needs more time, and no real-time model.
    of_frequency: ClassVar[bool] = False
    #: Frequency of the law where a cycle has a single one, Hz.
    reference: ClassVar[float] = 10.0
    if TYPE_CHECKING:
        law: str

    @abstractmethod
    def tan_delta(self, temperature: Array, frequency: float) -> Array:
        """tan delta at temperatures, degC, and a frequency, Hz; same shape as the temperatures."""

    @property
    def depends_on_frequency(self) -> bool:
        """True if tan delta depends on frequency."""
        return self.of_frequency

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """Fields to which ``relative_sd`` applies: ``value``, where the law has it."""
        return (("value",),) if "value" in type(self).model_fields else ()

    @property
    def over_frequency(self) -> Loss:
        """tan delta(f, T), a function of frequency, Hz, and temperatures, degC."""
        return OfFrequencyAndTemperature(self)

    def __call__(self, temperature: Array | float) -> Array:
        """tan delta at temperatures in degC and the reference frequency; same shape."""
        return self.over_frequency(self.reference, np.asarray(temperature, dtype=float))

    def trials(self) -> Iterator[Trial]:
        """tan delta over temperature and frequency, for many temperatures, for one, and for none."""
        many = np.array(TEMPERATURES, dtype=float)
        allowed = Range("1", 0.0, 10.0)
        for frequency in FREQUENCIES if self.depends_on_frequency else (self.reference,):
            at = f"{many[0]:g} to {many[-1]:g} degC, {frequency:g} Hz"
            values = functools.partial(self.over_frequency, frequency, many)
            yield trial(f"tan_delta({at})", values, allowed, many.shape)
        yield trial("tan_delta of a single temperature", lambda: self(25.0), allowed)
        yield trial("tan_delta of no temperature", lambda: self(np.zeros(0)), allowed, (0,))


@dataclass(frozen=True)
class OfFrequencyAndTemperature:
    """tan delta(f, T) of a law."""

    law: TanDeltaLaw

    def __call__(self, frequency: float, temperature: Array) -> Array:
        temperature = np.asarray(temperature, dtype=float)
        values = np.asarray(self.law.tan_delta(temperature, frequency), dtype=float)
        if values.shape == ():
            values = np.full_like(temperature, float(values))
        if values.shape != temperature.shape:
            raise self._error(f"must give shape {temperature.shape}, not {values.shape}")
        wrong = ~np.isfinite(values)
        if wrong.any():
            raise self._error(f"must give finite numbers, not {values[wrong][0]:g} at {temperature[wrong][0]:.6g} degC")
        return values

    def _error(self, words: str) -> InputError:
        cls = type(self.law)
        place, plugin = f"class {cls.__name__}, tan_delta", registry().of_class(cls)
        return InputError(f"{place}: {words}") if plugin is None else plugin_error(plugin.origin, place, words)
