"""Answers of studies by a reduced model; variants with the same drive are integrated as one batch."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.reduced.balance import ReducedBalance, reduced_balance
from tyrefem.reduced.batch import Batch
from tyrefem.reduced.integration import integrate
from tyrefem.reduced.learnt_balance import learnt_balances
from tyrefem.reduced.model import NotReducibleError, ReducedModel
from tyrefem.reduced.readout import Readout
from tyrefem.reduced.sampled_source import HOT
from tyrefem.reduced.shaped_model import fill
from tyrefem.reduced.solution import BatchSolution
from tyrefem.reduced.variant import Variant
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.simulate import output_times
from tyrefem.variants.answers import answers
from tyrefem.variants.outcomes import Answered, Failed, NotReducible

ReducedOutcome = Answered | Failed | NotReducible
#: Variants integrated in one batch, at most.
BATCH_SIZE = 32
#: K, of the reduced model's time integration; see `Batch`.
TIME_TOLERANCE = 0.2


def reduced_answers(model: ReducedModel, studies: Sequence[StudyData], time_to: float | None) -> list[ReducedOutcome]:
    """The outcome of every study, in the order of the studies."""
    outcomes = {number: _outcome(outcome, time_to) for number, outcome in reduced_outcomes(model, studies)}
    return [outcomes[number] for number in range(len(studies))]


def _outcome(variant: Variant | Failed | NotReducible, time_to: float | None) -> ReducedOutcome:
    if not isinstance(variant, Variant):
        return variant
    return Answered(answers(variant, time_to, variant.input_answers), "reduced", variant.estimated_error)


def reduced_outcomes(
    model: ReducedModel, studies: Sequence[StudyData], tolerance: float = TIME_TOLERANCE
) -> Iterator[tuple[int, Variant | Failed | NotReducible]]:
    """Yield (number, variant) of every study; `Failed` or `NotReducible` in place of the variant.

    Parameters
    ----------
    tolerance : K, of time integration.
    """
    yield from outcomes_of(model, [model.tyre(study) for study in studies], tolerance)


def outcomes_of(
    model: ReducedModel, tyres: Sequence[RollingTyre], tolerance: float = TIME_TOLERANCE
) -> Iterator[tuple[int, Variant | Failed | NotReducible]]:
    """Yield (number, variant) of every tyre on the model's mesh, as `reduced_outcomes`."""
    yield from _variants(batch_solutions(model, tyres, tolerance))


def learnt_outcomes(
    model: ReducedModel, changes: Sequence[Mapping[str, Any]], time_to: float | None
) -> list[ReducedOutcome] | None:
    """The outcome of every variant, given by its changes, with learnt inputs; None: these do not hold for them all."""
    balances = learnt_balances(model, changes)
    if balances is None:
        return None
    solutions = balance_solutions(model, list(enumerate(balances)), TIME_TOLERANCE, BATCH_SIZE)
    outcomes = {number: _outcome(outcome, time_to) for number, outcome in _variants(solutions)}
    return [outcomes[number] for number in range(len(changes))]


def _variants(
    solutions: Iterator[tuple[list[int], BatchSolution | Failed | NotReducible]],
) -> Iterator[tuple[int, Variant | Failed | NotReducible]]:
    for numbers, part in solutions:
        if isinstance(part, Failed | NotReducible):
            yield numbers[0], part
            continue
        readout = Readout(part, output_times(part.batch.balances[0].alike)[0])
        for place, number in enumerate(numbers):
            hottest = readout.peaks[place]["tyre"].temperature
            if hottest > HOT:
                why = f"the table of tan delta ends at {HOT:g} degC, and its hottest point has {hottest:.0f} degC"
                yield number, NotReducible(why)
            else:
                yield number, Variant(readout, place)


def batch_solutions(
    model: ReducedModel, tyres: Sequence[RollingTyre], tolerance: float = TIME_TOLERANCE, most: int = BATCH_SIZE
) -> Iterator[tuple[list[int], BatchSolution | Failed | NotReducible]]:
    """Yield (numbers, solution) of batches of at most ``most`` tyres whose drives have the same times.

    A tyre that cannot be built gives ([number], `Failed`). A tyre that the model cannot represent gives ([number],
    `NotReducible`).
    """
    balances: list[tuple[int, ReducedBalance]] = []
    for number, tyre in enumerate(tyres):
        try:
            balance = reduced_balance(model, tyre)
        except NotReducibleError as error:
            yield [number], NotReducible(str(error))
        except InputError as error:
            yield [number], Failed(str(error))
        else:
            balances.append((number, balance))
    yield from balance_solutions(model, balances, tolerance, most)


def balance_solutions(
    model: ReducedModel, balances: Sequence[tuple[int, ReducedBalance]], tolerance: float, most: int
) -> Iterator[tuple[list[int], BatchSolution]]:
    """Yield (numbers, solution) of batches of at most ``most`` numbered balances whose drives have the same times."""
    groups: dict[Any, list[tuple[int, ReducedBalance]]] = {}
    for number, balance in balances:
        tyre = balance.alike
        output = tyre.study.card.output
        key = tyre.drive.starts, tyre.drive.end, tyre.schedule.knots, balance.layout, output.every, output.fields
        groups.setdefault(key, []).append((number, balance))
    for members in groups.values():
        for first in range(0, len(members), most):
            part = members[first : first + most]
            fill([balance.model for _, balance in part])
            yield [number for number, _ in part], integrate(Batch(model, [balance for _, balance in part], tolerance))
