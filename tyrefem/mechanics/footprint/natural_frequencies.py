"""Natural frequencies of a study's inflated tyre, unloaded and not rolling, with its rim held."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from numbers import Integral
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.estimates import work as estimate
from tyrefem.geometry.meshing.expected import QUADRATIC
from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.materials.card import strain_laws
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.footprint.pressed_tyre import mechanical_mesh
from tyrefem.mechanics.footprint.vibration import Mode, Vibration
from tyrefem.mechanics.solid.stiffened import stiffened
from tyrefem.requirements import Requirements
from tyrefem.threads import one_thread

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.solid.body import Prestressed
    from tyrefem.mechanics.solid.inflation import Inflation

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

#: Requirements of natural frequencies on the study.
NEEDS = Requirements("a computation of natural frequencies")
#: Harmonics by default: 0 to 5. Number of modes of each.
HARMONICS = (0, 1, 2, 3, 4, 5)
COUNT = 2
#: Most modes of a harmonic, and highest harmonic: element sizes resolve no more.
MOST = 40
HIGHEST = 60
#: A mode is named after a rigid motion of the belt if this share of the belt's kinetic energy is that motion's.
RIGID_SHARE = 0.5
#: The belt is at rest if its kinetic energy per mass is below this share of the tyre's.
AT_REST = 0.5
#: Shear strain amplitude of a vibration: small against the critical strain of filled rubber, about 2 %.
AMPLITUDE = 1e-3
#: Regions of the belt hold one of these words; without any the crown's tread and carcass are meant.
BELT = ("belt", "cap-ply")


@dataclass(frozen=True)
class NaturalMode:
    """A mode with its name and shares. Made by `natural_frequencies`.

    Parameters
    ----------
    mode : frequency and shape.
    name : motion of the belt, e.g. "lateral".
    shares : share of radial, lateral and circumferential motion in the belt's kinetic energy; ``belt``: the belt's
        kinetic energy over the tyre's, relative to its share of the mass.
    """

    mode: Mode
    name: str
    shares: Mapping[str, float]

    @property
    def label(self) -> str:
        """For a picture."""
        return f"n = {self.mode.harmonic}: {self.name}\n{self.mode.frequency:.1f} Hz"

    def row(self) -> dict[str, Any]:
        """A row of the table."""
        return {"harmonic": self.mode.harmonic, "frequency_Hz": self.mode.frequency, "name": self.name, **self.shares}


@dataclass(frozen=True, eq=False)
class NaturalFrequencies(Brief):
    """Natural frequencies of an inflated tyre. Made by `natural_frequencies`.

    Parameters
    ----------
    study : the study. tyre : the inflated tyre. vibration : stiffness and mass.
    modes : by harmonic, then frequency.
    stiffening : region -> dynamic modulus of its compound over that of its card, where cards depend on strain;
        ``amplitude``: the shear strain amplitude.
    """

    study: StudyData
    tyre: Inflation
    vibration: Vibration
    modes: tuple[NaturalMode, ...]
    stiffening: Mapping[str, float] = field(default_factory=dict)
    amplitude: float = AMPLITUDE

    def _title(self) -> str:
        return f"of {self.study.name}"

    def _facts(self) -> Mapping[str, Any]:
        return {f"{m.mode.harmonic} {m.name}": f"{m.mode.frequency:.2f} Hz" for m in self.modes}

    @property
    def mass(self) -> float:
        """Mass of the whole tyre, kg."""
        vibration = self.vibration
        return moving_mass(vibration) * (2 if self.tyre.half else 1)

    @property
    def table(self) -> Any:
        """pandas DataFrame: harmonic, frequency_Hz, name, radial, lateral, circumferential, belt."""
        import pandas as pd

        return pd.DataFrame([mode.row() for mode in self.modes])

    def frequency(self, name: str) -> float:
        """Lowest frequency, Hz, of a name.

        Raises
        ------
        InputError : no mode has this name.
        """
        frequencies = [mode.mode.frequency for mode in self.modes if mode.name == name]
        if not frequencies:
            names = ", ".join(dict.fromkeys(mode.name for mode in self.modes))
            raise InputError(f"no mode is called '{name}'; there are {names}", field="name")
        return min(frequencies)

    def summary(self) -> dict[str, Any]:
        """All results in SI as the keys state, with mesh and versions."""
        from tyrefem.output import versions

        return {
            "study": self.study.name,
            "title": self.study.title,
            "pressure_Pa": self.tyre.pressure,
            "mass_kg": self.mass,
            "modes": [mode.row() for mode in self.modes],
            "strain_amplitude": self.amplitude,
            "modulus_over_that_of_the_card": dict(self.stiffening),
            "nodes_of_nine_node_elements": self.tyre.body.rings.n_nodes,
            "versions": versions(),
            **plugin_summary(self.study),
        }


def moving_mass(vibration: Vibration) -> float:
    """Mass of the body of `Vibration`, kg: int rho r dA times 2 pi."""
    return float(2 * np.pi * (vibration.density * vibration.harmonics.elements.weights).sum())


@one_thread()
def natural_frequencies(
    study: StudyData,
    harmonics: Iterable[int] = HARMONICS,
    count: int = COUNT,
    *,
    pressure: float | None = None,
    amplitude: float = AMPLITUDE,
) -> NaturalFrequencies:
    """Natural frequencies of a study's tyre: inflated, unloaded, not rolling, the rim's seat held, air without mass.

    (K_n - w^2 M) x = 0, f = w/(2 pi). K_n is the stiffness of harmonic n about the inflated state (`Harmonics`), with
    the moduli of the cards; where a card has ``strain_dependence``, with the storage modulus at ``amplitude`` about the
    inflation by the card's modulus (`stiffened`). M is the consistent mass of the cards' densities
    (`vibration.mass_matrix`). The equation is that of a body of revolution in Fourier series (Zienkiewicz & Taylor,
    The Finite Element Method); the names of the first modes are those of the rigid ring on a sidewall (Zegelaar 1998).

    Names: n = 0 "lateral", "wind-up"; n = 1 "fore-aft and vertical", "yaw and camber", if half of the belt's energy is
    this rigid motion; otherwise the belt's greatest component, e.g. "radial bending". "belt torsion" is a radial motion
    of its two edges against each other. In "sidewall" the belt is at rest.

    Parameters
    ----------
    study : the study. harmonics : waves round the wheel, 0 to 60. count : modes of each, 1 to 40.
    pressure : Pa above the ambient, positive; by default at the start of the drive's first phase.
    amplitude : shear strain amplitude of the vibration, more than 0 to 1.

    Raises
    ------
    InputError : a campaign; a number out of range; no equilibrium; an inflated tyre that is not stable.

    >>> from tyrefem import study
    >>> tyre = study("nasa-22x5.5-8pr", {"mesh.size": "12 mm"})
    >>> modes = natural_frequencies(tyre, [0], 2)
    >>> modes.table.name.tolist(), bool((modes.table.frequency_Hz > 30).all())
    (['lateral', 'wind-up'], True)
    """
    from tyrefem.mechanics.solid.inflation import inflate

    NEEDS.check(study)
    orders = tuple(harmonics) if isinstance(harmonics, Iterable) else ()
    if not orders or not all(isinstance(n, Integral) and 0 <= n <= HIGHEST for n in orders):
        raise InputError(f"must be whole numbers from 0 to {HIGHEST}, not {harmonics!r:.60}", field="harmonics")
    if isinstance(count, bool) or not (isinstance(count, Integral) and 1 <= count <= MOST):
        raise InputError(f"must be a whole number from 1 to {MOST}, not {count!r:.60}", field="count")
    pressure = study.card.drive.phases[0].pressure.start if pressure is None else pressure
    if not pressure > 0:
        raise InputError(f"must be more than 0 Pa, not {pressure:g} Pa", field="pressure")
    if not 0 < amplitude <= 1:
        raise InputError(f"must be more than 0 to 100 %, not {100 * amplitude:g} %", field="amplitude")
    mesh = mechanical_mesh(study, large=False)
    nodes = QUADRATIC * mesh.n_nodes
    estimate.warn_if_long(estimate.mechanics(nodes, large=False).time, f"the frequencies of {nodes:,} nodes")
    tyre = inflate(study, pressure, mesh)
    stiffening = {region: float(law.stiffening(amplitude)) for region, law in strain_laws(study.materials).items()}
    vibration = Vibration(Harmonics(dynamic_state(tyre, stiffening)), densities(study, tyre))
    belt = belt_elements(tyre)
    modes = []
    for n in sorted(set(orders)):
        for mode in vibration.modes(n, count):
            shares = vibration.shares(mode, belt)
            modes.append(NaturalMode(mode, motion_name(vibration, mode, belt, shares), shares))
    return NaturalFrequencies(study, tyre, vibration, tuple(modes), stiffening, amplitude)


def dynamic_state(tyre: Inflation, stiffening: Mapping[str, float]) -> Prestressed:
    """The inflated state with compounds of regions stiffer by factors; the same state without factors."""
    if not stiffening:
        return tyre.state
    factors = np.ones(tyre.body.rings.weights.shape)
    for region, factor in stiffening.items():
        factors[tyre.body.mesh.subdomains[region]] = factor
    return stiffened(tyre.state, factors)


def densities(study: StudyData, tyre: Inflation) -> Array:
    """(n_elements, n_points) kg/m3 of the inflated volume: the cards' at the drive's initial temperature over det F."""
    from tyrefem.mechanics.solid.compounds import determinant
    from tyrefem.mechanics.solid.tyre_body import reference_density

    return np.asarray(reference_density(study, tyre.body) / determinant(tyre.deformation))


def belt_elements(tyre: Inflation) -> Indices:
    """Elements of the belt's regions; of a tyre without belt, those under the tread's outer face."""
    regions = tyre.body.mesh.subdomains
    belts = [regions[name] for name in tyre.body.parts if any(word in name for word in BELT)]
    if belts:
        return np.unique(np.concatenate(belts)).astype(np.int64)
    rings = tyre.body.rings
    widest = float(np.abs(rings.nodes[1][rings.boundary_nodes("road")]).max())
    middles = rings.points.mean(axis=-1)
    crown = (np.abs(middles[1]) <= widest) & (middles[0] > np.median(rings.nodes[0]))
    return np.flatnonzero(crown).astype(np.int64)


def motion_name(vibration: Vibration, mode: Mode, belt: Indices, shares: Mapping[str, float]) -> str:
    """Name of a motion of the elements ``belt``, by its rigidity and its shares of energy."""
    rigidity = vibration.rigidity(mode, belt)
    best = max(rigidity, key=rigidity.__getitem__, default="")
    if shares["belt"] < AT_REST:
        return "sidewall"
    if best and rigidity[best] > RIGID_SHARE:
        return best
    greatest = max(("radial", "lateral", "circumferential"), key=shares.__getitem__)
    if greatest == "radial" and vibration.opposed(mode, belt):
        return "belt torsion"
    return "breathing" if mode.harmonic == 0 and greatest == "radial" else f"{greatest} bending"
