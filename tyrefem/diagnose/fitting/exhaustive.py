"""Every set of effects fitted with the full model: the reference for small catalogues."""

from __future__ import annotations

from dataclasses import dataclass

from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.fitting.selection import ScoredSet, SelectionProblem, sets_of
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Members
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData


@dataclass(frozen=True)
class Exhaustive:
    """All sets up to ``DiagnosisSettings.largest`` effects, each fitted to convergence.

    The fit of a set starts from the best subset that nearly explains the data. Without one it starts from x = 0.
    """

    def check(self, study: StudyData, candidates: Members, settings: DiagnosisSettings) -> None:
        """Refuse more sets than ``DiagnosisSettings.most_exhaustive``.

        Raises
        ------
        InputError : there are more sets.
        """
        count = sum(1 for size in range(settings.largest + 1) for _ in sets_of(candidates, size))
        if count > settings.most_exhaustive:
            raise InputError(
                f"the exhaustive search would fit {count:,} sets of up to {settings.largest} effects; allowed: "
                f"{settings.most_exhaustive:,}. Exclude effects, allow fewer at once, or search forward",
                field="diagnosis.exclude",
                file=study.file,
            )

    def search(self, problem: SelectionProblem) -> list[ScoredSet]:
        """See `tyrefem.diagnose.fitting.selection.Strategy`."""
        by_size = [list(sets_of(problem.candidates, size)) for size in range(problem.settings.largest + 1)]
        fits: dict[Members, FittedSet] = {}
        for sets in by_size:
            fits |= zip(sets, self._converged(problem, sets, fits), strict=True)
        scored = [ScoredSet(problem.score(fit), members, fit) for members, fit in fits.items()]
        return sorted(scored, key=lambda entry: -entry.score)

    def _converged(
        self, problem: SelectionProblem, sets: list[Members], fits: dict[Members, FittedSet]
    ) -> list[FittedSet]:
        """Fits of sets, each continued at most ``DiagnosisSettings.most_continuations`` times."""
        ahead = sorted((members for members, fit in fits.items() if fit.close), key=lambda m: -problem.score(fits[m]))
        parts = {members: next((part for part in ahead if set(part) < set(members)), None) for members in sets}
        current = problem.fitted(sets, {members: fits[part] for members, part in parts.items() if part is not None})
        for _ in range(problem.settings.most_continuations):
            left = [number for number, fit in enumerate(current) if not fit.finished]
            further = problem.continued([current[number] for number in left])
            for number, fit in zip(left, further, strict=True):
                current[number] = fit
        return current
