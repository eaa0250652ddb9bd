"""A study with a user's own effect reaches another process."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

EFFECT = '''
from typing import Annotated, ClassVar

from tyrefem.effects import Effect, Prior


class Draught(Effect):
    """Colder air."""

    name: ClassVar[str] = "draught"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "A draught cools the tyre."
    source: ClassVar[str] = "estimate: a door"
    colder: Annotated[float, Prior("delta_degC", "air below the ambient", 5.0, -20.0, 20.0)] = 0.0

    def sink_addend(self, tyre, sink, t):
        """K."""
        return -self.colder if sink == "outside_air" else 0.0
'''
SEND = (
    "import pickle, sys; import tyrefem as tf; "
    "study = tf.study('nasa-22x5.5-8pr', {'effects': [{'name': 'draught', 'colder': '3 K'}]}); "
    "sys.stdout.buffer.write(pickle.dumps(study))"
)
RECEIVE = "import pickle, sys; print(pickle.load(sys.stdin.buffer).effects[0].colder)"


def test_an_own_effect_is_built_again_where_the_study_arrives(tmp_path: Path) -> None:
    (tmp_path / "draught.py").write_text(EFFECT, encoding="utf-8")
    options = {"env": os.environ | {"TYREFEM_EFFECTS": str(tmp_path)}, "check": True, "timeout": 120}
    sent = subprocess.run([sys.executable, "-c", SEND], stdout=subprocess.PIPE, **options)  # type: ignore[call-overload]
    came = subprocess.run(  # type: ignore[call-overload]
        [sys.executable, "-c", RECEIVE], input=sent.stdout, stdout=subprocess.PIPE, **options
    )
    assert came.stdout.decode().strip() == "3.0"
