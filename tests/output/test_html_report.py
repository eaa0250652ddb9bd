"""The report: one file, nothing fetched, nothing injected, the summary's numbers in it."""

from __future__ import annotations

import base64
import html
import re
from html.parser import HTMLParser

import pytest

import tyrefem as tf
from tyrefem.geometry.place_names import place
from tyrefem.reports.figures import pictures
from tyrefem.reports.materials import material_rows
from tyrefem.reports.words import number

VOID = {"meta", "img", "br", "link", "input", "hr"}
NAME = '<b onclick="x()">$hot$ & "cold"</b>'


class Page(HTMLParser):
    """Tags with their attributes, the text outside styles and scripts, and whether every tag is closed in its order."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.tags, self.words, self.open, self.attributes = [], [], [], []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if not self.open or self.open[-1] not in ("style", "script"):
            self.words.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())


@pytest.fixture(scope="module")
def written(result, tmp_path_factory):
    path = result.report(tmp_path_factory.mktemp("report") / "deep" / "report.html")
    return path.read_text(encoding="utf-8")


@pytest.mark.parametrize("run", ["result", "quadratic", "standing", "stopped", "phased"])
def test_self_contained_and_well_formed(run, request, tmp_path):
    text = request.getfixturevalue(run).report(tmp_path / "report.html").read_text(encoding="utf-8")
    page = Page(text)
    assert not {"link", "iframe", "object", "a", "base", "form"} & set(page.tags)
    assert page.tags.count("script") == 1  # sorts the tables
    linked = [value for key, value in page.attributes if key in ("src", "href")]
    assert linked
    assert all(value.startswith("data:image/png;base64,") for value in linked)
    assert not [key for key, _ in page.attributes if key.startswith("on")]
    assert "url(" not in text
    assert "@import" not in text
    assert [file.name for file in tmp_path.iterdir()] == ["report.html"]


def test_the_pictures_are_those_of_the_folder(result, written):
    embedded = [base64.b64decode(data) for data in re.findall(r"base64,([^\"]+)", written)]
    assert embedded == list(pictures(result).values())


def test_the_numbers_of_the_summary_come_first(result, written):
    text, summary = Page(written).text, result.summary()
    top = text[: text.index("Pictures")]
    assert f"{summary['hottest']['temperature_degC']:.1f} °C" in top
    assert summary["hottest"]["region"] in top
    assert f"{number(summary['rolling_resistance']['force_N'], 3)} N" in top
    assert f"coefficient {number(summary['rolling_resistance']['coefficient'], 3)}" in top
    assert f"{summary['contained_air']['temperature_degC']:.1f} °C" in top
    assert f"{number(summary['contained_air']['gauge_pressure_Pa'] / 1e3)} kPa gauge" in top
    assert f"{summary['phases'][0]['deflection'] * 1e3:.1f} mm" in top
    assert f"{number(result.heat_budget.total('generated') / 1e3)} kJ" in top


def test_tables_hold_the_summary(result, written):
    text, summary = Page(written).text, result.summary()
    for name, reading in summary["sensors"].items():
        assert re.search(rf"{re.escape(name)} .*? {reading['end_degC']:.1f} {reading['max_degC']:.1f} ", text)
    for kind in ("generated", "stored", "lost"):
        for name, entry in summary["heat_budget"][kind].items():
            assert f"{name} {number(entry['energy_J'] / 1e3)} {number(entry['power_W'])}" in text
    assert "of that contained air: stored" in text
    for row in summary["extremes"]:
        assert f"{row['temperature_degC']:.1f} {number(row['time_s'])} {row['r_m'] * 1e3:.1f}" in text
    assert f"{summary['mesh']['nodes']} nodes, {summary['mesh']['elements']} quads" in text
    assert f"scikit-fem {summary['versions']['scikit-fem']}" in text


def test_materials_name_their_sources_and_mark_estimates(result, written):
    text = Page(written).text
    for card in result.study.materials.values():
        assert card.title in text
        assert " ".join(card.conductivity.source.split()) in text
    guesses = written.count('<span class="guess">')
    # A run does not use the tables of life, wear and friction; its report does not list them.
    of_other_commands = {"fatigue", "wear", "friction"}
    marked = [
        name
        for card in result.study.materials.values()
        for name in sorted(set(type(card).model_fields) - of_other_commands)
        if "estimate" in (getattr(getattr(card, name), "source", None) or "").lower()
    ]
    assert guesses == len(marked) > 0


def test_limits_are_stated(written):
    text = Page(written).text
    for words in (
        "barrel",
        "once per revolution",
        "averaged out",
        "TR R-64",
        "illegible in the scan",
        "not been validated",
    ):
        assert words in text


def test_names_cannot_inject(quadratic, tmp_path):
    text = quadratic.report(tmp_path / "report.html").read_text(encoding="utf-8")
    page = Page(text)
    assert NAME in page.text
    assert html.escape(NAME, quote=False).replace('"', "&#34;") in text
    assert text.count("<script") == 1
    assert "<b onclick" not in text
    assert "alert('title')" in page.text


def test_interrupted_runs_say_so_on_top(stopped, written, tmp_path):
    text = Page(stopped.report(tmp_path / "report.html").read_text(encoding="utf-8")).text
    top = text[: text.index("Pictures")]
    assert f"interrupted at {number(stopped.times[-1])} s of 120 s" in top
    assert "(cut short)" in text
    assert "interrupted" not in Page(written).text


def test_a_tyre_that_stands_reports_no_drag(standing, tmp_path):
    text = Page(standing.report(tmp_path / "report.html").read_text(encoding="utf-8")).text
    assert "Rolling resistance" not in text
    assert "Lumped bodies" in text
    assert "rim" in text
    assert "hermocouple" not in text
    assert "nan" not in text.lower().replace("nano", "")


def test_several_phases(phased, tmp_path):
    text = Page(phased.report(tmp_path / "report.html").read_text(encoding="utf-8")).text
    assert "phase roll" in text
    assert re.search(r"roll 0 – 120 17\.88 ", text)
    assert re.search(r"stand 120 – 720 0\.00 ", text)


def test_the_study_file_as_written_or_as_run(written, tmp_path):
    import tyrefem as tf

    assert "Study file as run" in written
    assert "5 mm" in written
    plain = tf.study("nasa-22x5.5-8pr")
    from tyrefem.reports.inputs import study_text

    text, as_written = study_text(plain)
    assert as_written
    assert text == plain.file.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("s", "depth", "words"),
    [
        (0.0, 0.0, "at the crown centre, at the inner surface"),
        (0.03, 0.004, "in the crown, 4.0 mm from the inner surface"),
        (-0.056, 1.0, "at the shoulder, at the outer surface"),
        (0.08, 0.0, "in the upper sidewall, at the inner surface"),
        (0.14, 0.005, "in the bead, 5.0 mm from the inner surface"),
    ],
)
def test_places_in_words(study, s, depth, words):
    assert place(study.section, s, depth) == words


def test_a_small_standard_deviation_is_not_rounded_to_nothing():
    card = {"base": "nasa-tread", "density": {"relative_sd": 0.004}, "specific_heat": {"relative_sd": 0.25}}
    rows, _ = material_rows(tf.study("nasa-22x5.5-8pr", {"materials.tread": card}))
    assert {"± 0.4 %", "± 25 %"} <= {row["cells"][4].removesuffix(", not used here") for row in rows}
