"""Record the numbers of every shipped study to full precision, and compare two records.

A refactor must leave the numbers as they are:

    python tools/record_numbers.py record before.json
    python tools/record_numbers.py record after.json
    python tools/record_numbers.py compare before.json after.json

``record`` runs the command line (`python -m tyrefem ...`) and the top-level `tf.` interface on one core, about six
minutes, of the tree in which this file lies or of ``--tree``. A study with long runs is run on a coarse mesh or with a
short drive: `COMMANDS` says which. ``compare`` prints the largest relative difference of every entry and ends with
exit code 1 above ``--tolerance`` (1e-9), or when an entry, a key or a name is missing. Times, dates, versions, paths
and sentences are left out.

A number is recorded as it is. An array (a column, a field) is recorded as count, sum, Euclidean norm, least, greatest
and first moment. Columns of text tables are compared to the digits that they print, all else to the tolerance.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import shlex
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from number_differences import compare
from number_files import READERS, Entry, array_summary, printed

COARSE = "--set mesh.size='10 mm'"
MEDIUM = "--set mesh.size='8 mm'"
SHORT = "--set drive.duration='60 s'"
RUN = "run nasa-22x5.5-8pr --no-pictures"
SWEEP = f"sweep nasa-22x5.5-8pr --workers 1 --no-pictures {COARSE}"
VARIED = "--vary drive.load=x0.8:x1.2 --vary drive.speed=x0.8:x1.2"
#: Studies that are run as they are.
WHOLE = (
    "nasa-22x5.5-8pr",
    "nasa-22x5.5-12pr",
    "nasa-taxi-takeoff",
    "nasa-brake-yaw-skid",
    "example-validation",
    "hidden-effect",
    "aircraft-radial",
    "passenger-205-55r16",
)
#: Where an effect is tried: the first study that takes it. Some need the full section, a lumped rim, or slip.
EFFECT_STUDIES: tuple[tuple[str, dict[str, Any]], ...] = (
    ("hidden-effect", {}),
    ("hidden-effect", {"mesh.section": "full"}),
    ("nasa-taxi-takeoff", {}),
    ("nasa-brake-yaw-skid", {}),
)
#: Every command; each runs in an empty folder, and what it prints and writes there is recorded.
COMMANDS = (
    *(f"run {name} --no-pictures" for name in WHOLE),
    f"run truck-295-80r22.5 --no-pictures {MEDIUM}",
    "run nasa-campaign --no-pictures --no-vtk",
    f"{RUN} --revolved --set mesh.section=full {MEDIUM} {SHORT}",
    f"{RUN} --no-vtk {MEDIUM} --set mechanics.strain=fem",
    f"{RUN} --no-vtk {COARSE} --set mechanics.strain=barrel",
    f"{RUN} --no-vtk {COARSE} --set mechanics.feedback.pressure=true",
    f"{RUN} --no-vtk {COARSE} --set mechanics.strain=fem --set mechanics.feedback.pressure=true",
    f"{RUN} --no-vtk {MEDIUM} --set mesh.mesher=gmsh",
    f"run aircraft-radial --no-pictures --no-vtk {MEDIUM} --set mechanics.strain=given",
    "compare example-validation",
    f"compare hidden-effect --reduced never --no-inputs {COARSE}",
    f"diagnose hidden-effect --looks 1 --largest 1 --workers 1 {MEDIUM}",
    f"isolability hidden-effect --workers 1 {COARSE}",
    f"blind hidden-effect --cases 1 --workers 1 {COARSE}",
    f"sweep crown-angle --workers 1 --no-pictures --reduced never {COARSE} {SHORT}",
    f"sweep belt-edge --workers 1 --no-pictures {COARSE} {SHORT}",
    f"{SWEEP} {VARIED} --sample latin-hypercube --count 60 --reduced always",
    f"{SWEEP} {VARIED} --indices 8",
    f"{SWEEP} --tornado",
    f"{SWEEP} --envelope 'hottest_degC<80' --loads '2500 lbf,2700 lbf' --pressures '80 psi' --speeds '4 m/s:20 m/s'",
    f"export nasa-22x5.5-8pr --fmu --workers 1 --duration '60 s' {COARSE}",
    "press nasa-22x5.5-8pr --no-pictures",
    f"press passenger-205-55r16 --no-pictures --no-vtk {MEDIUM}",
    f"press nasa-22x5.5-8pr --balanced --no-pictures --no-vtk --drum '1.7 m' --camber '1 deg' {COARSE}",
    f"strain nasa-22x5.5-8pr {COARSE}",
    "rig simulate trtlab --seed 3",
    "rig identify trtlab",
    "rig simulate layers",
    "road table",
    "road film --speed '50 km/h' --footprint '0.14 m'",
    "road averaging",
    "slide tables --json",
    "slide locked-wheel --json",
    "slide rise --speed '0.35 m/s' --length '225 mm' --friction 0.5 --pressure '300 kPa' --json",
    *(f"list {kind}" for kind in ("sections", "materials", "studies", "sweeps", "laws", "effects")),
)


def environment(tree: Path) -> dict[str, str]:
    """The environment of a run of ``tree``'s package: one thread, no folders of the user."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith("TYREFEM")}
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    return kept | threads | {"PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1", "COLUMNS": "200"}


@contextlib.contextmanager
def elsewhere(tree: Path) -> Iterator[Path]:
    """This process uses ``tree``'s package in an empty folder: studies of the current one would be found first."""
    for key in [key for key in os.environ if key.startswith("TYREFEM")]:
        del os.environ[key]
    os.environ |= environment(tree)
    sys.path.insert(0, str(tree))
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        yield Path(folder)


def run_command(command: str, tree: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run one command of the command line in a folder; its output is captured."""
    arguments = [sys.executable, "-m", "tyrefem", *shlex.split(command)]
    return subprocess.run(arguments, cwd=folder, env=environment(tree), capture_output=True, text=True, check=False)


def record_command(command: str, tree: Path) -> Entry:
    """Exit code, printed numbers and written numbers of one command."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        done = run_command(command, tree, folder)
        entry: Entry = {"exit code": done.returncode}
        if command.startswith("list "):
            entry |= {line.split("  ")[0].strip(): "listed" for line in done.stdout.splitlines()}
        elif " --json" in f" {command}" or command.startswith("road "):
            entry |= dict(printed(done.stdout))
        for path in sorted(folder.rglob("*")):
            if path.is_file() and path.suffix in READERS:
                file = path.relative_to(folder).as_posix()
                entry |= {f"{file}: {key}": leaf for key, leaf in READERS[path.suffix](path)}
    return entry


# -- the Python interface --------------------------------------------------------------------------------------------


def record_run(result: Any) -> Entry:
    """A result through the documented interface: readings, times, temperatures at points, budget, resistance."""
    readings = result.readings
    entry: Entry = {f"readings {name}": array_summary(readings[name]) for name in readings.columns}
    entry |= {"times": array_summary(result.times), "at sensors": array_summary(result.at(result.sensor_points))}
    for name, group in (("energy", result.heat_budget.energies), ("power", result.heat_budget.powers)):
        entry |= {f"{name} {' '.join(key)}": array_summary(values) for key, values in group.items()}
    resistance = result.rolling_resistance
    return entry | {"resistance N": float(resistance.force), "resistance": float(resistance.coefficient)}


def record_effect(name: str, tree: Path, folder: Path) -> Entry:
    """A run with one effect, at the values of the example that `show effect` prints."""
    import tyrefem as tf

    text = run_command(f"show effect {name}", tree, folder).stdout
    table = tomllib.loads(text[text.index("[[effects]]") :])["effects"]
    from tyrefem.effects import catalogue
    from tyrefem.effects.signature import STUDY

    for study, needed in (*EFFECT_STUDIES, (STUDY, dict(catalogue()[name].signature.changes))):
        try:
            return record_run(tf.study(study).replace({"mesh.size": "10 mm", "effects": table} | needed).run())
        except tf.InputError:
            continue
    return {"refused": "by every study"}


def record_conduction() -> Entry:
    """A steady and a transient problem with every boundary condition, on a body that is no tyre."""
    import numpy as np
    import skfem

    from tyrefem.conduction import Conduction, Film, Fixed, Flux, Material, Radiation

    mesh = skfem.MeshQuad.init_tensor(np.linspace(0.2, 0.3, 9), np.linspace(0.0, 0.1, 7))
    mesh = mesh.with_subdomains({"inner": lambda x: x[0] < 0.25, "outer": lambda x: x[0] >= 0.25})
    sides = {"left": (0, 0.2), "right": (0, 0.3), "bottom": (1, 0.0), "top": (1, 0.1)}
    mesh = mesh.with_boundaries(
        {name: lambda x, axis=axis, place=place: np.isclose(x[axis], place) for name, (axis, place) in sides.items()}
    )
    points = [(0.21, 0.03), (0.26, 0.07)]
    entry: Entry = {}
    for axisymmetric in (True, False):
        problem = Conduction(
            mesh,
            regions={
                "inner": Material(conductivity=(0.21, 0.4), heat_capacity=2.09e6),
                "outer": Material(conductivity=lambda T: 0.2 + 1e-3 * T, heat_capacity=1.9e6),
            },
            boundaries={
                "left": Flux(1700.0),
                "right": Film(h=20.0, sink=lambda x, t: 25.0 + 0.01 * t + 0.0 * x[0]),
                "bottom": Fixed(60.0),
                "top": Radiation(emissivity=0.9, surroundings=20.0),
            },
            sources={"inner": 1e5, "outer": lambda x, t, T: 1e4 + 10.0 * T},
            axisymmetric=axisymmetric,
        )
        name = "axisymmetric" if axisymmetric else "planar"
        steady = problem.steady()
        history = problem.transient(np.linspace(0.0, 900.0, 10), initial=25.0, tolerance=0.01)
        entry |= {f"{name} steady": array_summary(steady.at(points))}
        entry |= {f"{name} transient": array_summary(history.at(points))}
        entry |= {f"{name} through {side}": float(steady.flux_through(side)) for side in sides}
    return entry


def interface_cases(tree: Path, folder: Path) -> dict[str, Callable[[], Entry]]:
    """Name -> a case of the Python interface."""
    import tyrefem as tf

    cases: dict[str, Callable[[], Entry]] = {"tf.conduction": record_conduction}
    for name in WHOLE:
        cases[f"tf.study {name}"] = lambda name=name: record_run(tf.study(name).run())
    for line in run_command("list effects", tree, folder).stdout.splitlines():
        effect = line.split()[0]
        cases[f"tf.study effect {effect}"] = lambda effect=effect: record_effect(effect, tree, folder)
    return cases


def attempted(case: Callable[[], Entry]) -> Entry:
    """An entry; of a case that fails, the kind of its error."""
    try:
        return case()
    except Exception as error:
        print(f"{type(error).__name__}: {error}", flush=True)
        return {"failed": type(error).__name__}


def record(tree: Path, chosen: str = "", jobs: int = 1) -> dict[str, Entry]:
    """Every entry whose name holds ``chosen``."""
    commands = [command for command in COMMANDS if chosen in command]
    entries: dict[str, Entry] = {}

    def timed(name: str, case: Callable[[], Entry]) -> None:
        began = time.perf_counter()
        entries[name] = attempted(case)
        failed = f"  EXIT CODE {entries[name]['exit code']}" if entries[name].get("exit code") else ""
        print(f"{time.perf_counter() - began:6.1f} s  {len(entries[name]):5d} numbers  {name}{failed}", flush=True)

    with elsewhere(tree) as folder, ThreadPoolExecutor(jobs) as pool:
        list(pool.map(lambda command: timed(command, lambda: record_command(command, tree)), commands))
        for name, case in interface_cases(tree, folder).items():
            if chosen in name:
                timed(name, case)
    return {name: entries[name] for name in sorted(entries)}


def main() -> int:
    """Record, or compare two records."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    recorder = commands.add_parser("record", help="run everything and write a record")
    recorder.add_argument("out", type=Path)
    recorder.add_argument("--tree", type=Path, default=Path(__file__).resolve().parents[1])
    recorder.add_argument("--only", default="", help="only entries whose name holds this")
    recorder.add_argument("--jobs", type=int, default=1, help="commands at a time")
    comparer = commands.add_parser("compare", help="compare two records")
    comparer.add_argument("before", type=Path)
    comparer.add_argument("after", type=Path)
    comparer.add_argument("--tolerance", type=float, default=1e-9)
    options = parser.parse_args()
    if options.command == "compare":
        before, after = (json.loads(path.read_text(encoding="utf-8")) for path in (options.before, options.after))
        return compare(before, after, options.tolerance)
    out = options.out.resolve()
    entries = record(options.tree.resolve(), options.only, options.jobs)
    out.write_text(json.dumps(entries, indent=1), encoding="utf-8")
    print(f"{sum(os.times()[:4]):.0f} s of processor time, {len(entries)} entries")
    return 0


if __name__ == "__main__":
    sys.exit(main())
