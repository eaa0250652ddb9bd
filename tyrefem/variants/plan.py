"""A plan: a study, its varied numbers, and all variants; checked before anything runs."""

from __future__ import annotations

import functools
import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tyrefem.errors import InputError, InputWarning
from tyrefem.inputs.changes import check_compatible
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.uncertain_numbers import left_out
from tyrefem.mechanics.cautions import warnings_of
from tyrefem.mechanics.solved_cases import check_cases
from tyrefem.quantity import written
from tyrefem.variants.answers import check_answer, check_sensor_names
from tyrefem.variants.card import LimitCard, SweepCard, VaryCard
from tyrefem.variants.links import Links, check_apart, check_links, members
from tyrefem.variants.samples import Counted, Grid, check_distinct, drawn, listed, size_of
from tyrefem.variants.task import Bundle, Task, bundle
from tyrefem.variants.varied import Varied, factor_of, factored, uncertain, varied


@dataclass(frozen=True, eq=False)
class Plan:
    """The variants of a study.

    Parameters
    ----------
    study : the study. varied : the varied numbers; empty if the variants come from a list. variants : changes of each,
    made when they are asked for. names : of the variants. limits : answer -> its limits. time_to : see `answers`.
    sampling : description of the sample, for the record. linked : names of a list that set several numbers or give a
        factor.
    """

    study: StudyData
    varied: tuple[Varied, ...]
    variants: Sequence[Mapping[str, Any]]
    names: Sequence[str]
    limits: Mapping[str, LimitCard]
    time_to: float | None
    sampling: Mapping[str, Any]
    linked: tuple[Varied, ...] = ()

    @functools.cached_property
    def packed(self) -> Bundle:
        """The study packed for workers."""
        return bundle(self.study)

    @functools.cached_property
    def digest(self) -> str:
        """Digest of the study, its files, and all variants in their order."""
        # The text of [study, [variants], time_to] as JSON, without all variants in memory.
        study, time_to = (json.dumps(part, sort_keys=True) for part in (self.packed.digest, self.time_to))
        digest = hashlib.sha256(f"[{study}, [".encode())
        for number, changes in enumerate(self.variants):
            digest.update(b", " if number else b"")
            digest.update(json.dumps(changes, sort_keys=True, default=str).encode())
        digest.update(f"], {time_to}]".encode())
        return digest.hexdigest()[:16]

    @functools.cached_property
    def warnings(self) -> tuple[InputWarning, ...]:
        """Warnings of listed values, of both ends of every range and of listed variants that the study itself does not
        give.

        Each number varies alone, each listed variant as a whole; of the warnings of a field the first is kept.
        """
        known = {warning.field for warning in warnings_of(self.study)}
        first: dict[str | None, InputWarning] = {}
        for changes in self._trials():
            for warning in warnings_of(self.study.replace(changes)):
                if warning.field not in known:
                    first.setdefault(warning.field, warning)
        return tuple(first.values())

    def _trials(self) -> Iterator[Mapping[str, Any]]:
        """Changes that are checked for the whole plan."""
        if self.sampling.get("sample") == "list":
            yield from self.variants
        for number in self.varied:
            yield from map(number.changes, number.ends)

    @property
    def keys(self) -> list[str]:
        """Dotted names that the variants change, in order."""
        return list(dict.fromkeys(key for variant in self.variants for key in variant))

    def task(self, number: int) -> Task:
        """The task of a variant."""
        return Task(number, self.packed, self.variants[number], self.time_to)

    def row(self, number: int) -> dict[str, Any]:
        """A variant's name and values, as a row of a table."""
        return {"variant": self.names[number], **self._shown(self.variants[number], written=False)}

    @property
    def headings(self) -> list[str]:
        """Headings of the values in the rows, in order."""
        if self.varied:
            return [number.heading for number in self.varied]
        return list(dict.fromkeys(name for changes in self.variants for name in self._shown(changes, written=False)))

    def settings(self, number: int) -> dict[str, Any]:
        """A variant's values as written, by the names that vary."""
        return self._shown(self.variants[number], written=True)

    def _shown(self, changes: Mapping[str, Any], written: bool) -> dict[str, Any]:
        numbers = (*self.varied, *self.linked)
        by_key = {each.key: each for each in numbers}
        beside = {key for each in numbers for key in each.keys[1:]}
        shown: dict[str, Any] = {}
        for key, value in changes.items():
            each = by_key.get(key)
            if each is None:
                shown |= {} if key in beside else {key: value}
            elif written:
                shown[each.label] = each.setting(value) if each.name else value
            else:
                shown[each.heading] = each.of(value)
        return shown


def planned(study: StudyData, card: SweepCard, near: Path | None = None) -> Plan:
    """The plan of a sweep file.

    Raises
    ------
    InputError : a name that the study does not have, a value that it refuses, two equal variants, or more variants
        than fit in memory.
    """
    check_sensor_names(study)
    for name in (*card.limits, *card.answers, *card.pareto):
        try:
            check_answer(name, study, card.time_to)
        except InputError as error:
            table = next(part for part in ("limits", "answers", "pareto") if name in getattr(card, part))
            raise error.within(field=table) from None
    names: Sequence[str]
    variants: Sequence[Mapping[str, Any]]
    linked: tuple[Varied, ...] = ()
    if card.chosen == "list":
        assert card.cases is not None
        path = (near or Path()) / card.cases
        variants, listed_names = listed(path)
        names = tuple(listed_names)
        chosen: tuple[Varied, ...] = ()
        try:
            check_links(study, card.link, [*_used(card), *(name for changes in variants for name in changes)])
            variants, linked = _unlinked(study, variants, card.link)
            for alike in {tuple(part): part for part in variants}.values():
                check_compatible(study.data, alike)
            check_changes(study, [(f"variant '{name}'", part) for name, part in zip(names, variants, strict=True)])
        except InputError as error:
            raise error if error.file else error.within(file=path) from None
    else:
        chosen = _outer_keys_first([varied(study, key, part, card.link) for key, part in card.vary.items()])
        check_apart([(number.label, number.keys) for number in chosen], study)
        check_links(study, card.link, _used(card))
        if card.uncertain is not None:
            chosen += _not_varied_otherwise(chosen, uncertain(study, card.uncertain))
        if card.sampled:
            size_of(chosen, card.chosen, card.count)
        try:
            check_compatible(
                study.data, {key: value for part in chosen for key, value in part.changes(part.ends[0]).items()}
            )
        except InputError as error:
            raise error.within(field="vary") from None
        ends = [(part, value) for part in chosen for value in part.ends]
        shown = [f"{part.label} = {part.setting(value) if part.name else repr(value)}" for part, value in ends]
        check_changes(study, [("", part.changes(value)) for part, value in ends], shown)
        if not card.sampled:
            variants = []
        elif card.chosen == "grid":
            variants = Grid(chosen)
        else:
            assert card.count is not None
            variants = drawn(chosen, card.chosen, card.count, card.seed)
        names = Counted(len(variants))
        if card.chosen != "saltelli":
            check_distinct(variants, names)
    seed = card.seed if card.chosen in ("latin-hypercube", "sobol", "saltelli") else None
    sampling: dict[str, Any] = {"sample": card.chosen if card.sampled else None, "count": len(variants), "seed": seed}
    together = {part.label: part.settings_of_keys for part in (*chosen, *linked) if part.name}
    if together:
        sampling["linked"] = together
    if card.uncertain is not None:
        also = {part.key: [key for key, _ in part.also] for part in chosen if part.also and not part.name}
        sampling |= {"uncertain": card.uncertain, "also": also, "left_out": left_out(study.uncertain_numbers)}
    return Plan(study, chosen, variants, names, dict(card.limits), card.time_to, sampling, linked)


def _used(card: SweepCard) -> list[str]:
    """The names that vary in a sweep file, apart from those of a list."""
    return [*card.vary, *(card.tornado.tolerances if card.tornado else ())]


def _unlinked(
    study: StudyData, variants: Sequence[Mapping[str, Any]], links: Links
) -> tuple[list[dict[str, Any]], tuple[Varied, ...]]:
    """The variants of a list by the study's names, and the names in it that set several numbers or give a factor."""
    columns = list(dict.fromkeys(name for changes in variants for name in changes))
    groups = {name: members(study, name, links) for name in columns}
    check_apart([(name, group.keys) for name, group in groups.items()], study)
    numbers: dict[str, Varied] = {}
    for name, group in groups.items():
        values = [changes[name] for changes in variants if name in changes]
        factors = [factor_of(value) for value in values]
        if any(factor is not None for factor in factors):
            if None in factors:
                raise InputError("is a factor in some rows and a value in others", field=name)
            numbers[name] = factored(study, group)
        elif group.linked:
            (key, _), *same = group.pairs
            numbers[name] = Varied(key, values=tuple(dict.fromkeys(values)), same=tuple(same), name=name)
    plain = []
    for changes in variants:
        laid: dict[str, Any] = {}
        for name, value in changes.items():
            number, factor = numbers.get(name), factor_of(value)
            if number is None:
                laid[name] = value
            else:
                laid |= number.changes(value if factor is None else number.written(factor))
        plain.append(laid)
    return plain, tuple(numbers.values())


def _not_varied_otherwise(chosen: Sequence[Varied], numbers: Sequence[Varied]) -> tuple[Varied, ...]:
    """The uncertain numbers that are not in ``chosen``.

    Raises
    ------
    InputError : the card of an uncertain number varies as a whole.
    """
    named = {key for number in chosen for key in number.keys}
    beside = tuple(number for number in numbers if not named & set(number.keys))
    for number in beside:
        for key in number.keys:
            outer = next((name for name in named if key.startswith(f"{name}.")), None)
            if outer is not None:
                message = f"'{outer}' varies as a whole, so its number '{key}' has no single value to vary about"
                raise InputError(message, field="uncertain")
    return beside


def _outer_keys_first(numbers: Sequence[Varied]) -> tuple[Varied, ...]:
    """Cards and sections that vary as a whole first, then the numbers within them, so that these are not lost."""
    whole = {key: number for number in numbers for key in number.keys}
    within = False
    for number in numbers:
        outer = next((key for key in whole for inner in number.keys if inner.startswith(f"{key}.")), None)
        if outer is None:
            continue
        within = True
        if number.nominal is not None:
            raise InputError(
                f"'{outer}' varies as a whole, so a factor has no meaning here: give values",
                field=f"vary.{number.label}",
            )
    return tuple(sorted(numbers, key=lambda number: number.key.count(".")) if within else numbers)


def card_of(study: StudyData, vary: Mapping[str, Any] | None = None, **options: Any) -> SweepCard:
    """The content of a sweep file from Python values.

    Parameters
    ----------
    vary : e.g. ``{"drive.speed": ("10 mph", "40 mph"), "materials.tread": ["soft", "hard"]}``. A tuple is a range, with
        its levels as third entry; a list has the values; a mapping has the keys of a sweep file.
    options : other keys of a sweep file; None: not given.
    """
    data = {key: written(value) for key, value in options.items() if value is not None}
    if not isinstance(data.get("cases", ""), str):
        given = type(options["cases"]).__name__
        raise InputError(f"must be the path of a CSV file or workbook, not a value of type {given}", field="cases")
    if not isinstance(vary, Mapping | None):
        example = "{'drive.speed': ('10 mph', '40 mph')}"
        raise InputError(f"must be a mapping like {example}, not {vary!r:.60}", field="vary")
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


def check_changes(
    study: StudyData, trials: Sequence[tuple[str, Mapping[str, Any]]], words: Sequence[str] | None = None
) -> None:
    """Build the study and load cases of every (name, changes); raise `InputError` that names the first refused.

    ``words``: the changes of every trial as text.
    """
    for place, (name, changes) in enumerate(trials):
        try:
            check_cases(study.replace(changes))
        except InputError as error:
            shown = words[place] if words else ", ".join(f"{key} = {value!r}" for key, value in changes.items())
            raise InputError(f"{name or 'a variant'} with {shown}: {error.message}", field=error.field) from None
