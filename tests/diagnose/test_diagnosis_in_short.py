"""A diagnosis shows itself in a few lines, and can be stored."""

from __future__ import annotations

import pickle
from collections.abc import Callable

from hidden import Case


def test_it_speaks_briefly(case: Case, speaks_briefly: Callable[[object], set[type]]) -> None:
    speaks_briefly(case.diagnosis)
    assert "hot-road" in repr(case.diagnosis)
    assert case.diagnosis.verdict in repr(case.diagnosis).splitlines()[0]


def test_it_comes_back_whole(case: Case) -> None:
    back = pickle.loads(pickle.dumps(case.diagnosis))
    assert back.to_dict() == case.diagnosis.to_dict()
    assert (back.where == case.diagnosis.where).all(axis=None)
    assert back.study.data == case.diagnosis.study.data
