"""The command line as a process of its own."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

NASA = "nasa-22x5.5-8pr"
#: A run short enough for a test.
SHORT = ("--set", "drive.duration=10 s", "--set", "mesh.size=8 mm", "--set", "output.fields=2")
BARE = ("--no-pictures", "--no-vtk")
TABLES = {
    "readings.csv", "extremes.csv", "heat_budget.csv", "heat_power.csv", "study.toml", "summary.json", "result.npz",
}  # fmt: skip


def command(*arguments: str) -> list[str]:
    """The command line's own words."""
    return [sys.executable, "-m", "tyrefem", *arguments]


def process(*arguments: str, **options: Any) -> subprocess.CompletedProcess[str]:
    """Run it to its end."""
    options = {"capture_output": True, "text": True, "timeout": 120, "check": False} | options
    return subprocess.run(command(*arguments), **options)
