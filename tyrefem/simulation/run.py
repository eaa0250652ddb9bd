from __future__ import annotations

from collections.abc import Callable

from tyrefem.inputs.study import StudyData
from tyrefem.simulation.estimate import RunEstimate
from tyrefem.simulation.result import ResultData
from tyrefem.simulation.rolling_tyre import Array, RollingTyre
from tyrefem.simulation.simulate import simulate, simulated_readings
from tyrefem.threads import one_thread


@one_thread()
def run(
    study: StudyData,
    progress: Callable[[float], None] | None = None,
    like: RollingTyre | None = None,
    *,
    partial: bool = False,
) -> ResultData:
    """Simulate a study's drive. With ``mechanics.feedback``: `tyrefem.simulation.feedback.run`.

    Parameters
    ----------
    progress : called with the time (s) after every step. like : see `RollingTyre`.
    partial : return the finished part after Ctrl-C (`tyrefem.conduction.Conduction.transient`); else raise it.

    For a campaign, the base drive is simulated, with a warning; `Campaign.runs` runs its cases.

    Raises
    ------
    InputError : more than there is memory for.
    """
    if like is None:
        RunEstimate.of(study).check()
    if study.card.mechanics.feedback is not None:
        from tyrefem.simulation import feedback

        return feedback.run(study, progress, like, partial=partial)
    return simulate(RollingTyre(study, like), progress, partial=partial)


@one_thread()
def run_readings(study: StudyData) -> dict[str, Array]:
    """The columns of a run's readings (`ResultData.reading_columns`), s and degC, in four fifths of its time.

    The heat budget and the hottest points, which nobody reads here, are left out.

    Raises
    ------
    InputError : more than there is memory for.
    """
    if study.card.mechanics.feedback is not None:
        return run(study).reading_columns
    RunEstimate.of(study).check()
    return simulated_readings(RollingTyre(study))
