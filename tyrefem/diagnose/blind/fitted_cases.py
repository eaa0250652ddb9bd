"""Quick cases judged as a diagnosis judges: readings by simulation, sets of effects fitted with the full model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

import tyrefem
from tyrefem.diagnose.blind.kept_cases import computed_cases, keep_cases, kept_cases, resuming, tag_for
from tyrefem.diagnose.data.residuals import Residuals, residuals_of
from tyrefem.diagnose.data.runs import drive_of_means
from tyrefem.diagnose.data.sensitivities import Sensitivities
from tyrefem.diagnose.forward.effort import CASE, check_effort
from tyrefem.diagnose.forward.evaluations import Evaluations, evaluating
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.forward.multifidelity import Predictions
from tyrefem.diagnose.layout.linear_layout import LinearLayout, competing, linear_layout
from tyrefem.diagnose.layout.quick_cases import DrawnCause, QuickCase, drawn, judged_case
from tyrefem.diagnose.options import Method
from tyrefem.diagnose.ranking import rank
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns.candidates import Members
from tyrefem.diagnose.unknowns.heat_patches import patches
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.output import jsonable
from tyrefem.variants.answer_store import study_digest

#: Sets are drawn from those of up to two effects, and no larger ones are searched.
SETTINGS = replace(DEFAULT, largest=2)
#: A cause with which the tyre is impossible is drawn again, at most so often.
MOST_DRAWS = 20


@dataclass(frozen=True, eq=False)
class FittedLayout:
    """Planned runs of a study with their sensitivities, as those of a linear layout; ``seed``: of the cases."""

    study: StudyData
    known: Sensitivities
    seed: int

    @cached_property
    def linear(self) -> LinearLayout:
        """The linear layout, from whose priors causes are drawn."""
        return linear_layout(self.study, self.known, SETTINGS)

    @cached_property
    def competing(self) -> tuple[Members, Sensitivities]:
        """The effects that compete, and sensitivities to them."""
        return competing(self.study, self.known, SETTINGS)

    @cached_property
    def patches(self) -> tuple[Unknown, ...]:
        """Patches of heat of unknown origin."""
        return patches(self.study, SETTINGS)

    def values(self, cause: DrawnCause, number: int) -> dict[Unknown, float]:
        """x of every unknown of a cause in a run: heat of unknown origin has a part that is the run's own."""
        values = cause.signal
        if not len(cause.heat):
            return values
        order = [*self.known.fitted, *self.known.held_out]
        shared, *of_runs = np.split(cause.heat * self.linear.heat_sd, 1 + len(order))
        heat = shared + of_runs[order.index(number)]
        return values | dict(zip(self.patches, map(float, heat), strict=True))

    def drawn_residuals(self, evaluations: Evaluations, rng: np.random.Generator) -> tuple[DrawnCause, Residuals]:
        """A cause drawn from the priors, and the residuals of its simulated readings with noise."""
        _, known = self.competing
        computed = tuple(drive_of_means(each, mean) for each, mean in zip(known.drives, known.computed, strict=True))
        origin = residuals_of(self.study, computed, known, SETTINGS)
        numbers = range(len(known.drives))
        for _ in range(MOST_DRAWS):
            cause = drawn(self.linear, rng)
            answers = evaluations.of("predict", [(number, self.values(cause, number)) for number in numbers])
            if all(np.isfinite(answer).all() for answer in answers):
                break
        else:
            message = (
                f"{MOST_DRAWS} causes drawn from the priors are impossible for the tyre: state smaller uncertainties"
            )
            raise InputError(message, field="uncertainty", file=self.study.file)
        means = [origin.corrected(number, answer) for number, answer in enumerate(answers)]
        runs = [
            drive_of_means(drive, mean + np.concatenate([sensor.scatter(rng) for sensor in drive.sensors]))
            for drive, mean in zip(known.drives, means, strict=True)
        ]
        return cause, replace(origin, runs=tuple(runs))


def fitted_case(layout: FittedLayout, evaluations: Evaluations, number: int) -> QuickCase:
    """Draw a cause, simulate its readings, and judge them by the ranking of a diagnosis."""
    rng = np.random.default_rng([layout.seed, number])
    cause, residuals = layout.drawn_residuals(evaluations, rng)
    candidates, _ = layout.competing
    predictions = Predictions(evaluations, [response.modes for response in layout.known.responses])
    ranking = rank(residuals, predictions, candidates, Method(settings=SETTINGS), lambda _: None)
    return judged_case(layout.linear, cause, ranking.judgement, ranking.fit_of, rng)


def _row(layout: FittedLayout, number: int) -> dict[str, Any]:
    with evaluating(ForwardModel(layout.study, layout.known.drives, settings=SETTINGS)) as evaluations:
        row: dict[str, Any] = jsonable(asdict(fitted_case(layout, evaluations, number)))
    return row


def fitted_tag(study: StudyData, seed: int) -> str:
    """Begin of the names of the files of fitted cases; they depend on the study, the seed and the version."""
    return tag_for(["fitted", study_digest(study), seed, tyrefem.__version__])


def fitted_cases(
    study: StudyData,
    known: Sensitivities,
    count: int,
    seed: int,
    folder: Path,
    workers: int = 1,
    tick: Callable[[int], None] | None = None,
) -> tuple[QuickCase, ...]:
    """``count`` fitted cases of the planned runs of a study, in parallel; finished ones are kept in ``folder``.

    Cases in the folder with the same study, seed and version are not run again; case n depends on the seed and n only.
    """
    tag = fitted_tag(study, seed)
    rows = kept_cases(folder, tag)
    left = [number for number in range(count) if number not in rows]
    check_effort(ForwardModel(study, known.drives, settings=SETTINGS), f"{len(left)} cases", len(left) * CASE, workers)
    with resuming(rows, count):
        keep_cases(rows, computed_cases(_row, FittedLayout(study, known, seed), left, workers), folder, tag, tick)
    return tuple(QuickCase.of_row(rows[number]) for number in range(count))
