"""Result of a diagnosis, and the plan of the next runs and sensors."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from tyrefem.api.verbs import shown, with_verbs
from tyrefem.diagnose import diagnosis
from tyrefem.inputs.study import StudyData
from tyrefem.plan import steps as test_plan


class Diagnosis(diagnosis.DiagnosisData):
    """Result of a diagnosis, with its sentences (`headline`, `words`), `to_dict` and `save`."""

    def _repr_html_(self) -> str | None:
        from tyrefem.reports.notebook import diagnosis_page

        return shown(lambda: diagnosis_page(self))

    @classmethod
    def of(cls, data: diagnosis.DiagnosisData) -> Diagnosis:
        """Convert a diagnosis, and every further look at the same data, to this class."""
        return with_verbs(cls, data, again=None if data.again is None else cls.of(data.again))

    @cached_property
    def label(self) -> str:
        """The verdict as people read it: "no gap after corrections" if the original study deviates clearly."""
        from tyrefem.diagnose.words.headline import label

        return label(self)

    @cached_property
    def headline(self) -> tuple[str, str, str]:
        """What is wrong, how sure, and what to do next, a sentence each."""
        from tyrefem.diagnose.words.headline import headline

        return headline(self)

    @cached_property
    def words(self) -> tuple[str, ...]:
        """The verdict in more sentences: amounts, strain laws, missing heat and its law, priors, noise."""
        from tyrefem.diagnose.words.sentences import verdict_words

        return verdict_words(self)

    @cached_property
    def confidence(self) -> float:
        """Smallest probability of a named effect, also without one sensor or run; NaN without a name."""
        from tyrefem.diagnose.words.discrepancy_record import confidence

        return confidence(self)

    def to_dict(self) -> dict[str, Any]:
        """Contents of `verdict.json`."""
        from tyrefem.diagnose.words.record import record

        return record(self)

    def save(self, folder: str | Path, *, force: bool = False) -> Path:
        """Write the files of `tyrefem diagnose`: verdict.json, amended.toml, study.toml, summary.json, tables,
        pictures and one self-contained page, whose path it returns.

        ``force``: replace the user's files and the results of other commands.

        Raises
        ------
        InputError : the folder cannot be written; files in it are not of this command.
        """
        from tyrefem.api.saving import saving
        from tyrefem.inputs.origin import StudyOrigin
        from tyrefem.reports.diagnosis import FILES, save

        candidates = [candidate.name for candidate in self.candidates]
        origin = StudyOrigin(self.original, simulated=True).using(candidates)
        with saving(folder, "diagnose", FILES, origin, force=force) as place:
            return save(self, place)


@dataclass(frozen=True, eq=False, repr=False)
class ExperimentPlan(test_plan.PlanData):
    """A plan of the next runs and sensors for a study, ``original``, with `words` and `save`."""

    original: StudyData = field(kw_only=True)

    @cached_property
    def words(self) -> tuple[str, ...]:
        """The remaining sets, and each step with what it is expected to tell, as sentences."""
        from tyrefem.plan.words import plan_words

        return tuple(plan_words(self))

    def to_dict(self) -> dict[str, Any]:
        """Contents of `plan.json`."""
        from tyrefem.plan.record import record

        return record(self)

    def save(self, folder: str | Path, *, force: bool = False) -> Path:
        """Write the files of `tyrefem plan`: plan.csv, plan-candidates.csv, plan.json, plan.png, study.toml,
        summary.json and plan.html, whose path it returns.

        ``force``: replace the user's files and the results of other commands.

        Raises
        ------
        InputError : the folder cannot be written; files in it are not of this command.
        """
        from tyrefem.api.saving import saving
        from tyrefem.inputs.origin import StudyOrigin
        from tyrefem.plan.information import SEED
        from tyrefem.reports.plan import FILES, save

        origin = StudyOrigin(self.original, simulated=True, random_seed=SEED).using(self.to_dict()["plugins"])
        with saving(folder, "plan", FILES, origin, force=force) as place:
            return save(self, place)
