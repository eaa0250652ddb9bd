"""Places that a law of missing heat may have: a station, a whole surface, the model's heat of a region, a film."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tyrefem.brief import Brief
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.forward.forward_model import Places
from tyrefem.diagnose.heat.sources import Place
from tyrefem.diagnose.unknowns.heat_patches import ALL_LAYERS, INNER, OUTER, RIM, SURFACES
from tyrefem.diagnose.unknowns.unknown import Unknown, of_effect
from tyrefem.effects import catalogue
from tyrefem.inputs.study import StudyData

#: Heat about a station, flux through a surface about a station, a share of the model's heat, a share of a film.
HEAT, FLUX, LOSS, FILM = "heat", "flux", "loss", "film"
#: Unit of the amplitude.
UNITS = {HEAT: "W/m**3", FLUX: "W/m**2", LOSS: "1", FILM: "1"}
#: Prior sd of a share of the model's heat, and of the logarithm of a film's factor (estimates).
LOSS_SD, FILM_SD = 0.2, 0.4
FILMS = ("road", "outside_air", "tread_air", "contained_air", "rim")
#: Name of the place of a share of the heat of all regions.
EVERYWHERE = "all regions"
#: Name of the place of a flux that is the same on the whole sidewall.
SIDEWALL = "whole sidewall surface"
#: A flux that is the same on a whole surface: name of the place -> surface of `missing-flux`.
WHOLE_SURFACES = {
    "whole tread surface": "tread", SIDEWALL: "sidewall", "whole outer surface": "outer",
    "whole inner surface": "inner",
}  # fmt: skip
#: Surface of the tyre at which a film, or the flux through a whole surface, acts.
SURFACE_OF = dict.fromkeys(("road", "outside_air", "tread_air"), OUTER) | {"contained_air": INNER, "rim": RIM} | {
    name: INNER if surface == "inner" else OUTER for name, surface in WHOLE_SURFACES.items()
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class LawPlace(Brief):
    """A place that a law may have.

    ``kind``: one of `UNITS`. ``station``: m along the meridian, NaN for a share or a whole surface. ``where``: layer,
    surface, region or film. ``unknown``: the amplitude as a diagnosis varies it. ``parts``: of heat at several places
    with one law, the unknown and the share of the amplitude of each.
    """

    kind: str
    station: float
    where: str
    unknown: Unknown
    sd: float
    parts: tuple[tuple[Unknown, float], ...] = ()

    @property
    def inside(self) -> bool:
        """Whether it is heat in the rubber, which acts while the tyre rolls."""
        return self.kind in (HEAT, LOSS)

    @property
    def surface(self) -> str:
        """The surface through which it flows; empty for heat in the rubber."""
        return "" if self.inside else SURFACE_OF.get(self.where, self.where)


def law_place(place: Place, unknown: Unknown) -> LawPlace:
    """The place of a source."""
    return LawPlace(HEAT if place.inside else FLUX, place.station, place.where, unknown, place.sd)


def shares_of_model(residuals: Residuals) -> tuple[LawPlace, ...]:
    """The model's own heat, in all regions and in each, and every film."""
    study = residuals.study
    stated = {effect.name for effect in study.card.effects}
    places = []
    if "missing-loss" not in stated:
        regions = [region for region in study.section.regions if region in study.materials]
        for region in (None, *regions) if len(regions) > 1 else (None,):
            choice = () if region is None else (("region", region),)
            (unknown,) = of_effect(catalogue()["missing-loss"], choice, LOSS_SD)
            places.append(LawPlace(LOSS, float("nan"), region or EVERYWHERE, unknown, LOSS_SD))
    for film in FILMS:
        choice = (("film", film),)
        known = [each for each in residuals.unknowns if each.effect == "film-scale" and each.choice == choice]
        unknown = known[0] if known else of_effect(catalogue()["film-scale"], choice, FILM_SD)[0]
        places.append(LawPlace(FILM, float("nan"), film, replace(unknown, sd=FILM_SD), FILM_SD))
    return tuple(places)


def whole_surfaces(residuals: Residuals) -> tuple[LawPlace, ...]:
    """A flux that is the same on a whole surface: water that evaporates, rain, radiation.

    Its prior sd is that of a single source of flux.
    """
    sd = residuals.settings.missing_flux * residuals.settings.source_spread
    effect = catalogue()["missing-flux"]
    places = []
    for where, surface in WHOLE_SURFACES.items():
        choice = () if surface == "outer" else (("surface", surface),)
        (unknown,) = of_effect(effect, choice, residuals.settings.missing_flux)
        places.append(LawPlace(FLUX, float("nan"), where, unknown, sd))
    return tuple(places)


def points_of(study: StudyData, places: Sequence[LawPlace]) -> Places:
    """Points (s, depth) whose mean temperature stands for each place; for films and fluxes the middle of the wall."""
    return tuple(_points(study, place) for place in places)


def _points(study: StudyData, place: LawPlace) -> tuple[tuple[float, float], ...]:
    section = study.section
    along = section.line.length * np.linspace(0.05, 0.95, 13)
    stations = [place.station] if np.isfinite(place.station) else list(along)
    whole = place.where in (ALL_LAYERS, EVERYWHERE, *SURFACES, *WHOLE_SURFACES)
    points = []
    for station in stations:
        thickness = float(section.total_thickness([station])[0])
        depths = thickness * np.linspace(0.05, 0.95, 19)
        regions = section.region_at(np.full(len(depths), station), depths)
        kept = [float(depth) for depth, region in zip(depths, regions, strict=True) if region == place.where]
        points += [(float(station), depth) for depth in (kept or ([thickness / 2] if whole else []))]
    return tuple(points) or ((float(stations[0]), float(section.total_thickness([stations[0]])[0]) / 2),)
