"""
The pressed tyre by another code
================================

**Problem.** A plain belted tyre of neo-Hookean rubber with cords is inflated to 2 bar and pressed by 20 mm on a flat road, in large motion, without
friction. tyrefem solves the section with 72 Fourier harmonics around the axis.

**Source.** FElupe, another finite element code, in three dimensions with 27-node hexahedra on the same section mesh, 5 degrees round the wheel. Its values
are those of ``docs/evidence/tables/other-code.csv``, which ``benchmarks/other_code.py`` makes. :doc:`Finer meshes </docs/evidence/footprint>`
"""

import matplotlib.pyplot as plt
import numpy as np
from reference_table import ReferenceTable

from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.solid.inflation import Inflation
from tyrefem.mechanics.solid.newton import equilibrium

body = PlainTyre().body(8, (1, 1, 1))
inflation = Inflation(body, equilibrium(body, 2e5))
footprint = Balance(Pressing(inflation.state), 72).at_deflection(0.02)

# %%
# **Result**: pressure on the middle of the tread, along the road.

grid = footprint.grid
shape = footprint.pressure.shape
along = grid.places(footprint.displacement, 0.0)[0].reshape(shape)
near = np.abs(grid.angles) < 0.35
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(along[near, 0] * 1e3, footprint.pressure[near, 0] / 1e3, "o-")
axes.set(xlabel="place along the road, mm", ylabel="pressure, kPa")
plt.show()

# %%

forces = footprint.pressure * grid.areas.reshape(shape) * grid.sides[:, None] / 2
effective = 4 * forces.sum() ** 2 / (footprint.pressure * forces).sum()
table = ReferenceTable("The pressed tyre by another code", "other formulation", "FElupe 11.3, 27-node hexahedra")
table.add("growth of the radius by inflation", inflation.radius_growth * 1e3, 6.8655, "mm", percent=0.2)
table.add("load", footprint.load, 2725.0, "N", percent=0.5)
table.add("effective area, F²/∫p² dA", effective * 1e4, 131.58, "cm²", percent=5)
table
