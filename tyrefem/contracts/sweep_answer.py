"""Contracts of a user's answer of a sweep."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from tyrefem.contracts.contract import Contract, kept
from tyrefem.contracts.law import example_of
from tyrefem.contracts.study import quick_study
from tyrefem.errors import InputError
from tyrefem.output import jsonable
from tyrefem.sweep.design import DesignData, run_design_study
from tyrefem.sweep.question import SweepQuestion


def contracts(cls: type[SweepQuestion], study_name: str | None = None) -> Iterator[Contract]:
    """The contracts of an answer: it runs on a tiny sweep; its table, sentences and JSON can be written."""
    table = example_of(cls)
    try:
        cls.table.check(table)
    except InputError as error:
        needs = "; give values in example: ClassVar[dict] = {...}" if "missing" in error.message else ""
        yield Contract("its example table is read", f"{error}{needs}")
        return
    yield Contract("its example table is read")
    designs: list[DesignData] = []

    def answered() -> str | None:
        study, speeds = quick_study(study_name), ["10 mph", "15 mph", "20 mph"]
        key = "drive.phases.rolling.speed" if study_name is None else "drive.speed"
        designs.append(run_design_study(study, {key: speeds}, reduced="never", **{cls.key: table}))
        return None if cls.key in designs[0].answers else "the sweep has no answer of its name"

    yield kept("it answers a sweep of three speeds", answered)
    answer: Any = designs[0].answers.get(cls.key) if designs else None
    if answer is None:
        return
    yield kept("its table has rows and named columns", lambda: _table(answer))
    yield kept("its sentences are text", lambda: _sentences(answer))
    yield kept("it can be written as JSON", lambda: _json(answer))


def _table(answer: Any) -> str | None:
    table = answer.table
    if not hasattr(table, "to_csv"):
        return f"table must be a pandas DataFrame, not {type(table).__name__}"
    if not len(table.columns) or not all(isinstance(name, str) for name in table.columns):
        return f"columns must be named by text, not {list(table.columns)!r:.60}"
    if not len(table):
        return "it has no row"
    table.to_parquet(path=None)
    return None


def _sentences(answer: Any) -> str | None:
    words = answer.words
    texts = isinstance(words, list) and all(isinstance(line, str) for line in words)
    return None if texts else f"words must be a list of sentences, not {words!r:.60}"


def _json(answer: Any) -> str | None:
    json.dumps(jsonable(answer.to_dict()))
    return None
