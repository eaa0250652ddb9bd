"""Every page is legible on a dark screen and on a phone, and stays light and whole on paper."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import tyrefem as tf
from tyrefem.reports import notebook

pytestmark = pytest.mark.fast

PAGES = [
    page
    for page in sorted(Path(notebook.__file__).parent.glob("*.html*"))
    if "<html" in page.read_text(encoding="utf-8") and page.name != "explore.html"  # its colours are in explore.css
]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_has_colours_of_a_dark_screen(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert '{% include "dark.html.j2" %}' in text or "screen and (prefers-color-scheme: dark)" in text


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_keeps_its_pictures_legible_on_a_phone_and_its_tables_whole_on_paper(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    if page.name == "diagnosis_summary.html":  # made for one sheet of paper
        assert "screen and (max-width: 44rem)" in text
    else:
        assert text.count('{% include "sizes.html.j2" %}') == 1
        assert not re.search(r"max-width: \d+rem\) |overflow: visible; max-height: none; } h", text)


def test_the_report_of_a_run_has_them(tmp_path: Path) -> None:
    study = tf.study("nasa-22x5.5-8pr", {"mesh.size": "14 mm", "drive.duration": "20 s"})
    text = Path(study.run().report(tmp_path / "report.html")).read_text(encoding="utf-8")
    (dark,) = re.findall(r"@media screen and \(prefers-color-scheme: dark\) \{(.*?)\n  \}", text, re.DOTALL)
    assert "body { color: #e4e6e9; background: #16181b; }" in dark
    assert "img { background: #fff;" in dark, "pictures are drawn for a white ground"
