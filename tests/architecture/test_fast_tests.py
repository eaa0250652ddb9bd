"""`pytest -m fast` looks into every folder of tests."""

from __future__ import annotations

from pathlib import Path

import pytest
from long_files import LONG

TESTS = Path(__file__).resolve().parents[1]
#: Folders whose tests run every command, which takes its time.
WHOLE = {"hostile"}
FOLDERS = sorted({file.parent for file in TESTS.glob("*/test_*.py")} - {TESTS / name for name in WHOLE})

pytestmark = pytest.mark.fast


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_every_folder_has_fast_tests(folder: Path) -> None:
    texts = [file.read_text(encoding="utf-8") for file in folder.glob("test_*.py")]
    assert any("pytest.mark.fast" in text for text in texts), "mark a quick file with pytestmark = pytest.mark.fast"


def test_long_files_are_there() -> None:
    assert [name for name in LONG if not (TESTS / name).is_file()] == []
    assert len(set(LONG)) == len(LONG)
