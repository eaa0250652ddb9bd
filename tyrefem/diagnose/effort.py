"""What a diagnosis will take, before its first simulation: refused if it does not fit, warned of if it is long."""

from __future__ import annotations

from tyrefem.diagnose.forward_model import ForwardModel
from tyrefem.estimates import work as estimate
from tyrefem.simulation.estimate import RunEstimate

#: Runs on the fit's mesh, on the study's own, and strain cycles by finite elements that a diagnosis costs per measured
#: run (hidden-effect: 55 s of a processor for four runs; passenger-205-55r16 at 6 mm: 120 s for one).
FITTED, OWN, CYCLES = 40.0, 2.0, 15.0
#: Of a diagnosis: what its sensitivities take, and a blind case with its data.
SENSITIVITIES, CASE = 0.4, 0.6


def check_effort(model: ForwardModel, what: str, share: float, workers: int = 1) -> None:
    """Refuse simulations that do not fit in memory, and warn of long work.

    Parameters
    ----------
    what : is about to begin. share : how much of a diagnosis it takes: 1, `SENSITIVITIES`, `CASE` so many times.

    Raises
    ------
    InputError : as `RunEstimate.check`.
    """
    seconds = 0.0
    side_by_side = max(min(workers, len(model.drives)), 1)
    for number in range(len(model.drives)):
        full, fitted = (RunEstimate.of(model.driven(study, number)) for study in (model.study, model.coarse))
        full.check(side_by_side)
        seconds += FITTED * fitted.transient_run.time + OWN * full.transient_run.time + CYCLES * full.mechanics.time
    estimate.warn_if_long(seconds * share / max(workers, 1), what)
