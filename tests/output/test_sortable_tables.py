"""Tables of the pages are sorted by a click on a heading: in a real browser, with the pages' own script."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest

TEMPLATES = Path(__file__).parents[2] / "tyrefem" / "reports"
SCRIPT = (TEMPLATES / "sortable.html.j2").read_text(encoding="utf-8")
#: The tables of explore.html are written anew while a slider moves.
LIVE = "explore.html"
PAGES = [*(page for page in TEMPLATES.glob("*.html") if page.name != LIVE), TEMPLATES / "run.html.j2"]
TABLE = """<table id="t"><thead>
<tr><th>name</th><th>kPa</th><th>mixed</th><th>drift</th><th></th><th>W</th><th>time</th></tr></thead><tbody>
<tr><td>run-10</td><td>1,200</td><td>0.25 mm</td><td>+0.50 ± 0.1 K</td><td>a</td><td>10 460</td><td>90 s (a)</td></tr>
<tr><td>run-9</td><td></td><td>2 kPa</td><td>−2.00 ± 0.1 K</td><td>b</td><td>1 234 567</td><td>45 s</td></tr>
<tr><td>Run-2</td><td>90.5</td><td>0.3 mm</td><td>+1e1 ± 3 K</td><td>c</td><td>9870</td><td>-5 s</td></tr>
<tr><td>run-1</td><td>-3e2</td><td>–</td><td>+0.50 ± 0.1 K</td><td>d</td><td>95.5</td><td>200 s (b)</td></tr>
</tbody></table><table id="f" data-fixed><thead><tr><th>x</th></tr></thead><tbody><tr><td>1</td></tr><tr><td>2</td></tr>
</tbody></table>"""
#: Clicks on a heading of the table `t`, and what the table is then: its last column, and the headings' order.
CLICKS = """<pre id="out"></pre><script>
const table = document.getElementById("t"), seen = [];
for (const column of CLICKED) {
  table.tHead.rows[0].cells[column].querySelector("button").click();
  seen.push([Array.from(table.tBodies[0].rows).map(row => row.cells[4].textContent).join(""),
             Array.from(table.tHead.rows[0].cells).map(cell => cell.getAttribute("aria-sort"))]);
}
document.getElementById("out").textContent = JSON.stringify(seen);
</script>"""


def in_browser(page: str, folder: Path) -> str:
    """The page after its scripts have run, as text."""
    (folder / "page.html").write_text(page, encoding="utf-8")
    command = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder / 'profile'}"]
    url = (folder / "page.html").as_uri()
    shown = subprocess.run([*command, "--dump-dom", url], check=True, capture_output=True, timeout=120)
    return shown.stdout.decode("utf-8")


def after_clicks(columns: list[int], folder: Path) -> list[tuple[str, list[str | None]]]:
    clicks = CLICKS.replace("CLICKED", json.dumps(columns))
    page = f"<!doctype html><meta charset=utf-8><body>{TABLE}{SCRIPT}{clicks}</body>"
    out = re.search(r'<pre id="out">(.*?)</pre>', in_browser(page, folder), re.DOTALL)
    assert out is not None
    return [tuple(entry) for entry in json.loads(out[1])]


@pytest.mark.usefixtures("needs_chromium")
def test_a_click_sorts_up_then_down_then_as_written(tmp_path: Path) -> None:
    up, down, back, pressures, again, powers = after_clicks([0, 0, 0, 1, 1, 5], tmp_path)
    # Names with numbers in them, in the order of the numbers.
    assert up == ("dcba", ["ascending", None, None, None, None, None, None])
    assert down == ("abcd", ["descending", None, None, None, None, None, None])
    assert back == ("abcd", [None] * 7)
    # Numbers with thousands, signs and exponents; the empty cell is last both ways.
    assert pressures == ("dcab", [None, "ascending", None, None, None, None, None])
    assert powers[0] == "dcab"
    assert again == ("acdb", [None, "descending", None, None, None, None, None])


@pytest.mark.usefixtures("needs_chromium")
def test_different_units_are_grouped_and_equal_rows_keep_their_order(tmp_path: Path) -> None:
    """In a unit by size, also below zero and after the point; a time in other words in brackets is no other unit."""
    mixed, again, drift, times = after_clicks([2, 2, 3, 6], tmp_path)
    assert mixed[0] == "bacd"
    assert again[0] == "cabd"
    assert drift[0] == "badc"
    assert times[0] == "cbad"


@pytest.mark.usefixtures("needs_chromium")
def test_headings_are_buttons_for_the_keyboard_and_the_report_s_tables_have_them(result, tmp_path: Path) -> None:
    shown = in_browser(f"<!doctype html><meta charset=utf-8>{TABLE}{SCRIPT}", tmp_path)
    assert shown.count('<button type="button" class="sort">') == 6
    assert shown.count('scope="col"') == 6
    assert "tabindex" not in shown
    page = result.report(tmp_path / "report.html").read_text(encoding="utf-8")
    report = in_browser(page, tmp_path)
    heads = re.findall(r"<thead>.*?</thead>", report, re.DOTALL)
    assert sum('class="sort"' in head for head in heads) >= 5
    assert len(re.findall("<table data-fixed", report)) == 2
    budget = report.split("<h2>Heat budget</h2>")[1].split("</thead>")[0]
    assert "<button" not in budget


@pytest.mark.fast
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_page_has_the_script_once(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert text.count('{% include "sortable.html.j2" %}') == 1
    # Sorting needs headings apart from rows.
    assert text.count("<table") == text.count("<thead>") == text.count("<tbody>")


@pytest.mark.fast
def test_the_script_fetches_nothing_and_prints_plain() -> None:
    assert not re.search(r"https?:|src=|href=|import|fetch|eval|innerHTML", SCRIPT)
    assert "all: unset" in SCRIPT
