"""``[strain_dependence]`` of a material card: storage and loss modulus over the strain amplitude (Payne effect)."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from tyrefem.errors import InputError
from tyrefem.materials.properties import Sourced
from tyrefem.quantity import Unit

Array = NDArray[np.float64]
Modulus = Annotated[float, Unit("Pa", gt=0, le=1e12)]
Amplitude = Annotated[float, Unit("1", gt=0, le=1)]


@dataclass(frozen=True)
class Kraus:
    """Moduli of filled rubber at a shear strain amplitude g (Kraus, J. Appl. Polym. Sci. Appl. Polym. Symp. 39, 1984):

    G'(g) = G_inf + (G_0 - G_inf) / (1 + x^2),  G''(g) = L_inf + 2 (L_max - L_inf) x / (1 + x^2),  x = (g / g_c)^m.

    G' falls from G_0 to G_inf. G'' is greatest, L_max, at g_c, and L_inf at very small and very large strain.

    Parameters
    ----------
    small, large : G_0 and G_inf, Pa. greatest_loss, large_loss : L_max and L_inf, Pa.
    critical : g_c. exponent : m, about 0.6 for carbon black.

    >>> law = Kraus(3e6, 1e6, 4e5, 1e5, 0.02)
    >>> float(law.storage(0.02)), float(law.loss(0.02)), round(float(law.amplitude(2e6)), 12)
    (2000000.0, 400000.0, 0.02)
    """

    small: float
    large: float
    greatest_loss: float
    large_loss: float
    critical: float
    exponent: float = 0.6

    def _ratio(self, amplitude: Array | float) -> Array:
        return np.asarray((np.asarray(amplitude, dtype=float) / self.critical) ** self.exponent)

    def storage(self, amplitude: Array | float) -> Array:
        """G', Pa, at shear strain amplitudes; same shape."""
        return np.asarray(self.large + (self.small - self.large) / (1 + self._ratio(amplitude) ** 2))

    def loss(self, amplitude: Array | float) -> Array:
        """G'', Pa, at shear strain amplitudes; same shape."""
        x = self._ratio(amplitude)
        return np.asarray(self.large_loss + 2 * (self.greatest_loss - self.large_loss) * x / (1 + x**2))

    def amplitude(self, storage: float) -> float:
        """The shear strain amplitude of a storage modulus, Pa; 0 above G_0, infinite below G_inf."""
        if storage >= self.small:
            return 0.0
        if storage <= self.large:
            return float("inf")
        squared = (self.small - self.large) / (storage - self.large) - 1
        return float(self.critical * squared ** (0.5 / self.exponent))


class StrainDependence(Sourced):
    """Moduli over strain amplitude by `Kraus`, e.g. from a strain sweep of a like compound: only ratios count.

    The card's moduli hold at ``modulus_amplitude``, its tan delta at ``loss_amplitude``. Amplitudes are those of an
    equivalent shear strain, sqrt(2 e':e') with e' the deviator: simple shear by g has g, uniaxial strain by e has
    sqrt(3) e. Laws of temperature and frequency multiply both moduli alike at every amplitude.

    Raises
    ------
    InputError : the small-strain modulus is below that at large strain, the greatest loss modulus below that at large
        strain, or a number out of range.

    >>> rubber = StrainDependence.check({"small_strain_modulus": "3 MPa", "large_strain_modulus": "1 MPa",
    ...     "greatest_loss_modulus": "0.4 MPa", "large_strain_loss_modulus": "0.1 MPa", "critical_strain": "2 %",
    ...     "modulus_amplitude": "2 %", "source": "estimate: example"})
    >>> rubber.stiffening(0.02), rubber.stiffening(1e-9).round(3)
    (array(1.), np.float64(1.5))
    """

    law: Literal["kraus"] = "kraus"
    small_strain_modulus: Modulus
    large_strain_modulus: Modulus
    greatest_loss_modulus: Modulus
    large_strain_loss_modulus: Annotated[float, Unit("Pa", ge=0, le=1e12)] = 0.0
    critical_strain: Amplitude
    exponent: Annotated[float, Unit("1", gt=0, le=2)] = 0.6
    modulus_amplitude: Amplitude = 0.1
    loss_amplitude: Amplitude = 0.1

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.small_strain_modulus <= self.large_strain_modulus:
            raise InputError(
                f"must be more than the modulus at large strain ({self.large_strain_modulus:.4g} Pa), not "
                f"{self.small_strain_modulus:.4g} Pa: the storage modulus of filled rubber falls with strain",
                field="small_strain_modulus",
            )
        if self.greatest_loss_modulus < self.large_strain_loss_modulus:
            raise InputError(
                f"must be at least the loss modulus at large strain ({self.large_strain_loss_modulus:.4g} Pa), not "
                f"{self.greatest_loss_modulus:.4g} Pa",
                field="greatest_loss_modulus",
            )
        return self

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """The fall of the storage modulus and the place of the greatest loss; a factor on all moduli has no effect."""
        return ("small_strain_modulus",), ("critical_strain",)

    @functools.cached_property
    def kraus(self) -> Kraus:
        """The law of the numbers."""
        return Kraus(
            self.small_strain_modulus, self.large_strain_modulus, self.greatest_loss_modulus,
            self.large_strain_loss_modulus, self.critical_strain, self.exponent,
        )  # fmt: skip

    def at_modulus_amplitude(self, amplitude: float) -> Self:
        """The same compound for a card whose modulus holds at another amplitude."""
        return self.model_copy(update={"modulus_amplitude": amplitude})

    def stiffening(self, amplitude: Array | float) -> Array:
        """Storage modulus at amplitudes over the card's modulus; same shape."""
        return np.asarray(self.kraus.storage(amplitude) / self.kraus.storage(self.modulus_amplitude))

    def lossiness(self, amplitude: Array | float) -> Array:
        """Loss modulus at amplitudes over the card's tan delta times the card's modulus; same shape.

        G''(g) / (G'(a) tan d(b)), a the amplitude of the card's modulus, b that of its tan delta.
        """
        law, b = self.kraus, self.loss_amplitude
        return np.asarray(law.loss(amplitude) / law.storage(self.modulus_amplitude) * (law.storage(b) / law.loss(b)))
