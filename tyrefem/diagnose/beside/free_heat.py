"""Heat of unknown origin by itself: whether it explains what effects are about to be named for."""

from __future__ import annotations

import math
from dataclasses import dataclass

from tyrefem.brief import Brief
from tyrefem.diagnose.beside.discrepancy import missing_heat_beside, missing_patches
from tyrefem.diagnose.fitting.fits import continued, first_fits
from tyrefem.diagnose.fitting.selection import SelectionProblem
from tyrefem.diagnose.heat.missing_heat import pursuit

#: Noise explains the misfit of the heat from this probability on.
USUAL_P = 0.01


@dataclass(frozen=True)
class FreeHeat(Brief):
    """Sources of unknown origin without effects, fitted with the full model.

    ``p_value``: probability of their misfit. ``lead``: ln evidence by which the effects, beside the most probable of
    all that else may be wrong, explain the data better, nats; infinite if the misfit is too large for a comparison.
    """

    p_value: float
    lead: float

    def _title(self) -> str:
        return f"p = {self.p_value:.2g}, effects lead by {self.lead:.0f} nats"

    def explains(self, least_lead: float) -> bool:
        """Whether noise explains what the heat leaves, and the effects lead by less than this, nats."""
        return self.p_value >= USUAL_P and self.lead < least_lead


def free_heat(problem: SelectionProblem, size: float, log_evidence: float) -> FreeHeat | None:
    """Sources of unknown origin by themselves; None without patches of missing heat.

    Up to three patches (`pursuit`) are fitted with the full model, as a strong source is not linear. The others, and a
    part for each run, are linear. Their prior is that of a source as expected: one several times as strong is less
    plausible than an effect that it imitates.

    Parameters
    ----------
    size : K, of errors of the readings that neighbours in time share, as beside the effects.
    log_evidence : of the effects beside the most probable discrepancy model.
    """
    residuals, predictions = problem.residuals, problem.predictions
    patches = missing_patches(residuals)
    if not patches:
        return None
    sources = pursuit(residuals, patches)
    heat = missing_heat_beside(residuals, sources, 1.0, size)
    here = residuals.beside(heat.nuisance, heat.shared_error, heat.offset)
    (first,) = first_fits(here, predictions, [()], None, problem._count)
    if not first.worth_settling and not first.settled:
        # No further step can explain such a misfit.
        return FreeHeat(first.p_value, math.inf)
    (alone,) = continued(here, predictions, [first], problem._count)
    alone = max(alone, first, key=lambda fit: fit.log_evidence)
    return FreeHeat(alone.p_value, log_evidence - alone.log_evidence)
