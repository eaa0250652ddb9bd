"""Thin elastic rings whose waves are known in closed form: bending, hoop tension, an elastic bed, rotation."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tyrefem.mechanics.footprint.example_tyre import stress_free
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.footprint.vibration import Vibration
from tyrefem.mechanics.rolling.rotating_modes import RotatingWaves
from tyrefem.mechanics.rolling.standing_waves import SteadyWaves
from tyrefem.mechanics.solid.body import Prestressed


@dataclass(frozen=True)
class ElasticRing:
    """A nearly incompressible ring under a hoop force, on a radial elastic bed. SI.

    Parameters
    ----------
    thickness, width, radius : m. tension : N. bed : N/m2 per length of the hoop.

    >>> ring = ElasticRing(0.02)
    >>> abs(ring.slowest(2) / ring.critical(2) - 1) < 1e-3
    True
    """

    thickness: float
    width: float = 0.02
    radius: float = 1.0
    tension: float = 0.0
    bed: float = 0.0
    shear: float = 1e8
    bulk: float = 1e11
    density: float = 1200.0

    @property
    def line_density(self) -> float:
        """Mass per length, kg/m."""
        return self.density * self.thickness * self.width

    @property
    def bending(self) -> float:
        """E I, N m2."""
        young = 9 * self.bulk * self.shear / (3 * self.bulk + self.shear)
        return young * self.width * self.thickness**3 / 12

    def critical(self, n: int) -> float:
        """W_n, rad/s, of n waves that stand: W^2 rho A R^2 (n^2 - 1)^2 = (E I n^2/R^2 + N)(n^2 - 1)^2 + k n^2 R^2."""
        r = self.radius
        stiffness = (self.bending * n**2 / r**2 + self.tension) * (n**2 - 1) ** 2 + self.bed * (n * r) ** 2
        return float(np.sqrt(stiffness / self.line_density) / (n**2 - 1) / r)

    def rotating(self, n: int, spin: float) -> tuple[float, float]:
        """Backward and forward frequency, rad/s, of the free ring that turns with ``spin``, in its frame (Bryan 1890):
        w = 2 n W/(n^2 + 1) +- sqrt(w_0^2 + (n (n^2 - 1) W/(n^2 + 1))^2)."""
        still = n**2 * (n**2 - 1) ** 2 / (n**2 + 1) * self.bending / (self.line_density * self.radius**4)
        mean = 2 * n * spin / (n**2 + 1)
        half = float(np.sqrt(still + (n * (n**2 - 1) * spin / (n**2 + 1)) ** 2))
        return mean + half, mean - half

    @property
    def state(self) -> Prestressed:
        """The ring in two by two elements; a weak support holds its rigid motions."""
        import scipy.sparse as sp
        import skfem

        r, h, b = self.radius, self.thickness, self.width
        mesh = skfem.MeshQuad.init_tensor(np.linspace(r - h / 2, r + h / 2, 3), np.linspace(-b / 2, b / 2, 3))
        state = stress_free(mesh, self.shear, self.bulk, fixed=())
        stress = np.zeros_like(state.stress)
        stress[2] = self.tension / (h * b)
        elements = Harmonics(state).elements
        springs = np.zeros(elements.n_dofs)
        if self.bed:
            middle = np.flatnonzero(np.abs(elements.nodes[0] - r) < 1e-9)
            # Simpson's rule over the width: 1 4 2 4 1; per radian the hoop's length is R.
            order = middle[np.argsort(elements.nodes[1, middle])]
            springs[3 * order] = self.bed * r * np.array([1, 4, 2, 4, 1]) / 12
        return replace(state, stress=stress, support=sp.diags(springs + 1e-3))

    @property
    def vibration(self) -> Vibration:
        """Stiffness and mass."""
        state = self.state
        return Vibration(Harmonics(state), np.full(state.bulk.shape, self.density))

    def slowest(self, n: int) -> float:
        """W_n, rad/s, by finite elements: the slowest radial wave."""
        waves = SteadyWaves(self.vibration).waves(n, 4)
        return next(wave.angular_speed for wave in waves if np.abs(wave.shape).argmax() % 3 == 0)

    def splitting(self, n: int, spin: float) -> tuple[float, float]:
        """`rotating` by finite elements; ``tension`` should be that of the rotation, rho A (W R)^2."""
        waves = RotatingWaves(self.vibration, spin).frequencies(n, 4)
        radial = [w for w, shape, _ in waves if np.abs(shape).argmax() % 3 == 0]
        return min(w for w in radial if w > 0), max(w for w in radial if w < 0)
