"""Blocks: the outcomes of several variants, packed column by column."""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.variants.outcomes import Answered, Outcome

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]
#: A block has at least and at most so many outcomes.
LEAST, MOST = 2, 512


@dataclass(frozen=True, eq=False)
class Columns:
    """The unpacked content of a block.

    Parameters
    ----------
    values : answers, (n_names, n); a text is its place in ``texts``. errors : estimated errors (n,), K; NaN: none.
    texts : answer -> its different texts.
    """

    values: Array
    errors: Array
    texts: Mapping[str, Sequence[str]]


@dataclass(frozen=True, eq=False)
class OutcomeBlock:
    """Outcomes with the same answers, computed in the same way.

    Floats are stored to the last bit: all first bytes of a column, all second bytes, and so on, then compressed by
    zlib, whose checksum detects damage.

    Parameters
    ----------
    numbers : of the variants, (n,), increasing. names : of the answers. texts : those of the names that are texts.
    by : see `Answered`. content : the packed columns, or a function that reads them.
    """

    numbers: Numbers
    names: tuple[str, ...]
    texts: tuple[str, ...]
    by: Literal["full", "reduced"]
    content: bytes | Callable[[], bytes]

    @property
    def columns(self) -> Columns:
        """The unpacked content.

        Raises
        ------
        InputError : its file is damaged, or gone.
        """
        rows, count = len(self.names) + 1, len(self.numbers)
        try:
            content = self.content if isinstance(self.content, bytes) else self.content()
            texts, _, data = zlib.decompress(content).partition(b"\n")
            shuffled = np.frombuffer(data, dtype=np.uint8).reshape(rows, 8, count)
            values = np.ascontiguousarray(shuffled.transpose(0, 2, 1)).view("<f8")[..., 0]
            return Columns(values[:-1], values[-1], json.loads(texts))
        except InputError:
            raise
        except (zlib.error, ValueError):
            message = "a record of finished variants is damaged; delete them with --restart"
            raise InputError(message, file=getattr(self.content, "path", None)) from None

    def numbered(self, numbers: Numbers) -> OutcomeBlock:
        """The block with other numbers of its variants."""
        return replace(self, numbers=np.asarray(numbers)[self.numbers])

    def outcome(self, columns: Columns, place: int) -> Answered:
        """The outcome of the variant at a place of the block."""
        values = dict(zip(self.names, columns.values[:, place].tolist(), strict=True))
        answers = values | {name: texts[int(values[name])] for name, texts in columns.texts.items()}
        error = float(columns.errors[place])
        return Answered(answers, self.by, None if math.isnan(error) else error)


@dataclass(frozen=True, eq=False)
class PackedOutcomes:
    """Outcomes in blocks, and single ones: failures, values that are neither floats nor texts, and a few outcomes."""

    blocks: Sequence[OutcomeBlock]
    singles: Mapping[int, Outcome]

    def numbered(self, numbers: Numbers) -> PackedOutcomes:
        """The outcomes with other numbers of their variants."""
        singles = {int(numbers[number]): outcome for number, outcome in self.singles.items()}
        return PackedOutcomes([block.numbered(numbers) for block in self.blocks], singles)


def packed(outcomes: Mapping[int, Outcome]) -> PackedOutcomes:
    """Outcomes in blocks, where that is possible and worth it.

    >>> outcomes = packed({n: Answered({"hottest_degC": 50.0 + n, "region": "tread"}) for n in range(8)})
    >>> block, = outcomes.blocks
    >>> block.outcome(block.columns, 3).answers, outcomes.singles
    ({'hottest_degC': 53.0, 'region': 'tread'}, {})
    """
    alike: dict[Any, list[int]] = {}
    for number in sorted(outcomes):
        kind = _kind(outcomes[number])
        if kind is not None:
            alike.setdefault(kind, []).append(number)
    blocks = [_block(outcomes, part) for part in _parts(alike.values())]
    inside = {int(number) for block in blocks for number in block.numbers}
    return PackedOutcomes(blocks, {number: outcome for number, outcome in outcomes.items() if number not in inside})


def _parts(groups: Any) -> Iterator[list[int]]:
    for members in groups:
        for first in range(0, len(members), MOST):
            part = members[first : first + MOST]
            if len(part) >= LEAST:
                yield part


def _kind(outcome: Outcome) -> Any:
    """What outcomes in one block have in common; None: not for a block."""
    if not isinstance(outcome, Answered) or outcome.error != outcome.error:
        return None
    kinds = tuple(type(value) for value in outcome.answers.values())
    if not all(issubclass(kind, float | str) for kind in kinds):
        return None
    return outcome.by, tuple(outcome.answers), tuple(issubclass(kind, str) for kind in kinds)


def _block(outcomes: Mapping[int, Outcome], numbers: Sequence[int]) -> OutcomeBlock:
    rows: list[Answered] = [outcomes[number] for number in numbers]  # type: ignore[misc]
    names = tuple(rows[0].answers)
    texts: dict[str, list[str]] = {}
    values = np.empty((len(names) + 1, len(rows)), dtype="<f8")
    for place, name in enumerate(names):
        column = [row.answers[name] for row in rows]
        if isinstance(column[0], str):
            texts[name] = list(dict.fromkeys(column))
            places = {text: place_of for place_of, text in enumerate(texts[name])}
            column = [places[text] for text in column]
        values[place] = column
    values[-1] = [math.nan if row.error is None else row.error for row in rows]
    shuffled = values.view(np.uint8).reshape(len(values), len(rows), 8).transpose(0, 2, 1)
    content = zlib.compress(json.dumps(texts).encode() + b"\n" + shuffled.tobytes(), 1)
    return OutcomeBlock(np.array(numbers, dtype=np.intp), names, tuple(texts), rows[0].by, content)
