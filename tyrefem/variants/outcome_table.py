"""Outcomes of many variants by number, packed in blocks: some hundred bytes for a variant, or less."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache
from tyrefem.variants.blocks import Columns, Numbers, OutcomeBlock, PackedOutcomes, packed
from tyrefem.variants.outcomes import Answered, Failed, Outcome

#: Blocks that are kept unpacked.
UNPACKED = 8
#: In place of a block's place: no outcome, or one that is in no block.
NONE, SINGLE = -1, -2


@dataclass(frozen=True, eq=False)
class OutcomeColumns:
    """Some answers of some variants, in columns.

    Parameters
    ----------
    answers : name -> values (n,), of floats, or of objects with NaN where a variant has none. by : ``full``,
        ``reduced``, or empty for a failure. errors : estimated errors, K; NaN: none. failures : reasons, or empty.
    """

    answers: Mapping[str, NDArray[Any]]
    by: NDArray[Any]
    errors: NDArray[np.float64]
    failures: NDArray[Any]


class OutcomeTable(Mapping[int, Outcome]):
    """Outcomes by number, in the order of the numbers.

    Memory: four bytes for every variant, and its share of a block, which may stay on disk; see `OutcomeBlock`.

    >>> table = OutcomeTable()
    >>> table.update({n: Answered({"hottest_degC": 50.0 + n}) for n in range(100)})
    >>> len(table), table[7].answers, 100 in table
    (100, {'hottest_degC': 57.0}, False)
    """

    def __init__(self, outcomes: Mapping[int, Outcome] | None = None) -> None:
        self._blocks: list[OutcomeBlock] = []
        self._singles: dict[int, Outcome] = {}
        self._place = np.full(64, NONE, dtype=np.int32)
        self._count = 0
        self._unpacked: Cache[Columns] = Cache(UNPACKED)
        if outcomes:
            self.update(outcomes)

    def __len__(self) -> int:
        return self._count

    def __iter__(self) -> Iterator[int]:
        return iter(self.numbers.tolist())

    def __contains__(self, number: object) -> bool:
        return isinstance(number, int) and 0 <= number < len(self._place) and bool(self._place[number] != NONE)

    def __getitem__(self, number: int) -> Outcome:
        if number not in self:
            raise KeyError(number)
        place = int(self._place[number])
        if place == SINGLE:
            return self._singles[number]
        block = self._blocks[place]
        return block.outcome(self._columns(place), int(np.searchsorted(block.numbers, number)))

    @property
    def numbers(self) -> Numbers:
        """Numbers of all variants that have an outcome, increasing."""
        return np.flatnonzero(self._place != NONE)

    def without(self, numbers: Numbers) -> Numbers:
        """Those of some numbers that have no outcome."""
        inside = numbers < len(self._place)
        known = np.zeros(len(numbers), dtype=np.bool_)
        known[inside] = self._place[numbers[inside]] != NONE
        return numbers[~known]

    def new(self, outcomes: Mapping[int, Outcome] | PackedOutcomes) -> PackedOutcomes:
        """The outcomes of variants that have none yet, packed."""
        if not isinstance(outcomes, PackedOutcomes):
            return packed({number: outcome for number, outcome in outcomes.items() if number not in self})
        singles = {number: outcome for number, outcome in outcomes.singles.items() if number not in self}
        blocks = [block for block in outcomes.blocks if len(self.without(block.numbers)) == len(block.numbers)]
        return PackedOutcomes(blocks, singles)

    def update(self, outcomes: Mapping[int, Outcome] | PackedOutcomes) -> None:
        """Add outcomes; a second outcome of the same variant is ignored, also a block with such a variant."""
        new = self.new(outcomes)
        for block in new.blocks:
            self.add(block)
        for number, outcome in new.singles.items():
            self._mark(np.array([number]), SINGLE)
            self._singles[number] = outcome

    def add(self, block: OutcomeBlock) -> None:
        """Add a block of variants without outcomes."""
        self._blocks.append(block)
        self._mark(block.numbers, len(self._blocks) - 1)

    def _mark(self, numbers: Numbers, place: int) -> None:
        most = int(numbers[-1]) + 1
        if most > len(self._place):
            grown = np.full(max(most, 2 * len(self._place)), NONE, dtype=np.int32)
            grown[: len(self._place)] = self._place
            self._place = grown
        self._place[numbers] = place
        self._count += len(numbers)

    def _columns(self, place: int) -> Columns:
        return self._unpacked.get(place, lambda: self._blocks[place].columns)

    @property
    def names(self) -> list[str]:
        """Names of all answers, in the order of the variants."""
        firsts = [(int(block.numbers[0]), block.names) for block in self._blocks]
        firsts += [(n, tuple(outcome.answers)) for n, outcome in self._singles.items() if isinstance(outcome, Answered)]
        return list(dict.fromkeys(name for _, names in sorted(firsts) for name in names))

    @property
    def other_than_floats(self) -> set[str]:
        """Names of the answers that are texts, or other values than floats, in any variant."""
        names = {name for block in self._blocks for name in block.texts}
        singles = (outcome.answers for outcome in self._singles.values() if isinstance(outcome, Answered))
        return names | {name for answers in singles for name, value in answers.items() if not isinstance(value, float)}

    @property
    def failed(self) -> dict[int, Failed]:
        """The failures, by number."""
        return {n: outcome for n, outcome in sorted(self._singles.items()) if isinstance(outcome, Failed)}

    @property
    def reduced(self) -> int:
        """Number of variants that a reduced model answered."""
        singles = sum(isinstance(each, Answered) and each.by == "reduced" for each in self._singles.values())
        return singles + sum(len(block.numbers) for block in self._blocks if block.by == "reduced")

    def columns(self, numbers: Numbers, names: Sequence[str]) -> OutcomeColumns:
        """Some answers of some variants (increasing numbers), block by block."""
        count = len(numbers)
        answers: dict[str, NDArray[Any]] = {name: np.full(count, math.nan) for name in names}
        by, failures = np.full(count, "", dtype=object), np.full(count, "", dtype=object)
        errors = np.full(count, math.nan)
        places = self._place[numbers]
        order = np.argsort(places, kind="stable")
        for rows in np.split(order, np.flatnonzero(np.diff(places[order])) + 1):
            place = int(places[rows[0]]) if len(rows) else NONE
            if place < 0:
                continue
            block, columns = self._blocks[place], self._columns(place)
            inside = np.searchsorted(block.numbers, numbers[rows])
            by[rows], errors[rows] = block.by, columns.errors[inside]
            for row, name in enumerate(block.names):
                if name not in answers:
                    continue
                values: NDArray[Any] = columns.values[row, inside]
                if name in columns.texts:
                    values = np.array(columns.texts[name], dtype=object)[values.astype(np.intp)]
                    answers[name] = answers[name].astype(object, copy=False)
                answers[name][rows] = values
        for row in np.flatnonzero(places == SINGLE).tolist():
            outcome = self._singles[int(numbers[row])]
            if isinstance(outcome, Failed):
                failures[row] = outcome.reason
                continue
            by[row], errors[row] = outcome.by, math.nan if outcome.error is None else outcome.error
            for name, value in outcome.answers.items():
                if name in answers:
                    if not isinstance(value, float):
                        answers[name] = answers[name].astype(object, copy=False)
                    answers[name][row] = value
        return OutcomeColumns(answers, by, errors, failures)
