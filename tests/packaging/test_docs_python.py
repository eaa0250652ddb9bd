"""Python blocks of the documentation run, page by page, on coarse studies; what a page takes for granted is here.

Three pages have tests of their own, which also assert what they say: docs/results.md and docs/conduction.md
(tests/results/test_results_page.py), docs/extending.md (tests/plugins/test_extending_page.py).
"""

from __future__ import annotations

import functools
import re
import shutil
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tyrefem
from tyrefem.api import Study, studies
from tyrefem.cli import main
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.heating_test.grid import Fineness

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "hostile"))

import small  # noqa: E402

BLOCK = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)
ELSEWHERE = {"docs/results.md", "docs/conduction.md", "docs/extending.md"}
TEXTS = [
    *(ROOT / "docs").rglob("*.md"), ROOT / "README.md", *(ROOT / "site").glob("*.md"),
    *(ROOT / "site" / "howto").glob("*.md"), *ROOT.glob("studies/*/README.md"),
]  # fmt: skip
PAGES = sorted(
    name
    for page in TEXTS
    if BLOCK.search(page.read_text(encoding="utf-8")) and (name := page.relative_to(ROOT).as_posix()) not in ELSEWHERE
)
#: Begin of a study's name -> what makes it coarse; stronger than what a page gives.
NASA = {"mesh.size": "14 mm", "mesh.element": "P1", "numerics.tolerance": "0.25 delta_degC"}
RADIAL = {"mesh.size": "18 mm", "mechanics.motion": "linear"}
COARSE: Mapping[str, Mapping[str, Any]] = {
    "nasa-": NASA, "passenger-": RADIAL, "hidden-effect": NASA, "example-": NASA,
}  # fmt: skip
COARSE_FLAGS = [flag for key, value in NASA.items() for flag in ("--set", f"{key}={value}")]
#: Pages whose radial is replaced by a coarse bias tyre with mechanics by finite elements: seconds, not minutes.
SMALL = {"mesh.size": "18 mm", "mesh.element": "P1", "mechanics.strain": "fem", "mechanics.motion": "linear",
         "materials.tread": "rubber-tread-aircraft"}  # fmt: skip
#: Pages whose diagnosis is that of the smallest study of the tests, with two candidate effects.
DIAGNOSED = {"docs/diagnosis.md", "docs/method/diagnosis.md", "docs/plan.md", "README.md"}
#: Fits of these diagnoses and plans are on the mesh of that study.
FITS = DiagnosisSettings(mesh_size="15 mm")
#: Pages on many variants, whose drives take a minute.
SHORT = {"docs/sweeps.md"}
BIAS = {"docs/life.md", "docs/mechanics.md", "docs/two-way.md", "docs/wear.md", "README.md"}


def named(page: str) -> str:
    return page.removesuffix(".md").replace("/", "-")


def validation(folder: Path) -> dict[str, Any]:
    study = tyrefem.study("example-validation")
    readings = study.run().readings
    names = {name: "time [s]" if name == "time_s" else f"{name} [degC]" for name in readings}
    readings.rename(columns=names).to_csv(folder / "measured.csv", index=False)
    return {"study": study}


def real_time(folder: Path) -> dict[str, Any]:
    """The model file of the page's command, and the module that is copied beside it."""
    shutil.copy(ROOT / "tyrefem" / "realtime" / "tyre.py", folder / "realtime.py")
    assert main(["export", "nasa-22x5.5-8pr", *COARSE_FLAGS, "--tolerance", "50 K", "--workers", "1",
                 "--out", "tyre.npz"]) == 0  # fmt: skip
    return {}


#: Page -> what is there before its first block.
BEFORE: Mapping[str, Callable[[Path], dict[str, Any]]] = {
    "docs/validation.md": validation, "docs/realtime.md": real_time,
    "docs/method/diagnosis.md": lambda _: {"study": tyrefem.study("hidden-effect")},
}  # fmt: skip


def coarse(page: str, folder: Path) -> Callable[..., Study]:
    """`tf.study`, but every study is coarse."""
    load = studies.study
    file = small.write(folder / "small") / "study.toml" if page in DIAGNOSED else None

    def study(name: str | Path, changes: Mapping[str, Any] | None = None, case: str | None = None) -> Study:
        if page in BIAS and str(name).startswith("passenger-"):
            return load("nasa-22x5.5-8pr", {**(changes or {}), **SMALL})
        if file is not None and str(name) in ("hidden-effect", "example-validation"):
            return load(file, {"plan.drives": 2, "plan.sensors_most": 0} if page == "docs/plan.md" else None)
        if page in SHORT and str(name).startswith("nasa-22x5.5"):
            changes = {**(changes or {}), "drive.duration": "60 s"}
        more = next((flags for begin, flags in COARSE.items() if str(name).startswith(begin)), {})
        return load(name, {**(changes or {}), **more}, case)

    return study


@pytest.mark.parametrize("page", PAGES, ids=named)
def test_the_python_of_a_page_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study = coarse(page, tmp_path)
    for module in (tyrefem, tyrefem.api, studies):
        monkeypatch.setattr(module, "study", study, raising=False)
    if page in DIAGNOSED:
        for name in ("diagnose", "plan"):
            monkeypatch.setattr(Study, name, functools.partialmethod(getattr(Study, name), settings=FITS))
    # Identified once, on a coarse mesh of the patch.
    quick = functools.partial(tyrefem.api.identify, fineness=Fineness(2, 5, 2), linear=False)
    monkeypatch.setattr(tyrefem.api, "identify", quick)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    names: dict[str, Any] = {"tf": tyrefem, "np": np, **BEFORE.get(page, lambda _: {})(tmp_path)}
    for number, block in enumerate(BLOCK.findall((ROOT / page).read_text(encoding="utf-8")), start=1):
        exec(compile(block, f"{page}, block {number}", "exec"), names)
