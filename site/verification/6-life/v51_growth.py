r"""
Growth of a flaw
================

**Problem.** A flaw grows by Thomas' law :math:`dc/dN = r_c (T/T_c)^F` with Lindley's tearing energy :math:`T = 2 k W_c c`, from :math:`c_0` to
:math:`c_1`. tyrefem has the number of cycles in closed form, for every exponent.

**Source.** The same integral by adaptive quadrature.
"""

import matplotlib.pyplot as plt
import numpy as np
from reference_table import ReferenceTable
from scipy.integrate import quad

from tyrefem.fatigue.growth import cycles_to_failure
from tyrefem.materials.fatigue import Fatigue

energy = 8e4  # J/m3
table = ReferenceTable("Growth of a flaw", "closed form", "quadrature")
figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
for exponent in (1.0, 2.0, 4.3):
    numbers = {"tearing_energy": "10 kJ/m**2", "growth_rate": "10 um", "exponent": exponent, "source": "an example"}
    card = Fatigue.check(numbers)
    slope = 2 * 2.95 * energy / 1e4
    exact, _ = quad(lambda c, a=slope, f=exponent: 1 / (10e-6 * (a * c) ** f), card.flaw, card.crack, epsrel=1e-12)
    table.add(f"cycles, exponent {exponent:g}", float(cycles_to_failure(card, energy)), exact, percent=1e-6)
    energies = np.geomspace(1e4, 1e6, 30)
    axes.loglog(
        energies / 1e3, [float(cycles_to_failure(card, each)) for each in energies], label=f"exponent {exponent:g}"
    )

# %%
# **Result**

axes.set(xlabel="cracking energy, kJ/m3", ylabel="cycles")
axes.legend()
plt.show()

# %%

table
