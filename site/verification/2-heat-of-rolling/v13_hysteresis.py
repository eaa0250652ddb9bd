r"""
Loss of a revolution with many harmonics
========================================

**Problem.** A point of a rolling tyre has a strain cycle of many harmonics. Rubber of one Maxwell element (time constant 4 ms) loses at each
harmonic :math:`n \pi \tan\delta(n f) \, E'(n f) \, \varepsilon_n^2`. Is the sum the area of the loop that rubber runs through in time?

**Source.** The same element integrated step by step over twenty revolutions, 8000 steps each.
"""

import matplotlib.pyplot as plt
import numpy as np
from reference_table import ReferenceTable
from scipy.signal import lfilter

from tyrefem.materials.loss_frequency import Prony

tau, equilibrium, modulus, frequency = 0.004, 1.0, 2.0, 12.0
amplitudes = np.array([0.0, 1.0, 0.8, 0.5, 0.4, 0.2, 0.1, 0.1, 0.05])
law = Prony(equilibrium, (modulus,), (tau,))
n, omega = np.arange(9), 2 * np.pi * frequency

steps = 8000
t = np.arange(20 * steps) / (frequency * steps)
strain = np.cos(np.multiply.outer(t, n * omega)) @ amplitudes
rate = -(np.sin(np.multiply.outer(t, n * omega)) * n * omega) @ amplitudes
decay = np.exp(-t[1] / tau)
memory = lfilter([1.0], [1.0, -decay], np.append(0.0, tau * (1 - decay) * (rate[:-1] + rate[1:]) / 2))
stress = equilibrium * strain + modulus * memory
in_time = (stress[-steps:] * rate[-steps:]).sum() * t[1]


def storage(f):
    return equilibrium + modulus * (2 * np.pi * f * tau) ** 2 / (1 + (2 * np.pi * f * tau) ** 2)


by_harmonics = sum(
    k * np.pi * float(law(k * frequency, np.array(20.0))) * storage(k * frequency) * amplitudes[k] ** 2 for k in n[1:]
)

# %%
# **Result**

figure, axes = plt.subplots(figsize=(5, 3.5), layout="constrained")
axes.plot(strain[-steps:], stress[-steps:])
axes.set(xlabel="strain", ylabel="stress over the equilibrium modulus")
plt.show()

# %%

table = ReferenceTable(
    "Loss of a revolution with many harmonics", "other formulation", "Maxwell element, step by step in time"
)
table.add("energy lost per revolution", by_harmonics, in_time, percent=0.1)
table
