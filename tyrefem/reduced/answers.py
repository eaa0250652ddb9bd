"""Answers of studies by a reduced model: what can be marched together is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.reduced.balance import ReducedBalance, reduced_balance
from tyrefem.reduced.batch import Batch
from tyrefem.reduced.exponential import Marched
from tyrefem.reduced.march import march
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.readout import Readout
from tyrefem.reduced.variant import Variant
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.simulate import output_times
from tyrefem.variants.answers import answers
from tyrefem.variants.outcomes import Answered, Failed, NotReducible

ReducedOutcome = Answered | Failed | NotReducible
#: Variants marched side by side.
SIDE_BY_SIDE = 32
#: K, of the reduced model's time integration; see `Batch`.
TIME_TOLERANCE = 0.2


def reduced_answers(model: ReducedModel, studies: Sequence[StudyData], time_to: float | None) -> list[ReducedOutcome]:
    """What becomes of every study, in their order."""
    outcomes: dict[int, ReducedOutcome] = {}
    for number, outcome in reduced_outcomes(model, studies):
        if isinstance(outcome, Variant):
            outcomes[number] = Answered(answers(outcome, time_to), "reduced")
        else:
            outcomes[number] = outcome
    return [outcomes[number] for number in range(len(studies))]


def reduced_outcomes(
    model: ReducedModel, studies: Sequence[StudyData], tolerance: float = TIME_TOLERANCE
) -> Iterator[tuple[int, Variant | Failed | NotReducible]]:
    """(number, variant) of every study, marched side by side; `Failed` or `NotReducible` in place of a variant.

    Parameters
    ----------
    tolerance : K, of time integration.
    """
    yield from outcomes_of(model, [RollingTyre(study, model.base) for study in studies], tolerance)


def outcomes_of(
    model: ReducedModel, tyres: Sequence[RollingTyre], tolerance: float = TIME_TOLERANCE
) -> Iterator[tuple[int, Variant | Failed | NotReducible]]:
    """The same of tyres on the model's mesh."""
    for numbers, part in side_by_side(model, tyres, tolerance):
        if isinstance(part, Failed | NotReducible):
            yield numbers[0], part
            continue
        readout = Readout(part, output_times(part.batch.balances[0].tyre)[0])
        for place, number in enumerate(numbers):
            yield number, Variant(readout, place)


def side_by_side(
    model: ReducedModel, tyres: Sequence[RollingTyre], tolerance: float = TIME_TOLERANCE, most: int = SIDE_BY_SIDE
) -> Iterator[tuple[list[int], Marched | Failed | NotReducible]]:
    """Tyres marched together where their drives allow it, ``most`` at a time: (their numbers, the march).

    Or ([a number], `Failed`) of a tyre that cannot be, ([a number], `NotReducible`) of one that the model cannot
    follow.
    """
    groups: dict[Any, list[tuple[int, ReducedBalance]]] = {}
    for number, tyre in enumerate(tyres):
        try:
            balance = reduced_balance(model, tyre)
        except NotReducibleError as error:
            yield [number], NotReducible(str(error))
        except InputError as error:
            yield [number], Failed(str(error))
        else:
            output = tyre.study.card.output
            key = tyre.drive.starts, tyre.drive.end, tyre.schedule.knots, balance.layout, output.every, output.fields
            groups.setdefault(key, []).append((number, balance))
    for members in groups.values():
        for first in range(0, len(members), most):
            part = members[first : first + most]
            yield [number for number, _ in part], march(Batch(model, [balance for _, balance in part], tolerance))
