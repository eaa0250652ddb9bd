"""Moduli of a pressed tyre at the strain amplitudes of its regions: equivalent-linear, by repeated presses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tyrefem.inputs.study import StudyData
from tyrefem.materials.card import strain_laws
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.footprint.strain_amplitude import StrainAmplitude
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics

if TYPE_CHECKING:
    from tyrefem.geometry.meshing.mesh import TyreMesh

#: Largest number of presses, and relative change of a modulus that ends them.
PASSES, CLOSE = 4, 0.02
#: Tolerance of the presses, which serve the amplitudes only.
ROUGH = 0.1
#: Smallest amplitude of a region, against a division by zero.
SMALLEST = 1e-6


@dataclass(frozen=True)
class SecantModuli:
    """Region -> shear strain amplitude, and the modulus there over that of its card; the presses that it took."""

    amplitudes: dict[str, float]
    factors: dict[str, float]
    passes: int


def under_load(
    study: StudyData,
    mesh: TyreMesh,
    pressure: float,
    road: Road,
    *,
    load: float | None = None,
    deflection: float | None = None,
) -> tuple[StudyData, SecantModuli]:
    """The study with the `secant_moduli` of a load, N, or deflection, m, by presses in linear motion; and these.

    Raises
    ------
    InputError : no equilibrium, or a load that the tyre cannot carry.
    """
    from tyrefem.mechanics.footprint.contact import Pressing
    from tyrefem.mechanics.solid.inflation import inflate

    def linear(changed: StudyData) -> Footprint:
        pressing = Pressing(inflate(changed, pressure, mesh).state, road)
        return pressing.solve(load=load, deflection=deflection, tolerance=ROUGH)

    moduli = secant_moduli(study, linear)
    return study.at_amplitudes(moduli.amplitudes), moduli


def secant_moduli(study: StudyData, footprint: Callable[[StudyData], Footprint]) -> SecantModuli:
    """The moduli at which every region's compound stores what its points store at their own amplitudes.

    As in the equivalent-linear method of soil dynamics (Seed & Idriss 1969): press with given moduli, take each
    region's `StrainAmplitude.mean_amplitude`, its card's modulus there, and press again. The modulus falls slowly with
    the amplitude, so two or three presses suffice; the last change is below 2 %. The inflated shape takes the same
    moduli.

    Parameters
    ----------
    study : cards without ``strain_dependence`` keep their moduli.
    footprint : the pressed tyre of a study with other moduli; linear in the motion is enough for amplitudes.
    """
    laws = strain_laws(study.materials)
    factors = dict.fromkeys(laws, 1.0)
    amplitudes = {region: law.modulus_amplitude for region, law in laws.items()}
    passes = 0
    while laws and passes < PASSES:
        passes += 1
        pressed = footprint(study.at_amplitudes(amplitudes))
        strain = StrainAmplitude(StrainHarmonics(pressed), laws)
        amplitudes = {region: max(strain.mean_amplitude(region), SMALLEST) for region in laws}
        before, factors = factors, {region: float(law.stiffening(amplitudes[region])) for region, law in laws.items()}
        if all(abs(factors[region] - before[region]) <= CLOSE * before[region] for region in laws):
            break
    return SecantModuli(amplitudes, factors, passes)
