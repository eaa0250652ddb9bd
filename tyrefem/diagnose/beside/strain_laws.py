"""Sets of effects ranked beside every other strain law that the study can run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tyrefem.diagnose.beside.discrepancy import beside_law
from tyrefem.diagnose.beside.ranked_beside import RankedBeside
from tyrefem.diagnose.beside.ranking import under
from tyrefem.diagnose.beside.robustness import Robustness
from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.fitting.selection import SelectionProblem
from tyrefem.mechanics.strain_laws import strain_laws


def beside_strain_laws(problem: SelectionProblem, robust: Robustness, fits: Sequence[FittedSet]) -> Robustness:
    """The sets of some fits, and those with one effect more or less, ranked again beside every other strain law.

    The fits are without a discrepancy. A law that the study cannot run, or that needs further inputs, is not tried; one
    that presses the tyre on the road does so in linear motion.
    """
    residuals, evaluations = problem.residuals, problem.predictions.evaluations
    largest = max([fit.members for fit in fits], key=len)
    named = problem.ordered(largest)
    numbers = range(len(residuals.runs))
    tried, untried = [], []
    for name, law in strain_laws().items():
        if name == residuals.study.card.mechanics.strain or not law.compared:
            continue
        answers = evaluations.of("change_by_law", [(number, name) for number in numbers])
        if not all(np.isfinite(change).all() for change in answers):
            untried.append(name)
            continue
        beside = RankedBeside(problem, beside_law(residuals, name, answers), named)
        beside.begin({problem.ordered(fit.members): fit for fit in fits})
        if beside.near:
            beside.further()
        law_sets = under(beside.discrepancy, beside.residuals, beside.scored())
        tried.append(replace(law_sets, probability=math.nan))
    return replace(robust, laws=tuple(tried), untried=tuple(untried))
