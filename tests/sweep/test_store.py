"""Finished variants on disk."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from tyrefem.errors import InputError, ResultWarning
from tyrefem.variants.outcomes import Answered, Failed, Outcome
from tyrefem.variants.store import NAME, Store

pytestmark = pytest.mark.fast


def answered(number: int) -> Answered:
    """Answers of a variant: numbers whose last bits matter, one that is missing, and words."""
    values = {"hottest_degC": 50.0 + math.sqrt(number), "time_to_limit_s": math.nan if number % 3 else number / 7}
    region = ("tread", "carcass", "bead")[number % 3]
    return Answered(values | {"hottest_region": region}, "reduced", 1e-3 * number)


def many(first: int, count: int) -> dict[int, Outcome]:
    return {number: answered(number) for number in range(first, first + count)}


def same(outcome: Outcome, number: int) -> bool:
    """Is an outcome the one of `answered`, to the last bit?"""
    return repr(outcome) == repr(answered(number))


def test_what_was_added_is_there_again(tmp_path: Path) -> None:
    with Store(tmp_path, "plan") as store:
        assert store.open() == 0
        store.add({0: Answered({"hottest_degC": 50.5}), 2: Failed("too hot")})
        store.note("certificate", {"worst": 0.01})
        store.add_by_name({"speed 10 mph": Answered({"hottest_degC": 40.0})})
    with Store(tmp_path, "plan") as again:
        assert again.open() == 3
        assert again.outcomes[0] == Answered({"hottest_degC": 50.5})
        assert again.outcomes[2] == Failed("too hot")
        assert again.by_name == {"speed 10 mph": Answered({"hottest_degC": 40.0})}
        assert again.notes == {"certificate": {"worst": 0.01}}


@pytest.mark.parametrize("counts", [(200, 31, 8), (1500,), (7, 600)])
def test_many_outcomes_come_back_to_the_last_bit(tmp_path: Path, counts: tuple[int, ...]) -> None:
    first = 0
    with Store(tmp_path, "plan") as store:
        store.open()
        for count in counts:
            store.add(many(first, count))
            first += count
        assert all(same(store.outcomes[number], number) for number in range(first))
    with Store(tmp_path, "plan") as again:
        assert again.open() == first
        assert list(again.outcomes) == list(range(first))
        assert all(same(again.outcomes[number], number) for number in range(first))


def test_outcomes_between_others_come_back(tmp_path: Path) -> None:
    odd = {number: answered(number) for number in range(1, 400, 2)}
    with Store(tmp_path, "plan") as store:
        store.open()
        store.add(odd)
        store.add({4: Failed("bursts"), 6: Answered({"list": [1, 2], "count": 3})})
    with Store(tmp_path, "plan") as again:
        again.open()
        assert list(again.outcomes) == sorted([*odd, 4, 6])
        assert all(same(again.outcomes[number], number) for number in odd)
        assert again.outcomes.failed == {4: Failed("bursts")}
        assert again.outcomes[6] == Answered({"list": [1, 2], "count": 3})


def test_the_file_only_grows(tmp_path: Path) -> None:
    content = b""
    for turn in range(3):
        with Store(tmp_path, "plan") as store:
            store.open()
            for part in range(4):
                store.add(many(100 * (4 * turn + part), 100))
                grown = (tmp_path / NAME).read_bytes()
                assert len(grown) > len(content)
                assert grown.startswith(content)
                content = grown


def test_a_variant_takes_few_bytes(tmp_path: Path) -> None:
    with Store(tmp_path, "plan") as store:
        store.open()
        store.add(many(0, 64))
        one = (tmp_path / NAME).stat().st_size
        for part in range(1, 20):
            store.add(many(64 * part, 64))
    # Three doubles and a word as JSON take 150 bytes.
    assert ((tmp_path / NAME).stat().st_size - one) / (19 * 64) < 40


@pytest.mark.parametrize("torn", [1, 5, 20])
def test_a_line_that_a_kill_tore_off_is_cut_away(tmp_path: Path, torn: int) -> None:
    with Store(tmp_path, "plan") as store:
        store.open()
        for number in range(3):
            store.add({number: Answered({"x": 1.0})})
    content = (tmp_path / NAME).read_bytes()
    (tmp_path / NAME).write_bytes(content[:-torn])
    with Store(tmp_path, "plan") as again:
        with pytest.warns(ResultWarning, match="last record is incomplete"):
            assert again.open() == 2
        again.add({2: Answered({"x": 2.0})})
    with Store(tmp_path, "plan") as once_more:
        assert once_more.open() == 3
        assert once_more.outcomes[2] == Answered({"x": 2.0})


@pytest.mark.parametrize("torn", [1, 2, 40, 200, 1400])
def test_a_block_that_a_kill_tore_off_is_cut_away(tmp_path: Path, torn: int) -> None:
    with Store(tmp_path, "plan") as store:
        store.open()
        store.add(many(0, 100))
        before = (tmp_path / NAME).stat().st_size
        store.add(many(100, 100))
    content = (tmp_path / NAME).read_bytes()
    assert len(content) - before > 1400
    (tmp_path / NAME).write_bytes(content[:-torn])
    with Store(tmp_path, "plan") as again:
        with pytest.warns(ResultWarning, match="last record is incomplete"):
            assert again.open() == 100
        again.add(many(100, 100))
    assert (tmp_path / NAME).read_bytes() == content


def test_a_damaged_block_is_named(tmp_path: Path) -> None:
    with Store(tmp_path, "plan") as store:
        store.open()
        store.add(many(0, 100))
    content = (tmp_path / NAME).read_bytes()
    middle = content.index(b'"columns": "') + 300
    (tmp_path / NAME).write_bytes(content[:middle] + b"AAAA" + content[middle + 4 :])
    with Store(tmp_path, "plan") as again:
        assert again.open() == 100
        with pytest.raises(InputError, match="damaged; delete them with --restart"):
            _ = again.outcomes[5]


def test_a_record_in_the_middle_that_is_cut_short_is_named(tmp_path: Path) -> None:
    with Store(tmp_path, "plan") as store:
        store.open()
        store.add(many(0, 100))
        store.add(many(100, 100))
    content = (tmp_path / NAME).read_bytes()
    end = content.index(b"\n", content.index(b'"columns"'))
    (tmp_path / NAME).write_bytes(content[:end] + content[end + 1 :])
    with pytest.raises(InputError, match=r"the record at byte [0-9]+ is damaged; .*--restart"):
        Store(tmp_path, "plan").open()


def test_a_file_of_single_lines_as_older_versions_wrote_goes_on(tmp_path: Path) -> None:
    lines = [{"plan": "plan"}, {"note": "certificate", "value": {"worst": None}}]
    lines += [{"variant": number, **answered(number).entry} for number in range(0, 3000, 3)]
    lines.append({"variant": 1, "failure": "too hot"})
    (tmp_path / NAME).write_text("".join(json.dumps(line) + "\n" for line in lines).replace("NaN", "null"))
    with Store(tmp_path, "plan") as store:
        assert store.open() == 1001
        store.add(many(3000, 100))
    with Store(tmp_path, "plan") as again:
        assert again.open() == 1101
        assert all(same(again.outcomes[number], number) for number in [*range(0, 3000, 3), *range(3000, 3100)])
        assert again.outcomes[1] == Failed("too hot")
        assert math.isnan(again.notes["certificate"]["worst"])


def test_another_plan_is_refused_and_nothing_lost(tmp_path: Path) -> None:
    with Store(tmp_path, "plan") as store:
        store.open()
        store.add({0: Answered({})})
    before = (tmp_path / NAME).read_bytes()
    with pytest.raises(InputError, match="another sweep"):
        Store(tmp_path, "other").open()
    assert (tmp_path / NAME).read_bytes() == before
    with Store(tmp_path, "other") as anew:
        assert anew.open(restart=True) == 0


def test_a_file_of_something_else_is_refused(tmp_path: Path) -> None:
    (tmp_path / NAME).write_text("time,T\n0,25\n")
    with pytest.raises(InputError, match="not a file of finished variants: move it away, or replace it with"):
        Store(tmp_path, "plan").open()
    assert (tmp_path / NAME).read_text() == "time,T\n0,25\n"


def test_a_variant_is_kept_once(tmp_path: Path) -> None:
    with Store(tmp_path, "plan") as store:
        store.open()
        store.add({0: Answered({"x": 1.0})})
        store.add({0: Answered({"x": 2.0})})
        store.add(many(10, 100))
        store.add({number: Answered({"x": 2.0}) for number in range(10, 110)})
        assert store.outcomes[0] == Answered({"x": 1.0})
        assert len(store.outcomes) == 101
        assert same(store.outcomes[10], 10)
