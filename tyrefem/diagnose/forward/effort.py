"""Memory and time of a diagnosis, estimated before its first simulation."""

from __future__ import annotations

from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.estimates import work as estimate
from tyrefem.simulation.estimate import RunEstimate

#: Cost of a diagnosis per measured run: runs on the fit's mesh, runs on the study's mesh, strain cycles by finite
#: elements (hidden-effect: 55 s of one processor for four runs; passenger-205-55r16 at 6 mm: 120 s for one run).
FITTED, STUDY_MESH, CYCLES = 40.0, 2.0, 15.0
#: Cost in diagnoses: the sensitivities; a blind case with its data; one whose data differ from the study in structure.
SENSITIVITIES, CASE, STRUCTURAL_CASE = 0.4, 0.6, 3.0


def check_effort(model: ForwardModel, what: str, share: float, workers: int = 1) -> None:
    """Refuse simulations that do not fit in memory, and warn of long work.

    Parameters
    ----------
    what : the work that is about to begin. share : its cost in diagnoses: 1, `SENSITIVITIES`, or multiples of a case's.

    Raises
    ------
    InputError : as `RunEstimate.check`.
    """
    runs: list[tuple[RunEstimate, float]] = []
    side_by_side = max(min(workers, len(model.drives)), 1)
    for number in range(len(model.drives)):
        full, fitted = (RunEstimate.of(model.driven(study, number)) for study in (model.study, model.coarse))
        full.check(side_by_side)
        temperatures = FITTED * fitted.transient_run.time + STUDY_MESH * full.transient_run.time
        runs.append((full, temperatures))
    scale = share / max(workers, 1)
    heat = sum(temperatures for _, temperatures in runs)
    cycles = CYCLES * sum(full.mechanics.time for full, _ in runs)

    def quick_look() -> str:
        full = runs[0][0]
        part = cycles / full.mechanics.time if full.mechanics.time else 0.0
        return full.quick_look(lambda run: scale * (heat + part * run.mechanics.time))

    estimate.warn_if_long(scale * (heat + cycles), what, quick_look)
