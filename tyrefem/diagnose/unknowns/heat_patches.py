"""Unknowns for heat of unknown origin: heat and flux patches at stations along the meridian."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.unknown import Choice, Unknown, of_effect, stated_effect
from tyrefem.effects import catalogue
from tyrefem.effects.part_of_drive import times_in_words
from tyrefem.inputs.study import StudyData

#: Where heat may enter at a station: in all layers, or through a surface. A name that is none of these is a region.
ALL_LAYERS, OUTER, INNER, RIM = "all layers", "outer surface", "inner surface", "rim"
SURFACES = {OUTER: "outer", INNER: "inner", RIM: "rim"}


def patches(study: StudyData, settings: DiagnosisSettings) -> tuple[Unknown, ...]:
    """Unknown heat (while the tyre rolls) and unknown flux (always) at even stations from crown to bead."""
    places = stations(study, settings)
    return tuple(patch(study, settings, station, where) for where in (ALL_LAYERS, OUTER) for station in places)


def surface_patches(study: StudyData, settings: DiagnosisSettings) -> tuple[Unknown, ...]:
    """Unknown flux through the inner surface at every station, and from the rim at the last station."""
    places = stations(study, settings)
    inner = [patch(study, settings, station, INNER) for station in places]
    return (*inner, patch(study, settings, places[-1], RIM))


def layer_patches(study: StudyData, settings: DiagnosisSettings, station: float) -> tuple[Unknown, ...]:
    """Unknown heat in each single region at a station; none if only one region is there."""
    depths = np.linspace(0.02, 0.98, 49) * float(study.section.total_thickness([station])[0])
    regions = dict.fromkeys(map(str, study.section.region_at(np.full(49, station), depths)))
    heated = [region for region in regions if region in study.materials]
    return tuple(patch(study, settings, station, region) for region in heated) if len(heated) > 1 else ()


def stations(study: StudyData, settings: DiagnosisSettings) -> list[float]:
    """Distances from the crown along the meridian, m."""
    spacing = study.section.line.length / settings.stations
    return [round((number + 0.5) * spacing, 6) for number in range(settings.stations)]


def patch(study: StudyData, settings: DiagnosisSettings, station: float, where: str, when: Choice = ()) -> Unknown:
    """The unknown heat or flux about a station, beyond what the study states there; ``when``: see `written_times`."""
    spacing = study.section.line.length / settings.stations
    choice: Choice = (("station", f"{station!r} m"), ("width", f"{round(spacing * 0.6, 6)!r} m"))
    if where in SURFACES:
        choice += () if where == OUTER else (("surface", SURFACES[where]),)
        return _beyond(study, "missing-flux", choice, when, settings.missing_flux)
    choice += () if where == ALL_LAYERS else (("region", where),)
    return _beyond(study, "missing-heat", choice, when, settings.missing_heat)


def _beyond(study: StudyData, name: str, choice: Choice, when: Choice, sd: float) -> Unknown:
    """A patch with its origin at the study's entry of the same choice, if there is one; its sd is that of any patch."""
    stated = stated_effect(study, name, choice + when)
    known = None if stated is None else stated.model_copy(update={"sd": {}})
    return at_times(of_effect(catalogue()[name], choice, sd, known)[0], when)


def written_times(begins: float | None, ends: float | None) -> Choice:
    """When a patch begins and ends, s, as the choice of its effect states it; None: the drive's begin or end."""
    rounded = (None if time is None else round(float(time), 1) for time in (begins, ends))
    return tuple(times_in_words(*rounded).items())


def at_times(always: Unknown, when: Choice) -> Unknown:
    """A patch that acts at all times, limited to some: they stand in its choice, and with their names in its key."""
    if not when:
        return always
    place, _, parameter = always.key.rpartition(".")
    key = ".".join((place, *map(" ".join, when), parameter))
    return replace(always, choice=(*always.choice, *when), key=key)


def place_of(unknown: Unknown) -> tuple[float, str]:
    """(station, m; where) of a patch: `ALL_LAYERS`, a surface, or the name of a region."""
    choice = dict(unknown.choice)
    station = float(choice["station"].split()[0])
    if unknown.effect == "missing-heat":
        return station, choice.get("region", ALL_LAYERS)
    names = {written: name for name, written in SURFACES.items()}
    return station, names[choice.get("surface", "outer")]


def is_inside(patches: Sequence[Unknown]) -> list[bool]:
    """Whether each patch is heat inside the rubber, not a flux through a surface."""
    return [unknown.effect == "missing-heat" for unknown in patches]
