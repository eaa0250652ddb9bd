"""The footprint in large motion against FElupe: its own elements, kinematics, contact and Newton's method."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tyrefem.mechanics.footprint.example_tyre import PlainTyre

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.fixture(scope="module")
def rows() -> dict[str, Any]:
    """Quantity -> row of the benchmark's table, with 12 elements of the section."""
    pytest.importorskip("felupe")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(BENCHMARKS)
        from other_code import compare

        made, _ = compare(4, 8.0)
    return {row.quantity: row for row in made}


@pytest.mark.parametrize(
    ("quantity", "close"),
    [
        ("growth of the radius by inflation", 0.01),
        ("load", 0.01),
        ("largest principal strain of rubber, patch of radius 4 mm", 0.05),
        ("largest principal change by the load, tread, patch of radius 4 mm", 0.05),
        ("largest principal strain of rubber, at a point", 0.05),
        ("largest principal change by the load, tread, at a point", 0.05),
        ("largest principal change by the load, sidewall, at a point", 0.02),
        ("largest cord strain, ply", 0.03),
        ("largest change of cord strain by the load, ply", 0.02),
        ("largest cord strain, belt", 0.03),
    ],
)
def test_another_code_agrees_on_the_same_coarse_mesh(rows: dict[str, Any], quantity: str, close: float) -> None:
    """Contact area, belt edge and the sidewall's patches need a finer mesh: docs/evidence/footprint.md has them."""
    assert rows[quantity].harmonics == pytest.approx(rows[quantity].felupe, rel=close)


def test_means_over_patches_have_a_goal_and_points_at_sharp_corners_have_none(rows: dict[str, Any]) -> None:
    goals = {name: row.goal for name, row in rows.items() if "principal" in name or "shear" in name}
    assert all(goal == 0.05 for name, goal in goals.items() if "radius 4 mm" in name)
    assert {goal for name, goal in goals.items() if "at a point" in name} == {None}
    assert rows["largest range of shear at the belt's end, patch of radius 4 mm"].met in ("yes", "no")


def test_a_step_that_diverges_is_halved_from_the_last_balance() -> None:
    pytest.importorskip("felupe")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(BENCHMARKS)
        from felupe_tyre import SolidTyre
    solid, solved = SolidTyre(PlainTyre(), 2, 0.3), [0.0]

    def solve(share: float) -> None:
        assert (solid.field[0].values == solved[-1]).all()
        solid.field[0].values[:] = share
        if share - solved[-1] > 0.3:
            raise RuntimeError("diverged")
        solved.append(share)

    solid._in_steps([0.25, 1.0], solve)
    assert solved == [0.0, 0.25, 0.4375, 0.625, 0.8125, 1.0]
    with pytest.raises(RuntimeError, match="diverged"):
        solid._in_steps([9.0], lambda share: solve(share + 10))


def test_without_felupe_one_line_says_how_to_install_it(tmp_path: Path) -> None:
    (tmp_path / "felupe.py").write_text("raise ModuleNotFoundError(\"No module named 'felupe'\", name='felupe')\n")
    code = (
        f"import sys, runpy; sys.path[:0] = [{str(tmp_path)!r}, {str(BENCHMARKS)!r}]; "
        f"runpy.run_path({str(BENCHMARKS / 'other_code.py')!r}, run_name='__main__')"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert done.returncode == 1
    assert done.stderr == "this benchmark needs FElupe 11.3 or later: pip install felupe\n"


def test_the_package_does_not_import_felupe() -> None:
    """It is under the GPL: only the benchmark and this test use it."""
    package = BENCHMARKS.parent / "tyrefem"
    assert [path for path in package.rglob("*.py") if "import felupe" in path.read_text(encoding="utf-8")] == []
