"""Draw docs/pictures/extending.png: the laws of docs/extending.md beside shipped ones (run from the root)."""

from __future__ import annotations

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import tyrefem as tf
from tyrefem.boundaries import laws
from tyrefem.contracts import TEMPLATES, template
from tyrefem.mechanics.cycle_schedule import cycle_schedule
from tyrefem.mechanics.user_cycle import points_of
from tyrefem.output import atomic_path
from tyrefem.plugins import use

PICTURE = Path("docs/pictures/extending.png")
SHIPPED, YOURS = {"color": "0.55"}, {"color": "#b3400e", "lw": 2}


def draw() -> None:
    """Four panels: film, tan delta, strain energy, friction."""
    figure, ((film, loss), (energy, friction)) = plt.subplots(2, 2, figsize=(9, 5.6), layout="constrained")
    speeds = np.linspace(0, 30, 61)
    outside = laws("outside_air")
    for table, style in (({"law": "nasa"}, SHIPPED), ({"law": "power-film", "at_10_m_s": "30 W/m**2/K"}, YOURS)):
        law = outside[table["law"]].check(table)
        film.plot(speeds, [law.film(v) for v in speeds], label=table["law"], **style)
    film.set(xlabel="speed, m/s", ylabel="film to the air, W/m²/K", title="boundary law")

    arrhenius = {"law": "arrhenius", "value": 0.2, "activation": "1300 K", "source": "example"}
    study = tf.study("nasa-22x5.5-8pr")
    changed = study.replace({"materials.tread": {"base": "nasa-tread", "loss_tangent": arrhenius}})
    temperatures = np.linspace(0, 120, 61)
    for each, name, style in ((study, "exponential", SHIPPED), (changed, "arrhenius", YOURS)):
        loss.plot(temperatures, each.materials["tread"].loss_tangent(temperatures), label=name, **style)
    loss.set(xlabel="temperature, °C", ylabel="tan δ of the tread", title="tan delta law")

    for name, style in (("arcs", {**SHIPPED, "marker": "."}), ("crown-to-bead", {**YOURS, "marker": "."})):
        each = study.replace({"mechanics.strain": name})
        cycle = cycle_schedule(each).cycles[0][0]
        points = [(points_of(each.section, zone), zone.name) for zone in cycle.zones]
        s = np.concatenate([np.abs(each.section.locate(x.T)[0]) for x, _ in points])
        U = np.concatenate([cycle.energy_density(zone, x) for x, zone in points])
        order = np.argsort(s)
        energy.plot(1e3 * s[order], U[order] / 1e3, ls="", label=name, **style)
    energy.set(xlabel="distance from the crown, mm", ylabel="strain energy, kJ/m³", title="strain law")

    savkoor = {"law": "savkoor", "coefficient": 1.2, "standstill": 0.8, "peak_speed": "1 m/s", "width": 0.5}
    sliding = np.geomspace(1e-3, 50, 80)
    for table, style in ((savkoor, SHIPPED), ({"law": "falling", "at_rest": 1.1}, YOURS)):
        card = study.replace({"materials.tread": {"base": "nasa-tread", "friction": {**table, "source": "example"}}})
        law = card.materials["tread"].friction
        assert law is not None
        friction.semilogx(sliding, law(sliding, 3e5, 40.0), label=table["law"], **style)
    friction.set(xlabel="sliding speed, m/s", ylabel="coefficient of friction", title="friction law")
    for axes in (film, loss, energy, friction):
        axes.legend(frameon=False)
        axes.spines[["top", "right"]].set_visible(False)
    with atomic_path(PICTURE) as temporary:
        figure.savefig(temporary, dpi=110)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        for kind, name in TEMPLATES.items():
            (Path(folder) / f"{kind}.py").write_text(template(kind, name), encoding="utf-8")
        use(folder)
        draw()
