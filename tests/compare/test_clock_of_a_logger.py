"""A run whose clock begins elsewhere is refused with the offset that puts it at the start of the drive."""

from __future__ import annotations

import numpy as np
import pytest
from toy_study import Study, measured_from

from tyrefem.compare.experiment import Experiment
from tyrefem.compare.omitted import outside_note

TIMES = np.arange(0.0, 601.0, 10.0)


@pytest.mark.parametrize(
    ("begin", "length", "offset"),
    [
        (3600.0, 61, "add -3600 s to the 'time_offset'"),
        (-900.0, 21, "add 900 s to the 'time_offset'"),
        (12345678.5, 61, "add -12345678.5 s to the 'time_offset'"),
    ],
)
def test_the_offset_is_said_where_the_run_would_fit(begin: float, length: int, offset: str) -> None:
    run = measured_from(Study(), begin + TIMES[:length])
    (note,) = outside_note(Experiment(run, "run-1"), 0.0, 600.0, length)
    assert note.startswith("ERROR: run 'run-1': ")
    assert offset in note


def test_no_offset_is_said_of_a_run_that_is_longer_or_partly_inside() -> None:
    partly = Experiment(measured_from(Study(), TIMES - 300.0), "run-1")
    assert "time_offset" not in outside_note(partly, 0.0, 600.0, 30)[0]
    longer = Experiment(measured_from(Study(), TIMES + 1000.0), "run-1")
    assert "time_offset" not in outside_note(longer, 0.0, 300.0, len(TIMES))[0]
