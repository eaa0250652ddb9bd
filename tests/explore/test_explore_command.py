"""`tyrefem explore`: a page in its place, plain errors, nobody's files overwritten."""

from __future__ import annotations

import html
import json
import shlex
from pathlib import Path
from urllib.parse import quote

import pytest

from tyrefem.api import Study, study
from tyrefem.cli import main
from tyrefem.reports.explore_link import ExploreLink, explore_link
from tyrefem.reports.run import render

RANGES = ("--vary", "drive.speed=15 mph:20 mph", "--limit", "hottest_degC<60", "--tolerance", "1 K", "--workers", "1")


def test_the_command_writes_a_page(small: Study, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = tmp_path / "out" / "tyre.html"
    assert main(["explore", str(small.file), *RANGES, "--out", str(page), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["file"] == str(page)
    assert answer["numbers"] == ["drive.speed"]
    assert answer["worst"] <= answer["tolerance"] == 1.0
    assert answer["cases"] == 6
    assert main(["explore", str(small.file), *RANGES, "--out", str(page)]) == 0
    assert capsys.readouterr().out.startswith("1 number, ")
    text = page.read_text(encoding="utf-8")
    assert '"limits":[{"answer":"hottest_degC","below":60.0' in text
    assert {file.name for file in page.parent.iterdir()} == {"tyre.html", "tyre.toml"}
    assert study(str(page.with_suffix(".toml"))).data["drive"] == small.data["drive"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--vary", "drive.speed=15 mph,20 mph"], "no slider"),
        (["--vary", "drive.speed=20 mph:10 mph"], "must be below"),
        (["--tolerance", "0 K"], "--tolerance"),
        (["--axes", "drive.speed"], "is not KEY,KEY"),
        (["--out", "page.txt"], "must end with .html"),
        (["--limit", "hottest_degC"], "--limit"),
    ],
)
def test_bad_input_ends_with_a_line(
    arguments: list[str],
    words: str,
    small: Study,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["explore", str(small.file), "--workers", "1", *arguments]) == 2
    assert words in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_foreign_file_stays(small: Study, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = tmp_path / "tyre.toml"
    table.write_text("mine = 1")
    assert main(["explore", str(small.file), *RANGES, "--out", str(tmp_path / "tyre.html")]) == 2
    assert "tyre.toml: --out: exists and was not made by tyrefem" in capsys.readouterr().err
    assert table.read_text() == "mine = 1"
    mine = tmp_path / "mine.html"
    mine.write_text("<p>mine</p>")
    assert main(["explore", str(small.file), *RANGES, "--out", str(mine)]) == 2
    assert "--force" in capsys.readouterr().err
    assert mine.read_text() == "<p>mine</p>"


def test_reports_link_to_the_page_or_name_the_command(small: Study, tmp_path: Path) -> None:
    report = tmp_path / small.name / "report.html"
    short = small.replace({"drive": {"speed": "20 mph", "load": "10 kN", "pressure": "80 psi", "duration": "5 s"}})
    result = short.run()
    result.report(report)
    command = f"<code>tyrefem explore {shlex.quote(str(small.file))}</code>"
    assert command in html.unescape(report.read_text(encoding="utf-8"))
    (tmp_path / f"{small.name}-explore.html").write_text("")
    result.report(report)
    link = f'<a href="../{quote(small.name)}-explore.html">'
    assert link in report.read_text(encoding="utf-8")
    design = short.sweep({"drive.speed": ["10 mph", "20 mph"]}, answers=["hottest_degC"])
    page = design.save(tmp_path / f"{small.name}-sweep") / "sweep.html"
    assert link in page.read_text(encoding="utf-8")


def test_a_link_to_a_page_with_a_number_sign_in_its_name(small: Study) -> None:
    """What follows ``#`` would be a place in the page."""
    short = small.replace({"drive.phases.rolling.duration": "20 s", "drive.phases.standing.duration": "20 s"})
    text = render(short.run(), ExploreLink("../tyre #2 ü-explore.html", ""))
    assert '<a href="../tyre%20%232%20%C3%BC-explore.html">../tyre #2 ü-explore.html</a>' in text


def test_the_command_names_the_study_of_the_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A study elsewhere that has the name of a shipped one goes by its path, and blanks are quoted."""
    monkeypatch.chdir(tmp_path)
    shipped = study("nasa-22x5.5-8pr")
    mine = tmp_path / "my tyres" / "nasa-22x5.5-8pr" / "study.toml"
    mine.parent.mkdir(parents=True)
    mine.write_bytes(Path(str(shipped.file)).read_bytes())
    for one, command in (
        (shipped, "tyrefem explore nasa-22x5.5-8pr"),
        (study(str(mine)), "tyrefem explore 'my tyres/nasa-22x5.5-8pr/study.toml'"),
    ):
        link = explore_link(one, tmp_path / "report.html")
        assert link is not None
        assert link.command == command
