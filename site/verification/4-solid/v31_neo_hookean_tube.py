r"""
A rubber tube blown up by two thirds
====================================

**Problem.** An incompressible neo-Hookean tube, radii 1 and 2 m, under 0.5 MPa that follows its surface. Areas are kept, :math:`r^2 - R^2 = c`, and
with :math:`x = r/R`

.. math:: p = \int_{r_i}^{r_a} G \left(x^2 - x^{-2}\right) \frac{dr}{r}

**Source.** Rivlin's solution for a neo-Hookean tube; the integral by quadrature.
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem
from reference_table import ReferenceTable
from scipy.integrate import quad
from scipy.optimize import brentq

from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.compounds import neo_hookean
from tyrefem.mechanics.solid.newton import equilibrium
from tyrefem.mechanics.solid.parts import RegionMaterial

shear = 1e6


def exact(pressure):
    """Growth of the bore, over its radius."""

    def needed(c):
        return quad(lambda R: shear * ((1 + c / R**2) - 1 / (1 + c / R**2)) * R / (R * R + c), 1, 2)[0]

    return np.sqrt(1 + brentq(lambda c: needed(c) - pressure, 0, 10)) - 1


mesh = skfem.MeshQuad.init_tensor(np.linspace(1, 2, 7), np.linspace(0, 0.5, 3))
mesh = mesh.with_subdomains({"rubber": lambda x: x[0] > 0}).with_boundaries(
    {"contained_air": lambda x: x[0] < 1 + 1e-9, "ends": lambda x: (x[1] < 1e-9) | (x[1] > 0.5 - 1e-9)}
)
body = Body(mesh, {"rubber": RegionMaterial(neo_hookean(shear, 1e4 * shear))}, {"ends": "z"})
bore = body.rings.boundary_nodes("contained_air")
pressures = np.array([1e5, 2e5, 3e5, 4e5, 5e5])
computed = [equilibrium(body, p).displacement[0, bore].mean() for p in pressures]

# %%
# **Result**

figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
fine = np.linspace(0, 5e5, 30)
axes.plot([exact(p) for p in fine], fine / 1e5, label="exact")
axes.plot(computed, pressures / 1e5, "o", label="tyrefem, six elements")
axes.set(xlabel="growth of the bore over its radius", ylabel="pressure, bar")
axes.legend()
plt.show()

# %%

table = ReferenceTable("A rubber tube blown up by two thirds", "closed form", "Rivlin's neo-Hookean tube")
for p, growth in zip(pressures[[0, 2, 4]], np.array(computed)[[0, 2, 4]], strict=True):
    table.add(f"growth at {p / 1e5:g} bar", growth, exact(p), percent=0.02)
table
