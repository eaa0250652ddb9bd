"""A script without the guard that worker processes need: an error that says so, at once."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

WORK = {
    "diagnosis": "tf.study('hidden-effect').diagnose(workers=2)",
    "sweep": "tf.study('nasa-22x5.5-8pr', {'mesh.size': '8 mm'}).sweep("
    "{'drive.speed': ['10 mph', '20 mph', '25 mph']}, scheduler=Local(2), reduced='never')",
}


@pytest.mark.parametrize("name", WORK)
def test_a_script_without_the_guard_ends_with_what_it_needs(name: str, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    imports = "import tyrefem as tf\nfrom tyrefem.variants.schedulers import Local\n"
    script.write_text(f"{imports}print('begun')\n{WORK[name]}\n", encoding="utf-8")
    environment = {**os.environ, "PYTHONWARNINGS": "error::ResourceWarning"}
    ended = subprocess.run(
        [sys.executable, str(script)], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120
    )
    assert ended.returncode == 1
    assert ended.stderr.count("Traceback") == 1
    last = ended.stderr.strip().splitlines()[-1]
    assert last.endswith('a script whose work has several processes needs it under: if __name__ == "__main__":')
