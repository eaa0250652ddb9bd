"""The tools that compare two records: what counts as the same number, and as a loss of the interface."""

import importlib
import math
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from tyrefem.output.arrays import write_arrays

pytestmark = pytest.mark.fast

TOOLS = Path(__file__).parents[2] / "tools"
RUN = {"run one": {"exit code": 0, "hottest": 79.5577929796, "region": "tread"}}


def tool(name: str) -> ModuleType:
    """A module of the tools' folder, which is no package."""
    sys.path.insert(0, str(TOOLS))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.remove(str(TOOLS))


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({}, 0),
        ({"hottest": 79.5577929796 * (1 + 5e-10)}, 0),
        ({"hottest": 79.5577929796 * (1 + 2e-9)}, 1),
        ({"region": "bead"}, 1),
        ({"exit code": 2}, 1),
        ({"new": 1.0}, 0),
    ],
)
def test_numbers_to_the_tolerance_and_names_exactly(change, code, capsys):
    after = {"run one": RUN["run one"] | change}
    assert tool("number_differences").compare(RUN, after, 1e-9) == code


def test_a_missing_key_or_entry_is_a_difference(capsys):
    compare = tool("number_differences").compare
    assert compare(RUN, {"run one": {"exit code": 0, "region": "tread"}}, 1e-9) == 1
    assert compare(RUN, {}, 1e-9) == 1
    assert "hottest" in capsys.readouterr().out


def test_one_changed_value_of_an_array_is_seen_and_so_are_two_swapped_ones():
    summary, difference = tool("number_files").array_summary, tool("number_differences").difference
    before = summary([25.0, 40.0, 60.0])
    assert difference("T", before, summary([25.0, 40.0, 60.0])) == 0.0
    assert difference("T", before, summary([25.0, 40.0001, 60.0])) > 1e-9
    assert difference("T", before, summary([40.0, 25.0, 60.0])) > 1e-9
    assert difference("T", before, summary([25.0, 40.0])) == math.inf


def test_a_printed_column_is_the_same_to_its_last_digit(tmp_path):
    files, difference = tool("number_files"), tool("number_differences").difference
    leaves = []
    for number, text in enumerate(("79.557", "79.558", "79.560")):
        path = tmp_path / f"{number}.csv"
        path.write_text(f"sensor,end [degC]\ncrown,{text}\n")
        leaves.append(dict(files.read_csv(path)))
    assert leaves[0]["sensor"] == "crown"
    assert difference("end", leaves[0]["end [degC]"], leaves[1]["end [degC]"]) == 0.0
    assert difference("end", leaves[0]["end [degC]"], leaves[2]["end [degC]"]) > 1e-9


def test_the_data_of_a_stored_result_are_its_numbers_without_its_wall_time(tmp_path):
    entries = []
    for number, seconds in enumerate((1.25, 10.5)):
        file = tmp_path / f"{number}.npz"
        write_arrays(file, {"wall_time": seconds, "steps": {"taken": 3}}, {"times": np.arange(3.0)}, {})
        entries.append(dict(tool("number_files").read_npz(file)))
    assert entries[0] == entries[1]
    assert entries[0]["data.steps.taken"] == 3


def test_round_off_may_grow_but_not_become_an_error():
    difference = tool("number_differences").difference
    assert difference("heat_budget.imbalance", 1e-12, 5e-12) == 0.0
    assert difference("heat_budget.imbalance", 1e-12, 1e-6) == math.inf


def test_what_changes_from_run_to_run_and_sentences_are_left_out():
    data = {
        "wall_time_s": 3.0,
        "words": ["Hot."],
        "note": "a sentence",
        "files_read": {"/a/study.toml": "1f"},
        "rows": [{"name": "bead", "T": 31.0}],
    }
    assert dict(tool("number_files").leaves(data)) == {"rows[bead].name": "bead", "rows[bead].T": 31.0}


def _call(*rows: tuple[str, bool]) -> dict[str, list[dict[str, object]]]:
    kind = "POSITIONAL_OR_KEYWORD"
    return {"parameters": [{"name": name, "kind": kind, "required": needed} for name, needed in rows]}


@pytest.mark.parametrize(
    ("after", "count"),
    [
        (_call(("table", False)), 0),
        (_call(("table", False), ("k", False)), 0),
        (_call(), 2),
        (_call(("table", True)), 1),
        (_call(("table", False), ("k", True)), 1),
        (_call(("k", False), ("table", False)), 1),
    ],
)
def test_a_call_that_worked_must_work(after, count):
    assert len(list(tool("record_interface").losses(_call(("table", False)), after))) == count


def test_additions_are_allowed_and_losses_are_named():
    losses = tool("record_interface").losses
    before = {"cards": {"study": {"drive.speed": "m/s"}}, "library": {"studies": ["a"]}}
    assert not list(
        losses(before, {"cards": {"study": {"drive.speed": "m/s", "x": "m"}}, "library": {"studies": ["b", "a"]}})
    )
    lost = list(losses(before, {"cards": {"study": {"drive.speed": "km/h"}}, "library": {"studies": []}}))
    assert lost == ["changed: cards > study > drive.speed: m/s -> km/h", "missing: library > studies > a"]
