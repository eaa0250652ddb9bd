"""What does not fit is refused before it is begun: the field, the number, the estimate in GiB and what would fit."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tyrefem
from tyrefem.conduction import Conduction, Film, Material
from tyrefem.errors import InputError
from tyrefem.estimates.work import GIB
from tyrefem.geometry.meshing import build
from tyrefem.measured import read_table
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.press import press
from tyrefem.realtime.certificate import export
from tyrefem.sweep.sweep import sweep
from tyrefem.variants.plan import plan_of
from tyrefem.variants.schedulers import Local

NASA, RADIAL = "nasa-22x5.5-8pr", "passenger-205-55r16"
COARSE = {"mesh.size": "12 mm"}
NODES = "nodes; that takes about .* GiB"


@pytest.fixture
def free(monkeypatch: pytest.MonkeyPatch) -> Callable[[float], None]:
    """Says how many GiB are free."""

    def say(gib: float) -> None:
        monkeypatch.setattr("tyrefem.estimates.memory.free_memory", lambda: gib * GIB)

    return say


@pytest.fixture
def nothing_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    """No mesh is laid, no sample drawn."""

    def begun(*_given: Any, **_named: Any) -> None:
        raise AssertionError("work has begun")

    for place in (
        "geometry.meshing.mapped.mapped_mesh",
        "variants.samples.places",
        "variants.plan.Grid",
        "variants.plan.drawn",
    ):
        monkeypatch.setattr(f"tyrefem.{place}", begun)


def refused(work: Callable[[], Any], field: str, words: str) -> InputError:
    with pytest.raises(InputError, match=words) as caught:
        work()
    assert caught.value.field == field
    return caught.value


@pytest.mark.usefixtures("nothing_begins")
@pytest.mark.parametrize(
    ("name", "changes", "field", "words"),
    [
        (
            NASA,
            {"mesh.size": "0.3 mm"},
            "mesh.size",
            r"0.3 mm makes 33\d,\d+ unknowns; .* 5.\d GiB .* 0.\d+ mm",
        ),
        (RADIAL, {"mesh.through": 50}, "mesh.through", r"50 makes 2,5.* unknowns; .* GiB are free; \d would fit"),
        (NASA, {"output.every": "0.001 s"}, "output.every", r"0.001 s makes 600,0\d\d readings; .*; 0.0\d+ s or more"),
        (NASA, {**COARSE, "output.every": "0.002 s"}, "output.every", r"GiB of memory, and 2.0 GiB are free"),
        (NASA, {"mesh.size": "0.5 mm", "output.fields": 9999}, "output.fields", r"9,999 fields .*; \d+ or fewer would"),
        (
            RADIAL,
            {"mesh.size": "0.4 mm", "mechanics.motion": "linear"},
            "mesh.size",
            r"GiB of memory, and 2.0 GiB are free; 0.\d+ mm or more would fit",
        ),
        (RADIAL, {"mesh.size": "1 mm", "mechanics.motion": "large"}, "mesh.size", r"mm or more would fit"),
    ],
)
def test_runs(free: Callable[[float], None], name: str, changes: Mapping[str, Any], field: str, words: str) -> None:
    free(2.0)
    study = tyrefem.study(name, changes)
    assert refused(study.run, field, words).file == study.file


def test_what_is_said_to_fit_fits(free: Callable[[float], None], monkeypatch: pytest.MonkeyPatch) -> None:
    free(1.0)
    error = refused(tyrefem.study(NASA, {"mesh.size": "0.3 mm"}).run, "mesh.size", "would fit")
    (size,) = re.findall(r"([\d.]+) mm or more would fit", str(error))
    begun: list[Any] = []
    monkeypatch.setattr("tyrefem.simulation.run.simulate", lambda tyre, *_given, **_named: begun.append(tyre) or tyre)
    monkeypatch.setattr("tyrefem.api.studies.with_verbs", lambda _kind, data: data)
    tyrefem.study(NASA, {"mesh.size": f"{size} mm"}).run()
    assert len(begun) == 1
    nearly = f"{0.9 * float(size)} mm"
    refused(tyrefem.study(NASA, {"mesh.size": nearly}).run, "mesh.size", "would fit")


@pytest.mark.parametrize("every", ["1e-9 s", "1e-320 s"])
def test_more_readings_than_a_table_has_are_refused_everywhere(every: str) -> None:
    words = r"s makes .* readings; allowed: 0.0006 s or more, at most 1,000,000 readings of 600 s"
    refused(lambda: tyrefem.study(NASA, {"output.every": every}), "output.every", words)


@pytest.mark.parametrize("every", ["0 s", "-1 s", "inf s", "nan s", "1e999 s"])
def test_readings_that_are_no_readings(every: str) -> None:
    with pytest.raises(InputError, match=r"output\.every: "):
        tyrefem.study(NASA, {"output.every": every})


@pytest.mark.parametrize("key", ["numerics.tolerance", "mechanics.feedback.tolerance"])
@pytest.mark.parametrize("tolerance", ["1e-12 K", "1e-300 K"])
def test_tolerances_below_rounding(key: str, tolerance: str) -> None:
    words = "below the rounding of temperatures: must be at least 1e-11 K"
    refused(lambda: tyrefem.study(NASA, {key: tolerance}), key, words)
    hot = {"drive.ambient": "1500 degC"}
    refused(lambda: tyrefem.study(NASA, {key: tolerance, **hot}), key, "at least 1e-10 K")


@pytest.mark.parametrize("tolerance", ["0 K", "-1 K", "inf K", "nan K", "1e308 K"])
def test_tolerances_that_are_none(tolerance: str) -> None:
    with pytest.raises(InputError, match=r"numerics\.tolerance: "):
        tyrefem.study(NASA, {"numerics.tolerance": tolerance})


@pytest.mark.usefixtures("nothing_begins")
@pytest.mark.parametrize("size", [1e-9, 1e-200, 5e-324])
def test_meshes_of_sections(size: float) -> None:
    section = tyrefem.study(NASA).section
    for mesher in ("mapped", "gmsh"):
        refused(
            lambda mesher=mesher: build(section, size=size, mesher=mesher), "size", "nodes; that takes about .* GiB"
        )
    refused(lambda: build(section, size=3e-3, through=10**9), "size", "nodes; that takes about .* GiB")


def test_conduction_problems_and_their_histories(free: Callable[[float], None]) -> None:
    mesh = build(tyrefem.study(NASA).section, size=2e-3).mesh
    regions = dict.fromkeys(mesh.subdomains, Material(0.2, 2e6))
    free(0.04)
    words = "unknowns; that takes about 0.098 GiB of memory, and 0.04 GiB are free"
    refused(lambda: Conduction(mesh, regions, element="P2"), "mesh", words)
    problem = Conduction(mesh, regions, {"road": Film(h=10.0, sink=20.0)})
    many = np.linspace(0.0, 600.0, 20_000)
    refused(lambda: problem.transient(many), "times", r"20,000 times of [\d,]+ unknowns; .*; 7\d0 times would fit")
    refused(lambda: problem.transient([0.0, 1.0], tolerance=1e-12), "tolerance", "at least 1e-11 K")


SPEED, LOAD = {"drive.speed": ("10 mph", "40 mph")}, {"drive.load": ("1000 lbf", "2000 lbf")}
HUGE = 10**7
TWO = ("--vary", "drive.speed=1 mph:40 mph", "--vary", "drive.load=1 kN:9 kN")


@pytest.mark.usefixtures("nothing_begins")
@pytest.mark.parametrize(
    ("vary", "named", "field", "made"),
    [
        (SPEED, {"sample": "latin-hypercube", "count": HUGE}, "count", "10,000,000 variants"),
        (SPEED, {"sample": "sobol", "count": HUGE}, "count", "16,777,216 variants"),
        (SPEED | LOAD, {"sample": "saltelli", "count": 2**23}, "count", "33,554,432 variants"),
        (SPEED, {"sample": "sobol", "count": 10**308}, "count", r"more than 10\^15 variants"),
        ({"drive.speed": ("10 mph", "40 mph", HUGE)}, {}, "vary", "10,000,000 variants"),
        ({"drive.speed": ("10 mph", "40 mph", 10**400)}, {}, "vary", r"more than 10\^15 variants"),
        (
            {"drive.speed": ("10 mph", "40 mph", 10**4), "drive.load": ("1000 lbf", "2000 lbf", 10**4)},
            {},
            "vary",
            "100,000,000 variants",
        ),
    ],
)
def test_sweeps(free: Callable[[float], None], vary: Any, named: Any, field: str, made: str) -> None:
    free(8.0)
    words = (
        f"makes {made}; that takes about [\\d,.]+ GiB of memory, and 8.0 GiB are free; 7,[1-8]00,000 variants would fit"
    )
    refused(lambda: plan_of(tyrefem.study(NASA, COARSE), vary, **named), field, words)


def test_a_sweep_that_fits_is_planned(free: Callable[[float], None]) -> None:
    free(0.11)
    vary = {"drive.speed": ("10 mph", "40 mph", 100_000)}
    assert len(plan_of(tyrefem.study(NASA, COARSE), vary).variants) == 100_000
    free(0.07)
    refused(lambda: plan_of(tyrefem.study(NASA, COARSE), vary), "vary", "100,000 variants")


def test_runs_side_by_side_share_the_memory(free: Callable[[float], None]) -> None:
    free(1.0)
    plan = plan_of(tyrefem.study(NASA, {"mesh.size": "1 mm"}), {"drive.speed": ("10 mph", "40 mph", 3)})
    words = "0.33 GiB are free for each of 3 workers; .* fewer workers have more each"
    refused(lambda: sweep(plan, scheduler=Local(8)), "mesh.size", words)


def test_large_lists_of_cases_and_tables(free: Callable[[float], None], tmp_path: Path) -> None:
    free(0.05)
    table = tmp_path / "readings.csv"
    table.write_text(
        "time [s],a [degC]\n" + "".join(f"{n},{20 + n % 60}.00\n" for n in range(400_000)), encoding="utf-8"
    )
    with pytest.raises(InputError, match=r"readings\.csv: a table of 5 MB; that takes about 0.0.* GiB"):
        read_table(table)
    cases = tmp_path / "cases.csv"
    cases.write_text(
        "name,drive.speed [mph]\n" + "".join(f"c{n},{10 + n / 1e4}\n" for n in range(70_000)), encoding="utf-8"
    )
    refused(
        lambda: plan_of(tyrefem.study(NASA, COARSE), {}, cases=str(cases)), "cases", "cases.csv makes 70,000 variants"
    )


def test_presses_and_exports(free: Callable[[float], None], tmp_path: Path) -> None:
    free(0.1)
    words = r"0.5 mm makes [\d,]+ nodes of the footprint's finite elements; .*; [\d.]+ mm or more would fit"
    refused(lambda: press(tyrefem.study(NASA, {"mesh.size": "0.5 mm"})), "mesh.size", words)
    small = {"mesh.size": "6 mm"}
    refused(lambda: press(tyrefem.study(NASA, small), motion="large"), "mesh.size", "would fit")
    refused(lambda: export(tyrefem.study(NASA, {"mesh.size": "0.5 mm"}), tmp_path / "x.npz"), "mesh.size", "would fit")
    words = "less than the time error of the full runs; must be at least numerics.tolerance, 0.01 K"
    refused(lambda: export(tyrefem.study(NASA, COARSE), tmp_path / "x.npz", tolerance=1e-12), "tolerance", words)


@pytest.mark.parametrize("count", [0, -3, 2.5, 10**7, 10**400])
def test_harmonics_of_a_footprint(count: Any) -> None:
    pressing = Pressing(PlainTyre().state(along=6))
    words = "harmonics of 7 tread nodes; that takes about" if count > 10 else "must be a whole number, 1 or more"
    refused(lambda: pressing.at_deflection(0.004, count), "harmonics", words)
    refused(lambda: Balance(pressing, count).at_deflection(0.004), "harmonics", words)


#: Command line -> words of its error.
LINES: list[tuple[list[str], str]] = [
    (["run", NASA, "--set", "mesh.size=0.101 mm"], "mesh.size: 0.101 mm makes .* GiB"),
    (["run", NASA, "--set", "output.every=1e-9 s"], "output.every: 1e-09 s makes 6e.11 readings"),
    (["run", NASA, "--set", "numerics.tolerance=1e-12 K"], "numerics.tolerance: 1e-12 K is below the rounding"),
    (["sweep", NASA, "--vary", f"drive.speed=10 mph:40 mph:{HUGE}"], "vary: the grid makes 10,000,000 .* GiB"),
    (
        ["sweep", NASA, *TWO, "--sample", "sobol", "--count", f"{HUGE}"],
        "count: .* GiB",
    ),
    (
        ["sweep", NASA, *TWO, "--indices", f"{2**23}"],
        "count: sample = 'saltelli' makes 33,554,432 variants; .* GiB",
    ),
    (
        ["rig", "simulate", "trtlab", "--every", "1e-9 s"],
        "--every: 1e-09 s makes 1.66e.12 readings",
    ),
    (["rig", "simulate", "trtlab", "--every", "1e308 s"], "--every: .* leaves no reading after the first"),
    (["export", NASA, "--tolerance", "1e-12 K"], "tolerance: .* at least numerics.tolerance, 0.01 K"),
    (["road", "averaging", "--thickness", "1e308 mm"], "--thickness: .* at most 10 m"),
    (["slide", "locked-wheel", "--friction", "1e308"], "--friction: .* at most 100"),
]


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[str], Path]:
    """One line for every command line: exit code, peak of memory so far, seconds, error. All run in one process."""
    folder = tmp_path_factory.mktemp("refused")
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    code = (
        "import contextlib, io, json, resource, sys, time; from tyrefem.cli import main; limit = 4 * 2**30; "
        "resource.setrlimit(resource.RLIMIT_AS, (limit, limit))\n"
        "for line in json.load(sys.stdin):\n"
        "    began, err = time.process_time(), io.StringIO()\n"
        "    with contextlib.redirect_stderr(err):\n"
        "        code = main(line)\n"
        # Not ru_maxrss: that counts what the test's own process had when it started this one.
        "    peak = next(line.split()[1] for line in open('/proc/self/status') if line.startswith('VmHWM'))\n"
        "    print(json.dumps([code, int(peak), time.process_time() - began, err.getvalue()]), flush=True)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, env=environment, capture_output=True, text=True, timeout=120,
        input=json.dumps([line for line, _ in LINES]), check=True,
    )  # fmt: skip
    return done.stdout.splitlines(), folder


@pytest.mark.parametrize("number", range(len(LINES)), ids=[" ".join(line[:2]) for line, _ in LINES])
def test_the_command_line_answers_at_once_and_without_memory(answers: tuple[list[str], Path], number: int) -> None:
    lines, folder = answers
    code, kilobytes, seconds, err = json.loads(lines[number])
    (line,) = err.splitlines()
    assert re.search(LINES[number][1], line), line
    assert code == 2
    assert kilobytes < 300_000
    assert seconds < 10
    assert list(folder.rglob("*")) == []
