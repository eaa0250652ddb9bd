"""`tyrefem sweep` and `Study.sweep`: what a user types, writes and gets."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest
from pyarrow import parquet

from tyrefem import load, study
from tyrefem.cli import main
from tyrefem.errors import InputError
from tyrefem.sweep.design import DesignData, loaded
from tyrefem.sweep.envelope import Envelope
from tyrefem.sweep.sweep import sweep
from tyrefem.sweep.tornado import Tornado
from tyrefem.variants.card import EnvelopeCard, SweepCard
from tyrefem.variants.plan import plan_of

TYRE = "nasa-22x5.5-8pr"
COARSE = ["--set", "mesh.size=12 mm", "--set", "numerics.tolerance=0.5 K", "--set", "drive.duration=120 s"]
QUICK = [*COARSE, "--workers", "1", "--reduced", "never"]


def test_a_grid_from_flags_to_tables_and_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    flags = ["--vary", "drive.speed=10 mph:30 mph:2", "--vary", "materials.tread=nasa-tread,rubber-tread-aircraft"]
    limits = ["--limit", "hottest_degC<40", "--time-to", "35 degC", "--answer", "crown-inner_degC"]
    command = ["sweep", TYRE, *flags, *limits, *QUICK, "--out", str(tmp_path)]
    assert main(command) == 0
    output = capsys.readouterr().out
    assert "keep the limits" in output
    table = pd.read_csv(tmp_path / "sweep.csv")
    assert len(table) == 4
    assert set(table["materials.tread"]) == {"nasa-tread", "rubber-tread-aircraft"}
    slow, fast = (table[table["drive.speed [mph]"] == speed]["hottest_degC"].to_numpy() for speed in (10, 30))
    assert (fast > slow).all()
    same = pd.read_parquet(tmp_path / "sweep.parquet")
    assert same.columns.tolist() == table.columns.tolist()
    schema = parquet.read_schema(tmp_path / "sweep.parquet")
    units = {"drive.speed [mph]": b"mph", "hottest_degC": b"degC", "mass_kg": b"kg", "time_to_limit_s": b"s"}
    assert {name: schema.field(name).metadata[b"unit"] for name in units} == units
    assert schema.field("rolling_resistance_coefficient").metadata in (None, {})
    # A variant is a name, as in a list of variants: text, from either file.
    record = load(tmp_path)
    assert same["variant"].tolist() == record.table("sweep")["variant"].tolist() == ["1", "2", "3", "4"]
    (tmp_path / "sweep.parquet").unlink()
    assert load(tmp_path).table("sweep")["variant"].tolist() == ["1", "2", "3", "4"]
    assert same["hottest_degC"].tolist() == pytest.approx(table["hottest_degC"].tolist(), rel=1e-8)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["complete"]
    assert summary["sample"]["finished"] == {"full": 4, "reduced": 0, "failed": 0}
    page = (tmp_path / "sweep.html").read_text()
    assert page.index("Answers and main effects") < page.index("data:image/png")
    assert "http" not in page.split("</style>")[1]
    # The same command runs nothing again.
    assert main([*command, "--json", "--no-pictures"]) == 0
    assert json.loads(capsys.readouterr().out)["sample"]["taken_up"] == 4


def test_every_question_in_one_file_on_one_page(tmp_path: Path) -> None:
    (tmp_path / "sweep.toml").write_text(
        f"""
title = "All questions"
study = "{TYRE}"
sample = "saltelli"
count = 2
[change]
"mesh.size" = "12 mm"
"numerics.tolerance" = "0.5 K"
"drive.duration" = "60 s"
[vary]
"drive.speed" = {{ from = "10 mph", to = "30 mph" }}
materials.tread.loss_tangent.value = {{ factor = [0.8, 1.2] }}
[limits]
hottest_degC = {{ below = 34 }}
[tornado]
tolerances = {{ "drive.load" = "5 %" }}
[optimise]
maximise = "load_N"
runs = 20
[envelope]
below = 33
loads = ["2000 lbf", "2700 lbf"]
""",
        encoding="utf-8",
    )
    out = tmp_path / "out"
    assert main(["sweep", str(tmp_path), "--workers", "1", "--reduced", "never", "--out", str(out)]) == 0
    for name in ("sweep", "pareto", "indices", "tornado", "optimum", "envelope"):
        assert len(pd.read_csv(out / f"{name}.csv")) == len(pd.read_parquet(out / f"{name}.parquet"))
    page = (out / "sweep.html").read_text()
    for heading in (
        "Optimum",
        "Answers and main effects",
        "Sobol indices",
        "Which tolerance matters",
        "Safe operating envelope",
    ):
        assert f"<h2>{heading}</h2>" in page
    tornado = pd.read_csv(out / "tornado.csv").set_index("answer")
    assert tornado.loc["hottest_degC", "less"] < 0 < tornado.loc["hottest_degC", "more"]
    optimum = json.loads((out / "summary.json").read_text())["optimum"]
    assert optimum["answers"]["hottest_degC"] < 34


def test_from_python(tmp_path: Path) -> None:
    coarse = study(TYRE, {"mesh.size": "12 mm", "numerics.tolerance": "0.5 K", "drive.duration": "60 s"})
    design = coarse.sweep(
        {"drive.speed": ("10 mph", "30 mph", 3)}, pareto={"hottest_degC": "min", "deflection_m": "min"}, reduced="never"
    )
    assert design.table["hottest_degC"].is_monotonic_increasing
    assert design.pareto["variant"].tolist() == ["1"]
    assert design.tornado is None
    assert design.optimum is None
    design.save(tmp_path, pictures=False)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "pareto.csv", "pareto.parquet", "study.toml", "summary.json", "sweep.csv", "sweep.parquet"
    ]  # fmt: skip


def test_one_failing_variant_ends_with_1_and_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    # Each end is possible beside the study's own load and pressure, the heaviest at the softest is not.
    box = ["--vary", "drive.load=2700 lbf,8000 lbf", "--vary", "drive.pressure=20 psi,83 psi"]
    assert main(["sweep", TYRE, *box, *QUICK, "--out", str(tmp_path), "--no-pictures"]) == 1
    assert "variant 3:" in capsys.readouterr().err
    assert (pd.read_csv(tmp_path / "sweep.csv")["failure"].notna()).tolist() == [False, False, True, False]


def test_a_search_with_a_failed_variant_ends_with_1_and_tells_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    box = ["--vary", "drive.load=2700 lbf,8000 lbf", "--vary", "drive.pressure=20 psi,83 psi"]
    search = ["--minimise", "deflection_m", "--out", str(tmp_path), "--no-pictures"]
    assert main(["sweep", TYRE, *box, *QUICK, *search]) == 1
    assert "tyrefem: optimum: variant 3: drive.load: " in capsys.readouterr().err
    assert list(json.loads((tmp_path / "summary.json").read_text())["failures"]) == ["optimum: variant 3"]
    assert load(tmp_path).complete


def test_failed_runs_of_every_answer_are_failures_of_the_design() -> None:
    quick = study(TYRE, {"mesh.size": "14 mm", "numerics.tolerance": "0.5 K", "drive.duration": "60 s"})
    plan = plan_of(quick, {"drive.load": ["2700 lbf", "8000 lbf"], "drive.pressure": ["20 psi", "83 psi"]})
    swept = sweep(plan, reduced="never")
    rows = pd.DataFrame({"load": ["8 kN", "9 kN"], "pressure": ["2 bar", "2 bar"], "failure": ["", "bursts"]})
    asked = EnvelopeCard.check({"below": 90.0})
    answers = {"tornado": Tornado(swept, ("hottest_degC",)), "envelope": Envelope(quick, asked, rows, 2)}
    design = DesignData(quick, SweepCard.check({"study": TYRE, "tornado": {}}), None, None, answers)
    failures = design.failures
    assert list(failures) == ["tornado: 3", "envelope: 9 kN at 2 bar"]
    assert failures["envelope: 9 kN at 2 bar"] == "bursts"
    assert design.failed == {}


SPEEDS = ["--vary", "drive.speed=10 mph:20 mph"]


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        ([], "nothing varies"),
        (["--vary", "drive.sped=10 mph:20 mph"], "did you mean 'speed'"),
        (["--vary", "drive.speed=10 kg:20 kg"], "not a unit of this quantity"),
        (["--vary", "drive.speed=10 mph,10 mph"], "vary.drive.speed: '10 mph' is given twice"),
        (["--vary", "drive.speed=10 mph,4.4704 m/s"], "vary.drive.speed: '4.4704 m/s' is given twice: it is '10 mph'"),
        ([*SPEEDS, "--vary", "drive.speed=1 mph:2 mph"], "--vary: 'drive.speed' is given twice"),
        ([*SPEEDS, "--pareto", "mass_kg=min", "--pareto", "mass_kg=max"], "--pareto: 'mass_kg' is given twice"),
        (["--vary", "materials.tread=nasa-tread,nasa-tred"], "did you mean 'nasa-tread'"),
        ([*SPEEDS, "--limit", "hotest_degC<100"], "did you mean 'hottest_degC'"),
        ([*SPEEDS, "--limit", "hottest_degC<100 degC"], "without a unit"),
        ([*SPEEDS, "--limit", "time_to_limit_s>10"], "time_to"),
        ([*SPEEDS, "--answer", "crown_degC"], "did you mean 'crown-"),
        ([*SPEEDS, "--pareto", "mass_kg=least"], "'least' is not allowed; allowed: max, min"),
        ([*SPEEDS, "--sample", "sobl", "--count", "4"], "--sample: 'sobl' is not allowed; did you mean 'sobol'?"),
        ([*SPEEDS, "--indices", "8"], "at least two numbers"),
        ([*SPEEDS, "--minimise", "mas_kg"], "did you mean 'mass_kg'"),
        ([*SPEEDS, "--runs", "30"], "needs --minimise"),
        (["--tornado", "--tolerance-of", "materials.tred.density.value=5%"], "did you mean 'tread'"),
        (["--envelope", "hottest_degC<90", "--loads", "2 kg"], "envelope.loads"),
        (["--cases", "none.csv"], "none.csv"),
        ([*SPEEDS, "--reduced", "perhaps"], "--reduced: 'perhaps' is not allowed; allowed: auto, never, always"),
        ([*SPEEDS, "--tolerance", "0 K"], "--tolerance: must be positive, not 0 K"),
        ([*SPEEDS, "--limit", "hottest_degC<1e400"], "--limit: '1e400' is not a number"),
        (["--tornado", "--tolerance-of", "title=5%"], "aircraft tyre, 2700 lbf at 83 psi, 20 mph' is not a number"),
        (["--tornado", "--tolerance-of", "drive.load=5%%"], "tornado.tolerances.drive.load: '% %' in '5 % %' is not"),
        ([*SPEEDS, "--tolerance", "1 mm"], "--tolerance: 'mm' is not a unit of this quantity"),
        ([*SPEEDS, "--scheduler", "foo", "--workers", "2"], "--workers: a cluster has its workers"),
        ([*SPEEDS, "--scheduler", "foo"], "--scheduler: no Dask scheduler at 'foo': missing port number"),
    ],
)
def test_bad_input_is_one_line_before_anything_runs(
    flags: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["sweep", TYRE, *flags]) == 2
    output = capsys.readouterr().err
    assert message in output
    assert len(output.splitlines()) == 1
    assert not list(tmp_path.iterdir())


def test_a_flag_beside_a_sweep_file_is_named_itself(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", "crown-angle", "--sample", "sobl"]) == 2
    assert "tyrefem: --sample: 'sobl' is not allowed" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("rows", "flags", "message"),
    [
        (["slow,10,2000", "also,10.0,2000"], [], "variants 'slow' and 'also' are the same"),
        (["slow,10,2000", "fast,20"], [], "line 3 has 2 cells, the heading 3"),
        (["slow,10,2000", "fast,quick,2000"], [], "variant 'fast' with drive.speed = 'quick mph'"),
        (["slow,10,2000", "fast,20,2000"], ["--minimise", "mass_kg"], "optimise: needs [vary]"),
    ],
)
def test_a_list_that_makes_no_sense_is_refused(
    rows: list[str], flags: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "list.csv"
    file.write_text("\n".join(["name,drive.speed [mph],drive.load [lbf]", *rows]))
    assert main(["sweep", TYRE, "--cases", str(file), *flags, "--out", str(tmp_path / "out")]) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('sampel = "grid"', "did you mean 'sample'"),
        ("[vary]\n'drive.speed' = { form = '1 m/s', to = '2 m/s' }", "vary.drive.speed: unknown key 'form'"),
        ("vary.drive.speed = ['1 m/s']\n[limits]\nhottest_degC = { under = 3 }", "limits.hottest_degC: unknown key"),
        ("vary.drive.speed = ['1 m/s']\n[change]\nmesh.size = '8 mm'", "write dotted names in quotes"),
        ("[optimise]\nminimise = 'mass_kg'", "nothing varies"),
    ],
)
def test_a_bad_file_is_named(text: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(f'study = "{TYRE}"\n{text}\n')
    for command in ("sweep", "check"):
        assert main([command, str(file)]) == 2
        output = capsys.readouterr().err
        assert message in output
        assert "mine.toml" in output


@pytest.mark.parametrize(("name", "count"), [("crown-angle", 100), ("belt-edge", 15)])
def test_the_shipped_sweeps_are_found_by_name(name: str, count: int, capsys: pytest.CaptureFixture[str]) -> None:
    assert len(loaded(name).plan.variants) == count
    assert main(["show", "sweep", name]) == 0
    assert f"# {count} variants" in capsys.readouterr().out
    assert main(["list", "sweeps"]) == 0
    assert name in capsys.readouterr().out


def test_an_unknown_name_says_the_nearest() -> None:
    with pytest.raises(InputError, match="did you mean 'crown-angle'"):
        loaded("crown-angel")


def test_the_reference_in_the_documentation_is_a_sweep_file(tmp_path: Path) -> None:
    text = (Path(__file__).parents[2] / "docs" / "sweeps.md").read_text(encoding="utf-8")
    reference = text.split("## The sweep file")[1].split("```toml\n")[1].split("```")[0]
    (tmp_path / "sweep.toml").write_text(reference, encoding="utf-8")
    wanted = loaded(str(tmp_path))
    assert len(wanted.plan.variants) == 4 * 5 * 2 * 3 * 2
    assert [question.key for question in wanted.further] == ["tornado", "envelope"]
    assert "an envelope of 4 loads and pressures" in wanted.words
