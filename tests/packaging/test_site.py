"""The documentation as a site: every page has its place, examples assert, verification cases say their source.

`.ci/run` builds the site, which runs the examples; here is what can be seen without building it.
"""

from __future__ import annotations

import ast
import importlib
import importlib.util
import json
import re
import sys
from collections import Counter
from pathlib import Path
from types import ModuleType

import pytest

import tyrefem as tf

pytestmark = pytest.mark.fast

ROOT = Path(__file__).resolve().parents[2]
SITE = ROOT / "site"
TOCTREE = re.compile(r"^```\{toctree\}\n(.*?)^```", re.DOTALL | re.MULTILINE)
GALLERY = sorted((SITE / "gallery").rglob("*.py"))
CASES = sorted((SITE / "verification").rglob("*.py"))


def module(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"site_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    loaded = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


def relative(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def entries() -> Counter[Path]:
    """Pages of the repository named in the lists of contents of the site's pages, patterns written out."""
    named: Counter[Path] = Counter()
    for page in SITE.rglob("*.md"):
        if "_build" in page.parts:
            continue
        # A page of the site lies as if this folder were the repository.
        folder = (ROOT / page.relative_to(SITE)).parent
        for block in TOCTREE.findall(page.read_text(encoding="utf-8")):
            for line in filter(None, (line.strip() for line in block.splitlines())):
                if not line.startswith(":"):
                    pattern = (folder / f"{line}.md").resolve().relative_to(ROOT).as_posix()
                    named.update(ROOT.glob(pattern))
    return named


def test_every_page_of_the_repository_stands_once_in_the_contents() -> None:
    pages = module(SITE / "build.py").pages_of_repository()
    assert len(pages) > 60
    counts = entries()
    assert {relative(page): counts[page] for page in pages if counts[page] != 1} == {}, (
        "name the page in a toctree of site/guide.md or site/about/index.md"
    )


def test_howto_pages_stand_in_their_contents() -> None:
    index = (SITE / "howto" / "index.md").read_text(encoding="utf-8")
    listed = {line.strip() for block in TOCTREE.findall(index) for line in block.splitlines() if line.strip()}
    assert {page.stem for page in (SITE / "howto").glob("*.md")} - {"index"} == listed - {":maxdepth: 1"}


def test_links_of_howto_pages_lead_to_pages_of_the_site() -> None:
    """They hold in the repository (test_docs_pages.py), and, as copied, in the source folder of Sphinx."""
    build = module(SITE / "build.py")
    places = build.sources()
    pages = {ROOT / place for place in places} | {
        (ROOT / file.relative_to(SITE)).with_suffix(".rst") for file in GALLERY
    }
    dead = [
        f"{place}: {target}"
        for place, file in places.items()
        if place.match("howto/*.md") and place.stem != "index"
        for target in build.LINK.findall(build.as_copied(place, file).decode())
        if (ROOT / place.parent / target).resolve() not in pages
    ]
    assert dead == []


@pytest.mark.parametrize("example", GALLERY, ids=relative)
def test_an_example_is_one_screen_with_a_figure_and_an_assertion(example: Path) -> None:
    text = example.read_text(encoding="utf-8")
    tree = ast.parse(text)
    title, line = (ast.get_docstring(tree) or "").splitlines()[:2]
    assert set(line) == {"="}
    assert len(line) >= len(title)
    assert any(isinstance(node, ast.Assert) for node in ast.walk(tree)), "asserts a number against a source"
    assert text.count(".show()") == 1, "one figure"
    code = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    assert len(code) < 65, "one screen"


@pytest.mark.parametrize("case", CASES, ids=relative)
def test_a_case_says_problem_and_source_and_holds_results_beside_references(case: Path) -> None:
    text = case.read_text(encoding="utf-8")
    words = ast.get_docstring(ast.parse(text)) or ""
    assert "**Problem.**" in words
    assert "**Source.**" in words
    assert "ReferenceTable(" in text
    assert "table.add(" in text
    assert text.rstrip().endswith("\ntable")


def test_every_kind_of_plugin_has_a_page_of_the_gallery() -> None:
    from tyrefem.contracts import TEMPLATES, template

    texts = [path.read_text(encoding="utf-8") for path in GALLERY if path.parent.name == "6-extend"]
    for kind, name in TEMPLATES.items():
        bases = set(re.findall(r"^class \w+\((\w+)\):$", template(kind, name), re.MULTILINE)) - {"Card"}
        words = [f'template("{kind}"', *(f"({base}):" for base in bases)]
        assert any(word in text for text in texts for word in words), kind


def test_cases_and_examples_have_names_of_their_own() -> None:
    names = Counter(path.stem for path in [*GALLERY, *CASES])
    assert {name for name, count in names.items() if count > 1} == set()
    assert len(GALLERY) >= 24
    assert len(CASES) >= 25


def test_the_reference_has_every_public_name() -> None:
    text = (SITE / "reference" / "python.rst").read_text(encoding="utf-8")
    listed = [name.rpartition(".") for name in re.findall(r"^   (tyrefem(?:\.\w+)+)$", text, re.MULTILINE)]
    objects = {getattr(importlib.import_module(room), name) for room, _, name in listed}
    missing = {name for name in tf.__all__ if name != "__version__" and getattr(tf, name) not in objects}
    assert missing == set()


def test_a_row_beyond_its_limit_is_refused() -> None:
    table = module(SITE / "extensions" / "reference_table.py").ReferenceTable("A case", "closed form", "by hand")
    table.add("temperature", 20.5, 20.0, "degC", within=0.6)
    with pytest.raises(AssertionError, match=r"temperature: 20.5, not 20 degC"):
        table.add("temperature", 20.5, 20.0, "degC", within=0.4)
    with pytest.raises(AssertionError):
        table.add("force", 102.0, 100.0, "N", percent=1)
    assert "+0.5" in table._repr_html_()
    assert "passed 1/1" in table._repr_html_()


def test_a_link_inside_the_site_that_leads_nowhere_is_named(tmp_path: Path) -> None:
    (tmp_path / "guide").mkdir()
    (tmp_path / "guide" / "a.html").write_text('<h1 id="top"></h1><a href="../b.html#place">b</a>', encoding="utf-8")
    lines = ("guide/a.html", "guide/a.html#top", "guide/", "guide/a.html#no", "no.html", "https://example.org/no")
    links = "".join(f'<a href="{line}">x</a>' for line in lines)
    (tmp_path / "b.html").write_text(f'<p id="place">{links}</p><img src="no.png">', encoding="utf-8")
    dead = list(module(SITE / "links.py").dead_links(tmp_path))
    assert dead == ["b.html: guide/", "b.html: guide/a.html#no", "b.html: no.html", "b.html: no.png"]


def test_a_server_that_is_not_reached_is_no_broken_link(tmp_path: Path) -> None:
    answers = [
        ("https://a.org/", "working", ""),
        ("https://b.org/", "broken", "404 Client Error: Not Found for url: https://b.org/"),
        ("https://c.org/", "broken", "HTTPSConnectionPool(host='c.org', port=443): Max retries exceeded"),
        ("https://d.org/", "broken", "403 Client Error: Forbidden for url: https://d.org/"),
        ("https://e.org/", "timeout", "read timed out"),
    ]
    lines = [json.dumps({"filename": "p.md", "lineno": 1, "uri": uri, "status": status, "info": info})
             for uri, status, info in answers]  # fmt: skip
    (tmp_path / "output.json").write_text("\n".join(lines), encoding="utf-8")
    broken, unreachable, answered = module(SITE / "links.py").answers_of_servers(tmp_path / "output.json")
    assert [line.split(": ")[1] for line in broken] == ["https://b.org/"]
    assert len(unreachable) == 3
    assert answered == 1
