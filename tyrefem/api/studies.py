"""A study with its methods, by name or path."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.api.result import Campaign, Result
from tyrefem.api.study_mechanics import StudyMechanics
from tyrefem.api.study_questions import StudyQuestions
from tyrefem.api.verbs import shown, with_verbs
from tyrefem.errors import InputWarning
from tyrefem.mechanics.cautions import warnings_of
from tyrefem.mechanics.strain_laws import strain_law

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.inputs.study_parts import StudyParts


class Study(StudyQuestions, StudyMechanics):
    """A study, with methods to run, compare, diagnose and sweep it. `study` loads it; `replace` gives a changed one.

    >>> coarse = study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.duration": "60 s"})
    >>> f"{coarse.run().peaks['tyre'].temperature:.0f} degC"
    '36 degC'
    """

    def __post_init__(self, like: StudyData | None, built: StudyParts | None) -> None:
        super().__post_init__(like, built)
        # The data's package does not import the strain laws; this class checks their name.
        strain_law(self)

    @functools.cached_property
    def warnings(self) -> tuple[InputWarning, ...]:
        """Warnings of unusual input in the study, its section, its material cards and its effects."""
        return warnings_of(self)

    def _repr_html_(self) -> str | None:
        from tyrefem.reports.notebook import study_page

        return shown(lambda: study_page(self))

    def run(self, progress: Callable[[float], None] | None = None, *, partial: bool = False) -> Result:
        """Simulate the drive; of a campaign the drive of the study itself.

        ``progress`` is called with the time (s) after every step.

        ``partial``: return the finished part after Ctrl-C (``result.history.interrupted``); else raise it.
        """
        from tyrefem.simulation.estimate import RunEstimate
        from tyrefem.simulation.run import run

        RunEstimate.of(self).announce()
        return with_verbs(Result, run(self, progress, partial=partial))

    def campaign(self) -> Campaign:
        """The cases of the study's table, each of them a study.

        Raises
        ------
        InputError : the study has no table of cases, or the table or a case has an error.
        """
        return Campaign.of(self)


def study(name: str | Path, changes: Mapping[str, Any] | None = None, case: str | None = None) -> Study:
    """Load a study by name or path; ``changes`` gives new values by dotted name.

    ``case``: case of a campaign; ``changes`` then change the case's values.

    Raises
    ------
    InputError : the study does not exist, or it or a card that it names has an error: file, field, what is allowed.
    """
    return Study.load(name, changes, case)
