"""Follow the speed of a study through a real run: from the text in ``study.toml`` to the heat source in W/m3.

The study is the shipped NASA tyre at a speed that no other number in it has. A module is on the walk where one of its
functions hands on the table with the text, the number in m/s, an object with the number in a field (`Ramp`, `Phase`,
`Motion`), or what it becomes: the array of W/m3 that conduction asks for. Wholes that carry the file or the drive
unread are not counted: the command, the study, the schedule of strain cycles, the tyre.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from hand_overs import Call, Follower, Walk, parts, room

#: The speed as it is written, and in m/s.
TEXT, SPEED = "48.1368132 km/h", 48.1368132 / 3.6
STUDY = "nasa-22x5.5-8pr"
CHANGES = {"mesh.size": "12 mm", "drive.duration": "5 s", "output.fields": 2}
#: The module that everybody asks for the motion of the wheel.
DOOR = "tyrefem.inputs.motion"


@dataclass(frozen=True)
class SpeedWalks:
    """The walk from the file to the first W/m3, the later ones, which begin at the door, and who asks the door."""

    first: Walk
    later: tuple[Walk, ...]
    asking: tuple[str, ...]


class SpeedFollower(Follower):
    """Follows the speed, and what a heat source makes of it until conduction takes it."""

    def __init__(self) -> None:
        super().__init__(holds_speed)
        #: Number of steps by then, and the module that took the W/m3.
        self.arrivals: list[tuple[int, str]] = []
        self.asking: set[str] = set()

    def returned(self, call: Call, taker: Call, value: Any) -> None:
        """As of `Follower`; an array made of the speed is the heat source where conduction takes it."""
        super().returned(call, taker, value)
        if call.module == DOOR != taker.module and self.holds(value):
            self.asking.add(taker.module)
        if call.handed and isinstance(value, np.ndarray):
            taker.handed = True
            if room(taker.module) == "conduction" != room(call.module):
                self.note(call, taker, "W/m3")
                self.arrivals.append((len(self.steps), taker.module))


def holds_speed(value: Any) -> bool:
    """Is it the speed, a table of the file with its text, or an object with the speed in a field?"""
    if isinstance(value, Mapping):
        return any(holds_speed(entry) for entry in value.values())
    if isinstance(value, list | tuple):
        return any(holds_speed(entry) for entry in value)
    # A phase holds a ramp, which holds the number.
    return _in_fields(value, depth=2)


def _in_fields(value: Any, depth: int) -> bool:
    if isinstance(value, str):
        return value == TEXT
    if isinstance(value, float):
        return bool(abs(value - SPEED) < 1e-9)
    return depth > 0 and any(_in_fields(part, depth - 1) for part in parts(value))


def speed_walks() -> SpeedWalks:
    """Write the study, run it, and follow its speed."""
    import tyrefem as tf

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "study.toml"
        text = tf.study(STUDY, CHANGES).save(file).read_text(encoding="utf-8")
        file.write_text(re.sub(r'(?m)^speed = ".*"$', f'speed = "{TEXT}"', text), encoding="utf-8")
        with SpeedFollower() as follower:
            tf.study(file).run()
    ends = [0, *(count for count, _ in follower.arrivals)]
    steps = [tuple(follower.steps[start:end]) for start, end in pairwise(ends)]
    walks = [Walk(part, module) for part, (_, module) in zip(steps, follower.arrivals, strict=True)]
    return SpeedWalks(walks[0], tuple(walks[1:]), tuple(sorted(follower.asking - {DOOR})))
