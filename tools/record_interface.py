"""Record the public interface, and compare two records: nothing of it may be lost.

    python tools/record_interface.py record before.json
    python tools/record_interface.py record after.json
    python tools/record_interface.py compare before.json after.json

Recorded of the tree in which this file lies, or of ``--tree``: names of `tyrefem` with signatures and members; members
of the objects that the verbs give (study, result, comparison, diagnosis, campaign, sweep, conduction problem and
fields); commands with their flags; keys of study, section, material, rig and sweep files; effects with parameters;
names in the library and boundary laws; files of every command with the keys, columns and fields in them; imports that
the documentation shows. ``compare`` prints what is missing or changed and ends with exit code 1 if there is any;
additions are allowed. An import that the documentation no longer shows is told, without failing.
"""

from __future__ import annotations

import argparse
import importlib
import json
import re
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from interface_parts import Part, card_trees, commands, effects, import_everything, members, public_name
from record_numbers import COARSE, SHORT, VARIED, elsewhere, run_command

#: One quick run of every command that writes files or prints JSON.
RUNS = (
    f"run nasa-22x5.5-8pr --revolved {COARSE} {SHORT}",
    f"run nasa-22x5.5-8pr --no-pictures --no-vtk --json {COARSE} {SHORT} --set mechanics.feedback.pressure=true",
    f"run nasa-brake-yaw-skid {COARSE}",
    f"run nasa-taxi-takeoff --no-vtk {COARSE}",
    f"run nasa-campaign --no-vtk {COARSE}",
    f"compare example-validation {COARSE}",
    f"compare example-validation --no-inputs --json {COARSE}",
    f"diagnose hidden-effect --looks 1 --largest 1 --workers 1 {COARSE}",
    f"isolability hidden-effect --workers 1 {COARSE}",
    f"blind hidden-effect --cases 1 --workers 1 {COARSE}",
    f"sweep nasa-22x5.5-8pr --workers 1 {COARSE} {SHORT} {VARIED} --time-to '30 degC'",
    f"sweep nasa-22x5.5-8pr --workers 1 {COARSE} {SHORT} {VARIED} --indices 8",
    f"sweep nasa-22x5.5-8pr --workers 1 {COARSE} {SHORT} --tornado",
    f"sweep nasa-22x5.5-8pr --workers 1 {COARSE} {SHORT} --vary drive.load=x0.8:x1.2 --minimise hottest_degC --runs 20",
    f"sweep nasa-22x5.5-8pr --workers 1 {COARSE} {SHORT} --envelope 'hottest_degC<80' --pressures '80 psi'",
    f"export nasa-22x5.5-8pr --fmu --workers 1 --duration '60 s' {COARSE}",
    f"press nasa-22x5.5-8pr {COARSE}",
    f"press nasa-22x5.5-8pr --no-pictures --no-vtk --json --camber '1 deg' {COARSE}",
    f"modes nasa-22x5.5-8pr --highest 1 {COARSE}",
    f"strain nasa-22x5.5-8pr --law arcs --law barrel {COARSE}",
    "rig simulate trtlab",
    "rig identify trtlab",
    "rig layers layers --most 1",
    "slide tables --json",
    "slide locked-wheel --json",
    "slide rise --speed '0.35 m/s' --length '225 mm' --friction 0.5 --pressure '300 kPa' --json",
    "new study mine",
    "new section mine",
    "new material mine",
    "show section nasa-22x5.5-8pr",
    "show mesh nasa-22x5.5-8pr",
)
KINDS = ("sections", "materials", "studies", "sweeps", "laws", "effects")
IMPORT = re.compile(r"^\s*(?:>>> )?(from tyrefem[\w.]* import [\w, ]+|import tyrefem[\w.]*)", re.MULTILINE)


def objects() -> Iterator[tuple[str, Any]]:
    """What the verbs of the interface give."""
    import skfem

    import tyrefem as tf

    study = tf.study("hidden-effect").replace({"mesh.size": "10 mm"})
    result = study.run()
    yield "study", study
    yield "result", result
    yield "heat budget", result.heat_budget
    yield "rolling resistance", result.rolling_resistance
    yield "comparison", study.compare(result=result, inputs=False)
    yield "diagnosis", study.diagnose(looks=1, largest=1)
    yield "campaign", tf.study("nasa-campaign").campaign()
    yield (
        "sweep",
        tf.study("nasa-22x5.5-8pr").replace({"mesh.size": "10 mm"}).sweep({"drive.speed": ["5 m/s", "6 m/s"]}),
    )
    problem = tf.Conduction(
        skfem.MeshQuad().with_defaults().with_subdomains({"rubber": lambda x: x[0] >= 0}),
        regions={"rubber": tf.Material(conductivity=0.2, heat_capacity=2e6)},
        boundaries={"left": tf.Fixed(20.0)},
        axisymmetric=False,
    )
    yield "conduction problem", problem
    yield "conduction field", problem.steady()
    yield "conduction history", problem.transient([0.0, 1.0], initial=25.0)


def written(command: str, tree: Path) -> dict[str, list[str]]:
    """File (or "printed") -> its keys, of one command run in an empty folder."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        done = run_command(command, tree, folder)
        files = {"exit code": [str(done.returncode)]}
        if " --json" in command and done.returncode == 0:
            files["printed"] = sorted(set(json_keys(json.loads(done.stdout))))
        for path in sorted(path for path in folder.rglob("*") if path.is_file()):
            files[path.relative_to(folder).as_posix()] = sorted(set(file_keys(path)))
    print(f"exit {done.returncode}: {command}", flush=True)
    return files


def file_keys(path: Path) -> Iterator[str]:
    """Keys of a JSON file, columns of a table, fields of a VTK file, arrays of a real-time model."""
    import meshio
    import numpy as np
    import pandas as pd

    if path.suffix == ".json":
        yield from json_keys(json.loads(path.read_text(encoding="utf-8")))
    elif path.suffix == ".csv":
        yield from map(str, pd.read_csv(path, comment="#").columns)
    elif path.suffix == ".parquet":
        yield from map(str, pd.read_parquet(path).columns)
    elif path.suffix == ".vtu":
        mesh = meshio.read(path)
        yield from [*mesh.point_data, *mesh.cell_data]
    elif path.suffix == ".npz":
        with np.load(path, allow_pickle=False) as arrays:
            yield from arrays.files


def json_keys(data: Any, path: str = "") -> Iterator[str]:
    """Every dotted key; entries of lists together."""
    if isinstance(data, Mapping):
        for key, value in data.items():
            yield f"{path}{key}"
            yield from json_keys(value, f"{path}{key}.")
    elif isinstance(data, list):
        for value in data:
            yield from json_keys(value, f"{path}[]." if not path else f"{path[:-1]}[].")


def documented(tree: Path) -> list[str]:
    """Imports in README and docs that work."""
    texts = [path.read_text(encoding="utf-8") for path in (tree / "README.md", *sorted((tree / "docs").glob("*.md")))]
    names = set()
    for line in IMPORT.findall("\n".join(texts)):
        module, _, listed = line.removeprefix("from ").removeprefix("import ").partition(" import ")
        names |= {f"{module}.{name.strip()}" for name in listed.split(",") if name.strip()} or {module}
    return sorted(names)


def record(tree: Path) -> dict[str, Any]:
    """The whole interface as plain data."""
    with elsewhere(tree) as folder:
        import typer.main

        import tyrefem

        import_everything(tyrefem)
        cards, effect = importlib.import_module("tyrefem.cards"), importlib.import_module("tyrefem.effects")
        group = typer.main.get_command(importlib.import_module("tyrefem.cli").app)
        listed = {kind: run_command(f"list {kind}", tree, folder).stdout.splitlines() for kind in KINDS}
        parts = {
            "names": {name: public_name(getattr(tyrefem, name)) for name in tyrefem.__all__},
            "objects": {name: {"members": members(value)} for name, value in objects()},
            "commands": dict(commands(group)),
            "cards": card_trees(cards.Card, effect.Effect),
            "effects": effects(effect.Effect),
            "library": {kind: [" ".join(_names(kind, line)) for line in lines] for kind, lines in listed.items()},
            "documented": documented(tree),
        }
    return parts | {"outputs": {command: written(command, tree) for command in RUNS}}


def _names(kind: str, line: str) -> list[str]:
    return line.split()[: 2 if kind == "laws" else 1]


def losses(before: Any, after: Any, path: str = "") -> Iterator[str]:
    """What was there before and is missing or changed after."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key, value in before.items():
            place = f"{path} > {key}" if path else str(key)
            if key not in after:
                yield f"missing: {place}"
            elif key == "parameters" and isinstance(value, list):
                yield from signature_losses(value, after[key], place)
            else:
                yield from losses(value, after[key], place)
    elif isinstance(before, list) and isinstance(after, list):
        yield from (f"missing: {path} > {item}" for item in before if item not in after)
    elif before != after:
        yield f"changed: {path}: {before} -> {after}"


def signature_losses(before: list[Part], after: list[Part], path: str) -> Iterator[str]:
    """Calls that worked must work: parameters keep name, kind, place and default; new ones are optional."""
    by_name = {row["name"]: row for row in after}
    for row in before:
        if row["name"] not in by_name:
            yield f"missing: {path} > {row['name']}"
        elif by_name[row["name"]] != row:
            yield f"changed: {path} > {row['name']}: {row} -> {by_name[row['name']]}"
    placed = [[row["name"] for row in rows if row["kind"].startswith("POSITIONAL")] for rows in (before, after)]
    if placed[1][: len(placed[0])] != placed[0]:
        yield f"changed: {path}: order {placed[0]} -> {placed[1]}"
    named = {row["name"] for row in before}
    for row in after:
        if row["name"] not in named and row["required"] and not row["kind"].startswith("VAR"):
            yield f"changed: {path} > {row['name']} is new and required"


def compare(before: dict[str, Any], after: dict[str, Any]) -> int:
    """Print every loss; 1 if there is any."""
    gone = [name for name in before.pop("documented") if name not in after["documented"]]
    for name in gone:
        print(f"no longer documented: {name}")
    lost = list(losses(before, after))
    for line in lost:
        print(line)
    print(f"{len(lost)} names, flags or keys are missing or changed")
    return int(bool(lost))


def main() -> int:
    """Record, or compare two records."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    subparsers = parser.add_subparsers(dest="command", required=True)
    recorder = subparsers.add_parser("record", help="write a record")
    recorder.add_argument("out", type=Path)
    recorder.add_argument("--tree", type=Path, default=Path(__file__).resolve().parents[1])
    comparer = subparsers.add_parser("compare", help="compare two records")
    comparer.add_argument("before", type=Path)
    comparer.add_argument("after", type=Path)
    options = parser.parse_args()
    if options.command == "compare":
        before, after = (json.loads(path.read_text(encoding="utf-8")) for path in (options.before, options.after))
        return compare(before, after)
    out = options.out.resolve()
    out.write_text(json.dumps(record(options.tree.resolve()), indent=1), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
