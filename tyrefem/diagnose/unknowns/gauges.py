"""Unknowns for gauges of the section that are off by their tolerances: a factor on each region's thickness."""

from __future__ import annotations

from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.inputs.changes import by_places
from tyrefem.inputs.name_patterns import SCALES
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.strain_laws import strain_laws

#: Effects for film coefficients that follow the speed by another law than the study's.
FILM_LAWS = ("outside-film-speed", "road-film-speed")


def gauges(study: StudyData, settings: DiagnosisSettings) -> tuple[Unknown, ...]:
    """ln(factor) on the thickness of each region, with the tolerance as its standard deviation.

    None for a mesh from a file, or where a strain law would have to press the tyre again for each; and none of those
    that the study states as uncertain.
    """
    if study.card.mesh.file is not None or strain_laws()[study.card.mechanics.strain].presses:
        return ()
    stated = {by_places(study.data, key) for number in study.uncertain_numbers for key in number.keys}
    keys = (f"{SCALES}.{region}" for region in study.section.regions)
    return tuple(Unknown(key, settings.gauge_sd, keys=(key,)) for key in keys if key not in stated)
