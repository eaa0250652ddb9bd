"""Heat of unknown origin as an alternative to all sets of effects."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from tyrefem.brief import Brief
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.fitting.criterion import Criterion
from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.heat.missing_heat import UnknownHeat, missing_heat
from tyrefem.diagnose.unknowns.heat_patches import patches
from tyrefem.diagnose.unknowns.unknown import Unknown


@dataclass(frozen=True, eq=False)
class UnknownOrigin(Brief):
    """Heat of unknown origin as an alternative to all sets of effects; ``prior``: ln of its prior probability."""

    residuals: Residuals
    criterion: Criterion
    prior: float

    @cached_property
    def patches(self) -> tuple[Unknown, ...]:
        """Patches of heat and flux."""
        return patches(self.residuals.study, self.residuals.settings)

    def of(self, null: FittedSet) -> UnknownHeat:
        """The heat, estimated in the linear model about the fit of no effect."""
        return missing_heat(self.residuals, self.patches, null)

    def score(self, null: FittedSet, heat: UnknownHeat) -> float:
        """ln(prior) + criterion of no effect + gain of ln evidence by the heat."""
        return self.prior + self.criterion.of_fit(null) + (heat.log_evidence - null.log_evidence)
