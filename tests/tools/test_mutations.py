"""The table of mutations fits the code, and the tool tells a mutant that is noticed from one that survives."""

from __future__ import annotations

from pathlib import Path

import pytest
from mutations import Mutation, StaleMutationError, check, main, read_mutations

pytestmark = pytest.mark.fast

ROOT = Path(__file__).parents[2]
MUTATIONS = read_mutations()


def test_there_are_enough_of_them() -> None:
    assert len({mutation.name for mutation in MUTATIONS}) == len(MUTATIONS) >= 20
    assert len({mutation.file for mutation in MUTATIONS}) >= 12


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: mutation.name)
def test_its_formula_is_in_the_code_once_and_its_tests_exist(mutation: Mutation) -> None:
    text = (ROOT / mutation.file).read_text(encoding="utf-8")
    mutant = mutation.applied(text)
    assert mutant != text
    compile(mutant, mutation.file, "exec")
    assert mutation.tests
    for test in mutation.tests:
        assert (ROOT / test).is_file(), test


@pytest.mark.parametrize("text", ["", "area = r * r\narea = r * r\n"])
def test_a_formula_that_went_or_stands_twice_is_refused(text: str) -> None:
    with pytest.raises(StaleMutationError, match=r"area: circle\.py has 'r \* r' [02] times"):
        Mutation("area", "circle.py", "r * r", "2 * r", ()).applied(text)


def test_noticed_and_survived(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "circle.py").write_text("def area(r):\n    return r * r\n\ndef twice(r):\n    return r + r\n")
    test = "from circle import area, twice\ndef test_area():\n    assert area(3) == 9 and twice(2) == 4\n"
    (tmp_path / "test_circle.py").write_text(test)
    area = Mutation("area", "circle.py", "r * r", "2 * r", ("test_circle.py",))
    twice = Mutation("twice", "circle.py", "r + r", "r * r", ("test_circle.py",))
    assert check([area, twice], tmp_path) == {"area": "test_circle.py::test_area", "twice": None}
    assert (tmp_path / "circle.py").read_text().count("r * r") == 1
    assert "survived  twice" in capsys.readouterr().out


def test_nothing_of_that_name_is_no_success(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as refused:
        main(["no-such-formula"])
    assert refused.value.code == 2
    assert "no mutation has one of the words" in capsys.readouterr().err
