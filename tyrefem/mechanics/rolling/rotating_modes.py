"""Free waves of the rotating tyre: forward and backward, in the frame of the rubber and of the axle."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.inputs.motion import Motion
from tyrefem.mechanics.footprint.harmonics import SYMMETRIC, Harmonics
from tyrefem.mechanics.footprint.natural_frequencies import (
    NaturalFrequencies,
    NaturalMode,
    belt_elements,
    densities,
    dynamic_state,
    motion_name,
    natural_frequencies,
)
from tyrefem.mechanics.footprint.pressed_tyre import mechanical_mesh
from tyrefem.mechanics.footprint.vibration import Mode, Vibration
from tyrefem.threads import one_thread

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData

Array = NDArray[np.float64]
#: Relative error of the frequencies.
ACCURACY = 1e-10


@dataclass(frozen=True, eq=False)
class RotatingWaves(Brief):
    """Free waves u = Re((U_r, U_z, -i U_t) e^(i (n t + w time))) in the frame that turns with W, t an angle of it:

    (K_n - W^2 M_c - 2 W w C - w^2 M) U = 0

    M : mass; M_c : its radial and circumferential part (centrifugal); C : the mass between u_r and u_t, in both places
    (Coriolis). W > 0 turns towards larger t. w > 0 runs backward through the rubber, w < 0 forward. Seen from the axle
    the frequency is w - n W: a backward wave with w = n W stands still, which is the critical speed.

    Parameters
    ----------
    vibration : stiffness K_n about the spinning shape without inertia, and mass. angular_speed : W, rad/s.
    """

    vibration: Vibration
    angular_speed: float

    def frequencies(self, harmonic: int, count: int) -> list[tuple[float, Array, bool | None]]:
        """(w, U, symmetric) of the ``count`` lowest waves of each direction and family; w in rad/s, U M U = 1.

        Raises
        ------
        InputError : K_n - W^2 M_c is not positive.
        """
        waves = []
        for symmetric, free in self.vibration.families.items():
            waves += [(w, u, symmetric) for w, u in self._family(harmonic, count, free)]
        return sorted(waves, key=lambda wave: abs(wave[0]))

    def _family(self, n: int, count: int, free: NDArray[np.int64]) -> list[tuple[float, Array]]:
        from scipy.sparse.linalg import LinearOperator, eigsh, splu

        vibration, speed = self.vibration, self.angular_speed
        scalar = sp.csc_matrix(vibration.mass)[::3, ::3]

        def part(pattern: list[list[float]]) -> Any:
            return sp.kron(scalar, np.array(pattern), format="csc")[free][:, free].tocsc()

        mass = vibration.mass[free][:, free].tocsc()
        stiffness = vibration.harmonics.stiffness(n)[free][:, free]
        stiffness = (stiffness - speed**2 * part([[1, 0, 0], [0, 0, 0], [0, 0, 1]])).tocsc()
        coriolis = part([[0, 0, 1], [0, 0, 0], [1, 0, 0]])
        factor, of_mass = (splu(m, permc_spec="MMD_AT_PLUS_A", **SYMMETRIC) for m in (stiffness, mass))
        if (factor.U.diagonal() <= 0).any():
            raise InputError(f"the state is not stable: harmonic {n} has negative stiffness")
        # K x = w (2 W C x + M y), M y = w M x: B v = (1/w) A v with A positive.
        left = sp.block_diag([stiffness, mass], format="csc")
        right = sp.bmat([[2 * speed * coriolis, mass], [mass, None]], format="csc")
        size = len(free)

        def inverse(vector: Array) -> Array:
            flat = np.ravel(vector)
            return np.concatenate([factor.solve(flat[:size]), of_mass.solve(flat[size:])])

        values, vectors = eigsh(
            right, 2 * count, left, which="BE", tol=ACCURACY, v0=np.random.default_rng(0).normal(size=2 * size),
            Minv=LinearOperator(left.shape, matvec=inverse, dtype=float), ncv=min(2 * size, 8 * count + 20),
        )  # fmt: skip
        waves = []
        for value, vector in zip(values, vectors.T, strict=True):
            shape = np.zeros(vibration.harmonics.elements.n_dofs)
            shape[free] = vector[:size] * np.sign(vector[np.abs(vector[:size]).argmax()])
            waves.append((float(1 / value), shape / np.sqrt(shape @ vibration.mass @ shape)))
        return waves


@dataclass(frozen=True)
class RotatingMode(NaturalMode):
    """A wave of the rotating tyre; ``mode.frequency`` is that in the rubber's frame.

    Parameters
    ----------
    direction : "forward" (with the rotation), "backward", or "standing" for n = 0.
    axle_frequency : Hz, seen from the axle; 0 at the critical speed.
    """

    direction: str = "standing"
    axle_frequency: float = 0.0

    @property
    def label(self) -> str:
        """For a picture."""
        return f"{super().label} {self.direction}, {self.axle_frequency:.1f} Hz from the axle"

    def row(self) -> dict[str, Any]:
        """A row of the table."""
        row = super().row()
        turned = {"direction": self.direction, "axle_frequency_Hz": self.axle_frequency}
        return {"harmonic": row.pop("harmonic"), "frequency_Hz": row.pop("frequency_Hz"), **turned, **row}


@dataclass(frozen=True, eq=False)
class RotatingFrequencies(NaturalFrequencies):
    """Natural frequencies of a rotating tyre. Made by `rotating_frequencies`. ``angular_speed`` : W, rad/s."""

    angular_speed: float = 0.0

    def summary(self) -> dict[str, Any]:
        """As of the standing tyre, with the angular speed."""
        return {**super().summary(), "angular_speed_rad_s": self.angular_speed}


@one_thread()
def rotating_frequencies(
    study: StudyData, speed: float, harmonics: Iterable[int], **options: Any
) -> RotatingFrequencies:
    """Natural frequencies of a study's tyre that rotates at a speed, unloaded, rim turning with it.

    W = speed / radius of the free tyre. Names are those of `natural_frequencies`. Every wave of n >= 1 splits into one
    that runs forward and one backward.

    Parameters
    ----------
    speed : m/s, positive. harmonics, options : as of `natural_frequencies`.

    Raises
    ------
    InputError : as of `natural_frequencies`; a speed that is not positive, or too high for the tyre.
    """
    from tyrefem.mechanics.solid.inflation import inflate

    if not speed > 0:
        raise InputError(f"must be more than 0 m/s, not {speed:g} m/s", field="speed")
    standing = natural_frequencies(study, harmonics, **options)
    count = max(1, options.get("count", 2))
    spin = 2 * np.pi * Motion(speed, rolling_radius=float(standing.tyre.places[0].max())).revolutions_per_second
    tyre = inflate(study, standing.tyre.pressure, mechanical_mesh(study, large=False), angular_speed=spin)
    vibration = Vibration(Harmonics(dynamic_state(tyre, standing.stiffening)), densities(study, tyre))
    waves, belt = RotatingWaves(vibration, spin), belt_elements(tyre)
    modes = []
    for n in sorted({natural.mode.harmonic for natural in standing.modes}):
        left = {True: count, False: count}
        for w, shape, symmetric in waves.frequencies(n, count):
            backward = w > 0
            if not left[backward] or (n == 0 and not backward):
                continue
            left[backward] -= 1
            mode = Mode(n, abs(w) / (2 * np.pi), shape, symmetric)
            shares = vibration.shares(mode, belt)
            direction = "standing" if n == 0 else "backward" if backward else "forward"
            name = motion_name(vibration, mode, belt, shares)
            modes.append(RotatingMode(mode, name, shares, direction, abs(w - n * spin) / (2 * np.pi)))
    common = (standing.stiffening, standing.amplitude)
    return RotatingFrequencies(study, tyre, vibration, tuple(modes), *common, spin)
