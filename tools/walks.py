"""Draw the two walks of docs/architecture.md: speed to W/m3, and a thermocouple to the verdict.

    python tools/walks.py            # writes the tables of the page and docs/pictures/architecture-walks.svg
    python tools/walks.py --check    # exit code 1 if the page or the picture is not what the code does

Both walks are followed through real runs (`speed_walk`, `thermocouple_walk`), not declared. About ten seconds.
"""

from __future__ import annotations

import argparse
import ast
import sys
import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path

from speed_walk import DOOR, SpeedWalks, speed_walks
from thermocouple_walk import ThermocoupleWalk, thermocouple_walk
from walk_picture import Trail, picture

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "architecture.md"
PICTURE = ROOT / "docs" / "pictures" / "architecture-walks.svg"
#: Lines of the page around what this tool writes.
BEGIN, END = "<!-- {name}: written by tools/walks.py -->", "<!-- end of {name} -->"
BLUE, RUST = "#0b5fa5", "#b3400e"


def purpose(module: str) -> str:
    """The first sentence of a module's docstring, up to its first colon."""
    path = ROOT / Path(*module.split("."))
    file = path.with_suffix(".py") if path.with_suffix(".py").is_file() else path / "__init__.py"
    docstring = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    sentence = " ".join(docstring.split("\n\n")[0].split()).replace("``", "`")
    return sentence.partition(": ")[0].rstrip(".")


def table(modules: Sequence[str], form: Callable[[str], str]) -> str:
    """One row per module: number, module, what it hands on, what it is for."""
    rows = [
        f"| {number} | `{module.removeprefix('tyrefem.')}` | {form(module) or '(the end)'} | {purpose(module)} |"
        for number, module in enumerate(modules, 1)
    ]
    return "\n".join(["| | module | hands on | what it is for |", "|---|---|---|---|", *rows])


def parts(speed: SpeedWalks, thermocouple: ThermocoupleWalk) -> dict[str, str]:
    """Name of a part of the page -> what stands there."""
    asking = ", ".join(f"`{module.removeprefix('tyrefem.')}`" for module in speed.asking)
    return {
        "speed": table(speed.first.visits, speed.first.form)
        + f"\n\nIn the same run, `{DOOR.removeprefix('tyrefem.')}` is asked by {asking}.",
        "thermocouple": table(thermocouple.modules, thermocouple.form),
    }


def page(text: str, parts: dict[str, str]) -> str:
    """The page with its parts as they are now."""
    for name, part in parts.items():
        begin, end = (mark.format(name=name) for mark in (BEGIN, END))
        before, rest = text.split(begin)
        text = f"{before}{begin}\n\n{part}\n\n{end}{rest.split(end)[1]}"
    return text


def layers() -> list[str]:
    """The floors, from the top: the contract in pyproject.toml."""
    tool = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    contracts = tool["importlinter"]["contracts"]
    return next(list(contract["layers"]) for contract in contracts if contract["type"] == "layers")


def drawing(speed: SpeedWalks, thermocouple: ThermocoupleWalk) -> str:
    """The picture of both walks."""
    return picture(
        layers(),
        [
            Trail("speed: study.toml to W/m³", speed.first.visits, BLUE),
            Trail("thermocouple: CSV to verdict", thermocouple.modules, RUST),
        ],
    )


def main() -> int:
    """Write, or check."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing; exit code 1 if anything would change")
    check = parser.parse_args().check
    speed, thermocouple = speed_walks(), thermocouple_walk()
    wanted = {
        PAGE: page(PAGE.read_text(encoding="utf-8"), parts(speed, thermocouple)),
        PICTURE: drawing(speed, thermocouple),
    }
    stale = [path for path, text in wanted.items() if not path.is_file() or path.read_text(encoding="utf-8") != text]
    for path in stale:
        print(f"{path.relative_to(ROOT)} {'is stale: run tools/walks.py' if check else 'written'}")
        if not check:
            path.write_text(wanted[path], encoding="utf-8")
    return int(check and bool(stale))


if __name__ == "__main__":
    sys.exit(main())
