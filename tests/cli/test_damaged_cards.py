"""Whatever stands in a user's file: it works, or one line says what is wrong. Never a traceback."""

from __future__ import annotations

import contextlib
import io
import os
import shutil
from pathlib import Path

import pytest
from corruption import damaged
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tyrefem import library
from tyrefem.cli import main

CARDS = (
    "studies/nasa-22x5.5-8pr/study.toml",
    "studies/nasa-taxi-takeoff/study.toml",
    "studies/example-validation/study.toml",
    "studies/nasa-campaign/study.toml",
    "studies/nasa-campaign/cases.csv",
    "studies/example-validation/run-1.csv",
    "geometry/nasa-22x5.5-8pr.toml",
    "materials/nasa-carcass.toml",
    "materials/nasa-tread.toml",
)
#: The study that uses a card of the key's folder.
USER = {"geometry": "studies/nasa-22x5.5-8pr", "materials": "studies/nasa-22x5.5-8pr"}


@pytest.fixture(scope="module")
def library_copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("library")
    for name in ("geometry", "materials", "studies"):
        shutil.copytree(library.shipped() / name, folder / name)
    # A campaign of three cases answers as one of nineteen does, in less time.
    cases = folder / "studies/nasa-campaign/cases.csv"
    cases.write_text("\n".join(cases.read_text(encoding="utf-8").splitlines()[:7]) + "\n", encoding="utf-8")
    return folder


def checked(path: Path) -> None:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(["check", str(path)])
    if code == 0:
        assert err.getvalue() == ""
        assert out.getvalue().count("\n") == 1
    else:
        assert code == 2
        assert err.getvalue().startswith("tyrefem: ")
        assert err.getvalue().count("\n") == 1
        assert out.getvalue() == ""


@settings(max_examples=int(os.environ.get("TYREFEM_EXAMPLES", "60")), deadline=None,
          suppress_health_check=[HealthCheck.too_slow])  # fmt: skip
@given(data=st.data())
def test_damaged_card_works_or_is_refused_in_one_line(library_copy: Path, data: st.DataObject) -> None:
    card = data.draw(st.sampled_from(CARDS), label="card")
    path = library_copy / card
    text = path.read_text(encoding="utf-8")
    path.write_text(data.draw(damaged(text), label="text"), encoding="utf-8")
    try:
        checked(path)
        folder = USER.get(path.parent.name)
        checked(library_copy / folder if folder else path.parent)
    finally:
        path.write_text(text, encoding="utf-8")


@settings(max_examples=20, deadline=None)
@given(content=st.binary(max_size=200), suffix=st.sampled_from((".toml", ".csv", ".txt", "")))
def test_any_bytes_are_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, content: bytes, suffix: str
) -> None:
    path = tmp_path_factory.mktemp("bytes") / f"card{suffix}"
    path.write_bytes(content)
    checked(path)
