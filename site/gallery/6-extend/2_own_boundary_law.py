"""
A boundary law of your own
==========================

The report's film of the outside air grows in proportion to the speed. In turbulent flow it grows with its power of 0.8.
A file adds that law; the study chooses it by its name.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import tyrefem as tf
from tyrefem.contracts import check_file
from tyrefem.plugins import use

FILE = '''
from typing import ClassVar, Literal

from tyrefem.boundaries.outside_air import OutsideAirLaw
from tyrefem.cards import FilmCoefficient


class TurbulentFilm(OutsideAirLaw):
    """h = at_rest + at_10_m_s (v / 10 m/s)^0.8."""

    law: Literal["turbulent-film"]
    at_rest: FilmCoefficient = 5.44
    at_10_m_s: FilmCoefficient

    # Values for ``tyrefem check``.
    example: ClassVar[dict[str, str]] = {"at_10_m_s": "20 W/m**2/K"}

    def film(self, speed):
        return self.at_rest + self.at_10_m_s * (speed / 10.0) ** 0.8
'''
file = Path(tempfile.mkdtemp()) / "turbulent_film.py"
file.write_text(FILE, encoding="utf-8")
checked = check_file(file)
print(*checked.lines, sep="\n")
assert checked.failed == 0

# %%
# Both laws agree at 10 m/s. At twice that speed the part of the wind is 2 to the power of 0.8 larger, not twice.

use(file)
study = tf.study("nasa-22x5.5-8pr", {"mesh.size": "8 mm", "mesh.element": "P1"})
own = study.replace({"boundaries.outside_air": {"law": "turbulent-film", "at_10_m_s": "16.74 W/m**2/K"}})
films = {"report": study.card.boundaries.outside_air.film, "own": own.card.boundaries.outside_air.film}
assert np.isclose(films["own"](10.0), films["report"](10.0), rtol=1e-3)
assert np.isclose((films["own"](20.0) - 5.44) / 16.74, 2**0.8)

speeds = np.array([10.0, 15.0, 20.0, 25.0])
hottest = {
    name: [each.replace({"drive.speed": f"{speed} m/s"}).run().peaks["tyre"].temperature for speed in speeds]
    for name, each in {"report": study, "own": own}.items()
}
figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.3), layout="constrained")
for name in films:
    left.plot(speeds, [films[name](speed) for speed in speeds], "o-", label=name)
    right.plot(speeds, hottest[name], "o-", label=name)
left.set(xlabel="speed, m/s", ylabel="film of the outside air, W/m²/K")
right.set(xlabel="speed, m/s", ylabel="hottest place, °C")
left.legend()
plt.show()

# %%
# A smaller film, a hotter tyre: nothing at 10 m/s, more with every step of speed.

warmer = np.subtract(hottest["own"], hottest["report"])
assert abs(warmer[0]) < 0.01
assert (np.diff(warmer) > 0).all()
