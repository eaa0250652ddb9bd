"""Unknowns for heat of unknown origin: heat and flux patches at stations along the meridian."""

from __future__ import annotations

from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns import Unknown, of_effect
from tyrefem.effects import catalogue
from tyrefem.inputs.study import StudyData


def patches(study: StudyData, settings: DiagnosisSettings) -> tuple[Unknown, ...]:
    """Unknown heat (while the tyre rolls) and unknown flux (always) at even stations from crown to bead."""
    length = study.section.line.length
    spacing = length / settings.stations
    known = catalogue()
    unknowns: list[Unknown] = []
    for name, sd in (("missing-heat", settings.missing_heat), ("missing-flux", settings.missing_flux)):
        for number in range(settings.stations):
            station = round((number + 0.5) * spacing, 6)
            choice = (("station", f"{station!r} m"), ("width", f"{round(spacing * 0.6, 6)!r} m"))
            unknowns += of_effect(known[name], choice, sd)
    return tuple(unknowns)
