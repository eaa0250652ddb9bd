"""
Heat into the road
==================

How strongly does the road cool the tread while they touch? Cattani et al. (2023) give the mean film of a contact. The
exact answer is that of two half-spaces that suddenly touch (Carslaw & Jaeger 1959).
"""

import matplotlib.pyplot as plt
import numpy as np

from tyrefem.boundaries.road_film import effusivity, half_space_film, triangular_film

conductivity, heat_capacity, length = 0.25, 2e6, 0.14  # tread: W/m/K, J/m3/K; footprint: m
asphalt = effusivity(1.5, 2e6)
speeds = np.linspace(5, 150, 30) / 3.6

films = {
    "Cattani et al.": [triangular_film(v, length, conductivity, heat_capacity) for v in speeds],
    "half-spaces, ideal road": [half_space_film(v, length, conductivity, heat_capacity) for v in speeds],
    "half-spaces, asphalt": [half_space_film(v, length, conductivity, heat_capacity, asphalt) for v in speeds],
}
figure, axes = plt.subplots(figsize=(7, 3.8), layout="constrained")
for name, film in films.items():
    axes.plot(speeds * 3.6, film, label=name)
axes.set(xlabel="speed, km/h", ylabel="mean film of the contact, W/m2/K")
axes.legend()
plt.show()

# %%
# The paper's table 2 has 12 198.75 W/m2/K at 150 km/h and a footprint of 0.14 m. The exact film of an ideal
# road, which keeps its temperature, is 2/sqrt(pi) times as large; asphalt, which warms, takes 0.71 of that.

assert abs(films["Cattani et al."][-1] - 12198.75) < 0.01
exact = films["half-spaces, ideal road"]
assert np.allclose(np.divide(exact, films["Cattani et al."]), 2 / np.sqrt(np.pi))
assert np.allclose(np.divide(films["half-spaces, asphalt"], exact), 0.71, atol=0.005)
