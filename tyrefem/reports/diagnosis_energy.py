"""Picture of the heat that the tyre makes beside that of the model, along the meridian."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tyrefem.diagnose.beside.discrepancy import ENERGY
from tyrefem.diagnose.unknowns.energy_shapes import SHAPE
from tyrefem.diagnose.verdicts.verdict import PARTLY, UNEXPLAINED
from tyrefem.diagnose.words.strain_energy import energy_shares
from tyrefem.reports.diagnosis_missing import draw_zones
from tyrefem.reports.figures.style import FONT, INK, PALETTE, QUIET, TITLE, add_axes, figure, tidy, title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.diagnose.diagnosis import DiagnosisData
    from tyrefem.diagnose.fitting.fits import FittedSet
    from tyrefem.inputs.study import StudyData

NAME = "energy-share.png"


def energy_figures(d: DiagnosisData) -> dict[str, Figure]:
    """The picture, if another strain energy along the meridian is the most probable discrepancy; else none."""
    fit = _fit(d)
    return {} if fit is None else {NAME: energy_figure(d, fit)}


def _fit(d: DiagnosisData) -> FittedSet | None:
    """The fit beside another strain energy: with the effects that are a part of the cause, or without any."""
    leading = d.robustness.models[0] if d.robustness else None
    if leading is None or leading.name != ENERGY or d.verdict not in (PARTLY, UNEXPLAINED):
        return None
    fit = d.best if d.verdict == PARTLY else leading.fits.get(())
    return fit if fit is not None and any(unknown.effect == SHAPE for unknown in fit.unknowns) else None


def sensor_stations(study: StudyData) -> list[float]:
    """Distance of every sensor from the crown along the meridian, m, however its place is given."""
    places = np.array([*study.stated_places.values()]).reshape(-1, 2)
    return np.abs(study.section.locate(places)[0]).tolist() if len(places) else []


def energy_figure(d: DiagnosisData, fit: FittedSet) -> Figure:
    """Draw how much more or less heat the tyre makes than the model, %, with one and two standard deviations.

    Sensors are marked at their stations: between them the course is a guess of smooth half waves.
    """
    share, sd, s = energy_shares(d, fit)
    drawn = figure(9.4, TITLE + 3.0)
    axes = add_axes(drawn, 0.85, 0.55, 8.3, 2.35)
    draw_zones(axes, d.original.section)
    for wide, alpha in ((2.0, 0.14), (1.0, 0.22)):
        low, high = 100 * (share - wide * sd), 100 * (share + wide * sd)
        axes.fill_between(s * 1e3, low, high, color=PALETTE[0], alpha=alpha, lw=0)
    axes.plot(s * 1e3, 100 * share, color=PALETTE[0], lw=1.6)
    axes.axhline(0.0, color=INK, lw=0.7)
    for station in sensor_stations(d.original):
        axes.axvline(station * 1e3, ymax=0.04, color=QUIET, lw=1.4)
    axes.set_xlim(0.0, d.original.section.line.length * 1e3)
    axes.set_ylabel("more heat than the model [%]", fontsize=FONT)
    axes.set_xlabel("place along the meridian from crown to bead, s [mm]; ticks: sensors", fontsize=FONT)
    tidy(axes)
    title(drawn, "Heat of the tyre beside that of the model", "bands: 1 and 2 standard deviations")
    return drawn
