"""A plan: a study, its varied numbers, and all variants; checked before anything runs."""

from __future__ import annotations

import functools
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.uncertain_numbers import left_out
from tyrefem.mechanics.cycle_schedule import check_cases
from tyrefem.quantity import written
from tyrefem.variants.answers import check_answer
from tyrefem.variants.card import LimitCard, SweepCard, VaryCard
from tyrefem.variants.samples import check_distinct, drawn, grid, listed, size_of
from tyrefem.variants.task import Bundle, Task, bundle
from tyrefem.variants.varied import Varied, uncertain, varied


@dataclass(frozen=True, eq=False)
class Plan:
    """The variants of a study.

    Parameters
    ----------
    study : the study. varied : the varied numbers; empty if the variants come from a list. variants : changes of each.
    names : of the variants. limits : answer -> its limits. time_to : see `answers`. sampling : description of the
        sample, for the record.
    """

    study: StudyData
    varied: tuple[Varied, ...]
    variants: tuple[Mapping[str, Any], ...]
    names: tuple[str, ...]
    limits: Mapping[str, LimitCard]
    time_to: float | None
    sampling: Mapping[str, Any]

    @functools.cached_property
    def packed(self) -> Bundle:
        """The study packed for workers."""
        return bundle(self.study)

    @functools.cached_property
    def digest(self) -> str:
        """Digest of the study, its files, and all variants in their order."""
        text = json.dumps([self.packed.digest, list(self.variants), self.time_to], sort_keys=True, default=str)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    @property
    def keys(self) -> list[str]:
        """Dotted names that the variants change, in order."""
        return list(dict.fromkeys(key for variant in self.variants for key in variant))

    def task(self, number: int) -> Task:
        """The task of a variant."""
        return Task(number, self.packed, self.variants[number], self.time_to)

    def row(self, number: int) -> dict[str, Any]:
        """A variant's name and values, as a row of a table."""
        by_key, changes = {varied_number.key: varied_number for varied_number in self.varied}, self.variants[number]
        beside = {key for varied_number in self.varied for key, _ in varied_number.also}
        shown = {
            (by_key[key].heading if key in by_key else key): (by_key[key].of(value) if key in by_key else value)
            for key, value in changes.items()
            if key not in beside
        }
        return {"variant": self.names[number], **shown}


def planned(study: StudyData, card: SweepCard, near: Path | None = None) -> Plan:
    """The plan of a sweep file.

    Raises
    ------
    InputError : a name that the study does not have, a value that it refuses, two equal variants, or more variants
        than fit in memory.
    """
    for name in (*card.limits, *card.answers, *card.pareto):
        try:
            check_answer(name, study, card.time_to)
        except InputError as error:
            table = next(part for part in ("limits", "answers", "pareto") if name in getattr(card, part))
            raise error.within(field=table) from None
    names: Sequence[str]
    if card.chosen == "list":
        assert card.cases is not None
        path = (near or Path()) / card.cases
        variants, names = listed(path)
        chosen: tuple[Varied, ...] = ()
        try:
            check_changes(study, [(f"variant '{name}'", part) for name, part in zip(names, variants, strict=True)])
        except InputError as error:
            raise error if error.file else error.within(file=path) from None
    else:
        chosen = tuple(varied(study, key, part) for key, part in _outer_keys_first(card.vary).items())
        if card.uncertain is not None:
            chosen += _not_varied_otherwise(chosen, uncertain(study, card.uncertain))
        if card.sampled:
            size_of(chosen, card.chosen, card.count)
        check_changes(study, [("", part.changes(value)) for part in chosen for value in part.ends])
        if not card.sampled:
            variants = []
        elif card.chosen == "grid":
            variants = grid(chosen)
        else:
            assert card.count is not None
            variants = drawn(chosen, card.chosen, card.count, card.seed)
        names = [str(number + 1) for number in range(len(variants))]
        if card.chosen != "saltelli":
            check_distinct(variants, names)
    seed = card.seed if card.chosen in ("latin-hypercube", "sobol", "saltelli") else None
    sampling: dict[str, Any] = {"sample": card.chosen if card.sampled else None, "count": len(variants), "seed": seed}
    if card.uncertain is not None:
        also = {part.key: [key for key, _ in part.also] for part in chosen if part.also}
        sampling |= {"uncertain": card.uncertain, "also": also, "left_out": left_out(study.uncertain_numbers)}
    return Plan(study, chosen, tuple(variants), tuple(names), dict(card.limits), card.time_to, sampling)


def _not_varied_otherwise(chosen: Sequence[Varied], numbers: Sequence[Varied]) -> tuple[Varied, ...]:
    """The uncertain numbers that are not in ``chosen``.

    Raises
    ------
    InputError : the card of an uncertain number varies as a whole.
    """
    named = {number.key for number in chosen}
    beside = tuple(number for number in numbers if not named & {number.key, *(key for key, _ in number.also)})
    for number in beside:
        for key in (number.key, *(key for key, _ in number.also)):
            outer = next((name for name in named if key.startswith(f"{name}.")), None)
            if outer is not None:
                message = f"'{outer}' varies as a whole, so its number '{key}' has no single value to vary about"
                raise InputError(message, field="uncertain")
    return beside


def _outer_keys_first(vary: Mapping[str, VaryCard]) -> dict[str, VaryCard]:
    """Cards and sections that vary as a whole first, then the numbers within them, so that these are not lost."""
    within = {key: outer for key in vary for outer in vary if key.startswith(f"{outer}.")}
    for key, outer in within.items():
        if vary[key].factor is not None:
            raise InputError(
                f"'{outer}' varies as a whole, so a factor has no meaning here: give values", field=f"vary.{key}"
            )
    if not within:
        return dict(vary)
    return dict(sorted(vary.items(), key=lambda entry: entry[0].count(".")))


def card_of(study: StudyData, vary: Mapping[str, Any] | None = None, **options: Any) -> SweepCard:
    """The content of a sweep file from Python values.

    Parameters
    ----------
    vary : e.g. ``{"drive.speed": ("10 mph", "40 mph"), "materials.tread": ["soft", "hard"]}``. A tuple is a range, with
        its levels as third entry; a list has the values; a mapping has the keys of a sweep file.
    options : other keys of a sweep file; None: not given.
    """
    data = {key: value for key, value in options.items() if value is not None}
    if vary:
        data["vary"] = {key: _vary(value) for key, value in vary.items()}
    if "cases" in data:
        data.setdefault("sample", "list")
    return SweepCard.check({"study": study.name, **data})


def plan_of(study: StudyData, vary: Mapping[str, Any], **options: Any) -> Plan:
    """The variants of `card_of`."""
    return planned(study, card_of(study, vary, **options))


def _vary(value: Any) -> Any:
    if isinstance(value, VaryCard):
        return value
    plain = written(value)
    if isinstance(plain, Mapping):
        return plain
    if isinstance(value, tuple):
        if len(value) not in (2, 3):
            raise InputError(f"a range is (from, to) or (from, to, levels), not {value!r}", field="vary")
        return dict(zip(("from", "to", "levels"), plain, strict=False))
    if isinstance(plain, list):
        return {"values": plain}
    raise InputError(f"must be a list of values or a tuple (from, to), not {value!r:.60}", field="vary")


def check_changes(study: StudyData, trials: Sequence[tuple[str, Mapping[str, Any]]]) -> None:
    """Build the study and load cases of every (name, changes); raise `InputError` that names the first refused."""
    for name, changes in trials:
        try:
            check_cases(study.replace(changes))
        except InputError as error:
            shown = ", ".join(f"{key} = {value!r}" for key, value in changes.items())
            raise InputError(f"{name or 'a variant'} with {shown}: {error.message}", field=error.field) from None
