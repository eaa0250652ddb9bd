r"""
NAFEMS T2: radiation at the end of a bar
========================================

**Problem.** A bar of length 0.1 m, :math:`k = 55.563` W/m/K, insulated along its sides. One end is at 1000 K. The other radiates to
surroundings of 300 K with emissivity 0.98: :math:`q = \varepsilon \sigma (T^4 - T_0^4)`. Wanted is the steady temperature of that end.

**Source.** NAFEMS, *The standard NAFEMS benchmarks* (1990), test T2: 927 K. The quartic
:math:`k (1000 - T)/L = \varepsilon \sigma (T^4 - T_0^4)` gives 926.97 K.
"""

import matplotlib.pyplot as plt
import numpy as np
import skfem
from reference_table import ReferenceTable

from tyrefem.conduction import Conduction, Fixed, Material, Radiation

mesh = (
    skfem.MeshQuad.init_tensor(np.linspace(0, 0.1, 11), np.linspace(0, 0.01, 3))
    .with_subdomains({"bar": lambda x: x[0] > 0})
    .with_boundaries({"hot": lambda x: x[0] < 1e-9, "end": lambda x: x[0] > 0.1 - 1e-9})
)
field = Conduction(
    mesh,
    {"bar": Material(conductivity=55.563, heat_capacity=7850 * 460.0)},
    {"hot": Fixed(1000 - 273.15), "end": Radiation(emissivity=0.98, surroundings=300 - 273.15)},
    axisymmetric=False,
    element="P2",
).steady()

# %%
# **Result**

x = np.linspace(0, 0.1, 11)
computed = field.at([(place, 0.005) for place in x]) + 273.15
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(x, 1000 - (1000 - 926.97) * x / 0.1, label="exact")
axes.plot(x, computed, "o", label="tyrefem")
axes.set(xlabel="place, m", ylabel="temperature, K")
axes.legend()
plt.show()

# %%

end = computed[-1]
radiated = 0.98 * 5.67e-8 * (end**4 - 300.0**4) * 0.01
table = ReferenceTable("NAFEMS T2: radiation at the end of a bar", "benchmark", "NAFEMS T2 (927 K); quartic by hand")
table.add("temperature of the end", end, 926.97, "K", within=0.01)
table.add("heat through the hot end, per metre", -field.flux_through("hot"), radiated, "W", percent=1e-6)
table
