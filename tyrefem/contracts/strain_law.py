"""Contracts of a user's strain law."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from tyrefem.contracts.contract import Contract, kept, of_trials
from tyrefem.contracts.law import finite_run_of
from tyrefem.contracts.study import quick_study
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.cycle_schedule import cycle_schedule
from tyrefem.mechanics.strain_laws import StrainLaw
from tyrefem.mechanics.user_cycle import UserCycle, points_of

#: Largest deviation from the scaling that the law states.
SCALING = 1e-6


def contracts(cls: type[StrainLaw], study_name: str | None = None) -> Iterator[Contract]:
    """The contracts of a strain law: zones, energies of at least 0, its scaling, a run."""
    changes = {"mechanics.strain": cls.name}
    words = "it gives the strain cycles of a study"
    try:
        study = quick_study(study_name, changes)
        schedule = cycle_schedule(study)
    except InputError as error:
        other = "" if study_name else "; another study: tyrefem check FILE --study NAME"
        yield Contract(words, f"{error}{other}")
        return
    yield Contract(words)
    cycle = schedule.cycles[0][0]
    if isinstance(cycle, UserCycle):
        yield from of_trials(cycle.trials(study.section))
    heated = {zone.region for zone in cycle.zones}
    lacking = [region for region in study.section.regions if region not in heated]
    yield Contract(
        "every region of the section has a zone",
        f"{', '.join(lacking)} have none, and no heat: give them a zone, of 0 J/m3 if so" if lacking else None,
    )
    if cls.energy_exponent is not None:
        power = f"the energies go with the deflection to the power of {cls.energy_exponent:g}, as the law says"
        yield kept(power, lambda: _scales(cls, study))
    yield finite_run_of(changes, study_name)


def _scales(cls: type[StrainLaw], study: StudyData) -> str | None:
    assert cls.energy_exponent is not None
    case = cycle_schedule(study).cases[0][0]
    cycle_of = cls().provider(study)
    small, large = (cycle_of(replace(case, deflection=share * case.deflection)) for share in (0.5, 1.0))
    for zone in small.zones:
        points = points_of(study.section, zone)
        expected = small.energy_density(zone.name, points) * 2.0**cls.energy_exponent
        given = large.energy_density(zone.name, points)
        if not np.allclose(given, expected, rtol=SCALING, atol=1e-9):
            means = f"{np.mean(given):.4g}, not {np.mean(expected):.4g} J/m3"
            return f"in zone '{zone.name}' twice the deflection gives {means}"
    return None
