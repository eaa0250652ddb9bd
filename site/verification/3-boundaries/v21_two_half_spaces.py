r"""
Two bodies suddenly touch
=========================

**Problem.** Tread and road of different temperature touch for :math:`t_c = 10` ms. The mean film between two half-spaces is

.. math:: H_c = \frac{2}{\sqrt{\pi}} \sqrt{\frac{\lambda C}{t_c}} \; \frac{b_{road}}{b_{road} + b_{tyre}}, \qquad b = \sqrt{\lambda C}

Does heat conduction by finite elements, which knows nothing of the formula, let as much heat through?

**Source.** Carslaw & Jaeger, *Conduction of heat in solids* (1959), 2.15; finite elements in layers from 0.2 µm on.
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem
from reference_table import ReferenceTable

from tyrefem.boundaries.road_film import effusivity, half_space_film
from tyrefem.conduction import Conduction, Material

tread, t = (0.25, 2e6), 0.01


def by_elements(road):
    """Film from the heat in the road after the contact, and the places and temperatures then."""
    depth = np.concatenate([[0.0], np.cumsum(2e-7 * 1.12 ** np.arange(90))])
    diffusivity = max(road[0] / road[1], tread[0] / tread[1])
    depth = depth[: np.searchsorted(depth, 8 * np.sqrt(diffusivity * t)) + 1]
    mesh = skfem.MeshQuad.init_tensor(np.concatenate([-depth[:0:-1], depth]), np.array([0.0, 1e-5]))
    mesh = mesh.with_subdomains({"tyre": lambda p: p[0] < 0, "road": lambda p: p[0] > 0})
    both = Conduction(mesh, {"tyre": Material(*tread), "road": Material(*road)}, axisymmetric=False)
    at, b, b_road = both.operators.points[0], effusivity(*tread), effusivity(*road)
    start = np.where(at < -1e-9, 1.0, np.where(at > 1e-9, 0.0, b / (b + b_road)))
    end = both.transient([0.0, t], start, 1e-4).values[-1]
    heat = (both.operators.matrix(both.operators.mass("road")) @ (end - start)).sum() * road[1] / 1e-5
    return heat / t, at, end


roads = {"asphalt": (1.5, 2e6), "rubber on rubber": (0.25, 2e6), "steel drum": (50.0, 3.6e6)}
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
table = ReferenceTable("Two bodies suddenly touch", "closed form", "Carslaw & Jaeger 1959, 2.15")
for name, road in roads.items():
    film, at, end = by_elements(road)
    exact = half_space_film(0.14 / t, 0.14, *tread, effusivity(*road))
    table.add(f"film, {name}", film, exact, "W/m²/K", percent=1)
    order = np.argsort(at)
    axes.plot(at[order] * 1e3, end[order], label=name)

# %%
# **Result**: temperature of the tread (left) and of the road (right) after 10 ms, over their difference before.

axes.set(xlabel="depth, mm", ylabel="temperature over the difference", xlim=(-0.3, 0.3))
axes.legend()
plt.show()

# %%

table
