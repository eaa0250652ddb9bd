"""Finished variants on disk."""

from __future__ import annotations

from pathlib import Path

import pytest

from tyrefem.errors import InputError
from tyrefem.variants.store import NAME, Store

pytestmark = pytest.mark.fast


def test_what_was_added_is_there_again(tmp_path: Path) -> None:
    with Store(tmp_path, "plan") as store:
        assert store.open() == 0
        store.add({0: {"answers": {"hottest_degC": 50.5}}, 2: {"failure": "too hot"}})
        store.note("certificate", {"worst": 0.01})
    with Store(tmp_path, "plan") as again:
        assert again.open() == 2
        assert again.done[0]["answers"] == {"hottest_degC": 50.5}
        assert again.done[2]["failure"] == "too hot"
        assert again.notes == {"certificate": {"worst": 0.01}}


@pytest.mark.parametrize("torn", [1, 5, 20])
def test_a_line_that_a_kill_tore_off_is_cut_away(tmp_path: Path, torn: int) -> None:
    with Store(tmp_path, "plan") as store:
        store.open()
        for number in range(3):
            store.add({number: {"answers": {"x": 1.0}}})
    content = (tmp_path / NAME).read_bytes()
    (tmp_path / NAME).write_bytes(content[:-torn])
    with Store(tmp_path, "plan") as again:
        assert again.open() == 2
        again.add({2: {"answers": {"x": 2.0}}})
    with Store(tmp_path, "plan") as once_more:
        assert once_more.open() == 3
        assert once_more.done[2]["answers"] == {"x": 2.0}


def test_another_plan_is_refused_and_nothing_lost(tmp_path: Path) -> None:
    with Store(tmp_path, "plan") as store:
        store.open()
        store.add({0: {"answers": {}}})
    before = (tmp_path / NAME).read_bytes()
    with pytest.raises(InputError, match="another sweep"):
        Store(tmp_path, "other").open()
    assert (tmp_path / NAME).read_bytes() == before
    with Store(tmp_path, "other") as anew:
        assert anew.open(restart=True) == 0


def test_a_file_of_something_else_is_refused(tmp_path: Path) -> None:
    (tmp_path / NAME).write_text("time,T\n0,25\n")
    with pytest.raises(InputError, match="not a file of finished variants"):
        Store(tmp_path, "plan").open()
    assert (tmp_path / NAME).read_text() == "time,T\n0,25\n"


def test_a_variant_is_kept_once(tmp_path: Path) -> None:
    with Store(tmp_path, "plan") as store:
        store.open()
        store.add({0: {"answers": {"x": 1.0}}})
        store.add({0: {"answers": {"x": 2.0}}})
        assert store.done[0]["answers"] == {"x": 1.0}
