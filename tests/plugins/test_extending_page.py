"""docs/extending.md: its files are the templates, they keep their contracts, and its tables choose them."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import tyrefem as tf
from tyrefem.contracts import TEMPLATES, check_file, template
from tyrefem.contracts.contract import Contract
from tyrefem.inputs.study_plugins import plugins_of
from tyrefem.materials.card import material
from tyrefem.plugins import registry

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/extending.md").read_text(encoding="utf-8")
#: The page's parts after the contracts: a Python file, then the table that chooses it.
PARTS = dict(zip(TEMPLATES, re.findall(r"^```python\n(.*?)^```\n\n```toml\n(.*?)^```", PAGE, re.M | re.S), strict=True))
COARSE = {"mesh.size": "12 mm", "mesh.element": "P1", "drive.duration": "60 s"}
Write = Callable[..., Path]


@pytest.mark.parametrize("kind", TEMPLATES)
def test_the_page_shows_the_template_and_it_keeps_its_contracts(folder: Path, kind: str) -> None:
    code, _ = PARTS[kind]
    assert code == template(kind, TEMPLATES[kind])
    file = folder / "shown.py"
    file.write_text(code, encoding="utf-8")
    checked = check_file(file)
    assert [plugin.name.split(".")[-1] for plugin, _ in checked.plugins] == [TEMPLATES[kind]]
    assert [contract.line for _, contracts in checked.plugins for contract in contracts if contract.fault] == []
    assert checked.count >= 4


def chosen(kind: str) -> dict[str, Any]:
    return tomllib.loads(PARTS[kind][1])


@pytest.mark.parametrize("kind", ["effect", "boundary-law", "tan-delta-law", "strain-law"])
def test_a_study_with_the_page_s_table_uses_it(write: Write, tmp_path: Path, kind: str) -> None:
    file = write(kind)
    table = chosen(kind)
    if kind == "effect":
        changes: dict[str, Any] = table
    else:
        changes = {f"{head}.{key}": value for head, part in table.items() for key, value in part.items()}
    study = tf.study("nasa-22x5.5-8pr", COARSE)
    changed = study.replace(changes)
    (plugin,) = plugins_of(changed)
    assert plugin.origin.file == file
    before, after = study.run().readings, changed.run().readings
    assert not before.equals(after)
    summary = changed.run().summary()["plugins"]
    assert summary == [plugin.to_dict()]
    assert set(summary[0]) == {"kind", "name", "class", "file", "version", "sha256"}
    assert study.run().summary()["plugins"] == []
    changed.run().report(tmp_path / "report.html")
    assert f"{plugin.name}, from {file}" in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("presses", [False, True])
def test_a_law_that_presses_says_so_for_the_effects_of_pressure(write: Write, presses: bool) -> None:
    """The flag of the class decides, not its name."""
    write("strain-law", ("    # The energies go", f"    presses: ClassVar[bool] = {presses}\n    # The energies go"))
    law = tomllib.loads(PARTS["strain-law"][1])["mechanics"]["strain"]
    leak = {"mechanics.strain": law, "effects": [{"name": "pressure-loss", "rate": "2 kPa/min"}]}
    warnings = tf.study("nasa-22x5.5-8pr", COARSE | leak).warnings
    assert [warning.field for warning in warnings] == ["effects.pressure-loss"] * presses


def test_the_tread_of_the_page_has_its_friction(write: Write) -> None:
    write("friction-law")
    law = material({"base": "nasa-tread", **chosen("friction-law")}).friction
    assert law is not None
    assert float(law(0.0, 3e5, 25.0)) == pytest.approx(1.1)
    assert float(law(50.0, 3e5, 25.0)) == pytest.approx(0.55)


def test_the_sweep_of_the_page_has_its_answer(write: Write, tmp_path: Path) -> None:
    write("sweep-answer")
    file = tmp_path / "sweep.toml"
    text = PARTS["sweep-answer"][1].replace("levels = 5", "levels = 2")
    file.write_text(text, encoding="utf-8")
    from tyrefem.reports.sweep_files import save
    from tyrefem.sweep.design import loaded

    changes = {**COARSE, "output.fields": 2}
    design = loaded(str(file), changes).answered(reduced="never")
    rows = design.answers["highest"].table
    assert rows["contained-air_degC"].is_monotonic_decreasing
    summary = save(design, tmp_path / "out")
    assert {path.name for path in (tmp_path / "out").iterdir()} >= {"highest.csv", "highest.parquet", "sweep.html"}
    assert "Highest values" in (tmp_path / "out/sweep.html").read_text(encoding="utf-8")
    assert [entry["name"] for entry in summary["plugins"]] == ["highest"]


#: Replaces the template's `rows`.
ROWS = "return ordered.head(self.settings.most).reset_index(drop=True)"
#: Replaces its `sentences`.
SENTENCES = "highest = rows.iloc[0]"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ((ROWS, "return ordered.hottest_degC"), "rows: must give a pandas DataFrame, not Series"),
        ((ROWS, "return ordered.assign(mixed=[1.0, 'two'])"), "rows: column 'mixed' must have numbers only or texts"),
        ((ROWS, "return ordered.assign(phase=[1j, 2j])"), "rows: column 'phase' must have numbers only or texts"),
        ((ROWS, "return ordered.rename(columns={'by': 0})"), "rows: columns must be named by text, not 0"),
        ((ROWS, "return ordered.rename(columns={'by': 'failure'})"), "rows: has two columns 'failure'"),
        ((ROWS, "raise SystemExit(3)"), "rows: SystemExit: 3"),
        ((SENTENCES, "return 'the highest'"), "sentences: must give a list of texts, not 'the highest'"),
        ((SENTENCES, "return None"), "sentences: must give a list of texts, not None"),
    ],
)
def test_an_answer_that_cannot_be_written_names_file_class_and_column(
    write: Write, change: tuple[str, str], words: str
) -> None:
    file = write("sweep-answer", change)
    design = tf.study("nasa-22x5.5-8pr", COARSE).sweep(
        {"drive.speed": ["10 mph", "20 mph"]}, reduced="never", highest={}
    )
    with pytest.raises(tf.InputError) as error:
        _ = design.answers["highest"].words
    assert str(error.value).startswith(f"{file}: class Highest, ")
    assert words in str(error.value)


def test_a_named_index_of_an_answer_becomes_a_column(write: Write) -> None:
    speeds = "ordered.groupby('drive.speed [mph]')[['hottest_degC', 'variant']].max()"
    write("sweep-answer", (ROWS, f"return {speeds}"), (SENTENCES, "highest = rows.loc[20.0]"))
    design = tf.study("nasa-22x5.5-8pr", COARSE).sweep(
        {"drive.speed": ["10 mph", "20 mph"]}, reduced="never", highest={}
    )
    answer = design.answers["highest"]
    assert list(answer.table["drive.speed [mph]"]) == [10.0, 20.0]
    assert answer.to_dict()["rows"][1]["drive.speed [mph]"] == 20.0
    assert "in variant 2" in answer.words[0]


def test_sentences_do_not_change_the_table_of_their_answer(write: Write) -> None:
    """A table that was written before the sentences were made was another than after."""
    write("sweep-answer", (SENTENCES, "rows['hottest_degC'] += 1e3; highest = rows.iloc[0]"))
    answer = tf.study("nasa-22x5.5-8pr", COARSE).sweep({"drive.speed": ["10 mph"]}, reduced="never", highest={}).answers
    assert "is 10" in answer["highest"].words[0]
    assert answer["highest"].table["hottest_degC"].iloc[0] < 100


def test_an_edited_answer_takes_up_the_finished_variants(write: Write, folder: Path, tmp_path: Path) -> None:
    """A sweep of days does not run again because its user's answer failed: no variant depends on it."""
    from tyrefem.plugins import use

    write("sweep-answer", (ROWS, "raise ValueError('wrong')"))
    study, speeds = tf.study("nasa-22x5.5-8pr", COARSE), {"drive.speed": ["10 mph", "20 mph"]}
    design = study.sweep(speeds, reduced="never", folder=tmp_path / "kept", highest={})
    with pytest.raises(tf.InputError, match="wrong"):
        _ = design.answers["highest"].table
    write("sweep-answer")
    use(folder)
    design = study.sweep(speeds, reduced="never", folder=tmp_path / "kept", highest={})
    assert design.swept is not None
    assert design.swept.resumed == 2
    assert len(design.answers["highest"].table) == 2
    # A law of the same file takes part in the variants.
    file = write("tan-delta-law")
    both = file.read_text(encoding="utf-8") + (folder / "highest.py").read_text(encoding="utf-8")
    file.write_text(both, encoding="utf-8")
    (folder / "highest.py").unlink()
    use(folder)
    with pytest.raises(tf.InputError, match=r"another sweep \(another study, version, plugin or plan\)"):
        study.sweep(speeds, reduced="never", folder=tmp_path / "kept", highest={})


@pytest.mark.parametrize("key", ["indices", "mesh", "words", "scheduler", "sample"])
def test_an_answer_does_not_take_a_name_of_the_summary_or_of_an_option(write: Write, key: str) -> None:
    write("sweep-answer", ('key: ClassVar[str] = "highest"', f'key: ClassVar[str] = "{key}"'))
    with pytest.warns(tf.errors.PluginWarning, match=f"'{key}': has the name of another table, file or option"):
        assert registry().plugins == ()


def test_a_broken_contract_is_said_in_words(write: Write) -> None:
    file = write("tan-delta-law", ("np.exp(self.activation", "np.mean(temperature) * np.exp(self.activation"))
    (_, contracts) = check_file(file).plugins[0]
    faults: list[Contract] = [contract for contract in contracts if contract.fault]
    assert any("tan_delta(-40 to 200 degC, 10 Hz) must be finite numbers" in str(each.fault) for each in faults)


@pytest.mark.parametrize(
    ("kind", "change", "words"),
    [
        ("effect", ("return self.shine", "return 1 + self.shine"), "flux gives 1.0 at null; it must give 0"),
        ("effect", ("return self.shine", "return self.shine * x[0] / x[0].sum()"), "at a point among"),
        ("tan-delta-law", ("self.value *", "frequency**0.1 * self.value *"), "of_frequency: ClassVar[bool] = True"),
        ("strain-law", ("self.ratio**2", "self.ratio"), "twice the deflection gives"),
        ("strain-law", ("in self.section.regions)", "in self.section.regions[1:])"), "have none, and no heat"),
        ("boundary-law", ('{"at_10_m_s": "30 W/m**2/K"}', "{}"), "give values in example"),
        ("sweep-answer", ("return ordered", "return []\n        return ordered"), "a pandas DataFrame, not list"),
        ("friction-law", ('law: Literal["falling"]', 'law: str = "falling"'), "has no name, so nothing can use it"),
    ],
)  # fmt: skip
def test_what_breaks_a_contract(write: Write, kind: str, change: tuple[str, str], words: str) -> None:
    checked = check_file(write(kind, change))
    assert checked.failed >= 1
    assert words in "\n".join(checked.lines)


def test_a_file_without_a_plugin_is_refused(folder: Path) -> None:
    (folder / "nothing.py").write_text("x = 1\n", encoding="utf-8")
    with pytest.raises(tf.InputError, match="has no plugin"):
        check_file(folder / "nothing.py")
    assert registry().plugins == ()
