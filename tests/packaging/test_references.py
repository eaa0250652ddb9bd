"""What a file is referred to for is in it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TEXTS = sorted(
    path
    for pattern in ("tyrefem/**/*.py", "tyrefem/**/*.j2", "tyrefem/**/*.html", "docs/**/*.md", "*.md", "studies/*/*.md",
                    "studies/*/*.toml", "materials/*.toml", "geometry/*.toml")
    for path in ROOT.glob(pattern)
)  # fmt: skip


def test_every_page_that_is_named_is_there() -> None:
    missing = {
        f"{path.relative_to(ROOT)}: {name}"
        for path in TEXTS
        for name in re.findall(r"\bdocs/[\w/-]+\.(?:md|png)", path.read_text(encoding="utf-8"))
        if not (ROOT / name).is_file()
    }
    assert missing == set()


REFERENCE = re.compile(r"#\s*(\w+)\b.*\bsee (?:the README of ([\w.-]*\w)|(docs/[\w/-]+\.md|README\.md))")
REFERENCES = [
    (study, *match.groups())
    for study in sorted(ROOT.glob("studies/*/study.toml"))
    for match in map(REFERENCE.search, study.read_text(encoding="utf-8").splitlines())
    if match is not None
]


def test_studies_refer_to_pages() -> None:
    assert len(REFERENCES) > 2


@pytest.mark.parametrize(
    ("study", "symbol", "other", "page"), REFERENCES, ids=[f"{row[0].parent.name}-{row[1]}" for row in REFERENCES]
)
def test_the_page_that_a_study_refers_to_for_a_symbol_has_it(
    study: Path, symbol: str, other: str | None, page: str | None
) -> None:
    """``poisson_term = 0.7  # c_a of eq 7a: ..., see README.md``: the page tells of c_a."""
    if other is not None:
        file = study.parents[1] / other / "README.md"
    else:
        assert page is not None
        file = ROOT / page if page.startswith("docs/") else study.parent / page
    assert symbol in file.read_text(encoding="utf-8")
