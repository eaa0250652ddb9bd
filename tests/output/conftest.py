"""Runs that the tests of pictures, VTK files and reports look at; each is computed once."""

from __future__ import annotations

import pytest

import tyrefem as tf

SMALL = {"mesh.size": "5 mm", "drive.duration": "120 s", "output.fields": 4}
NAME = '<b onclick="x()">$hot$ & "cold"</b>'
TITLE = "<script>alert('title')</script>"


def stopper(after):
    def stop(time):
        if time > after:
            raise KeyboardInterrupt

    return stop


@pytest.fixture(scope="session")
def study():
    return tf.study("nasa-22x5.5-8pr").replace(SMALL)


@pytest.fixture(scope="session")
def result(study):
    return study.run()


@pytest.fixture(scope="session")
def quadratic(study):
    """Full section, quadratic triangles, a lumped rim, and names that try to be markup or formulas."""
    changes = {
        "mesh.section": "full", "mesh.cell": "tri", "mesh.element": "P2", "mesh.size": "10 mm", "title": TITLE,
        "boundaries.rim": {"law": "lumped", "mass": "5 kg", "cooling": "1 W/K"},
    }  # fmt: skip
    changed = study.replace(changes)
    data = dict(changed.data)
    data["sensors"] = {
        **data["sensors"],
        NAME: {"s": "1 in", "depth": "0.5 in"},
        "left": {"s": "-2 in", "depth": "0.05 in"},
    }
    return tf.Study("nasa-22x5.5-8pr", data, changed.file, changed.folder).run()


@pytest.fixture(scope="session")
def standing(study):
    """A warm tyre that stands: no thermocouples, a lumped rim, no heat made."""
    data = dict(study.data)
    data.pop("sensors")
    data["drive"] = {**data["drive"], "speed": "0 mph", "initial": "80 degC"}
    data["boundaries"] = {**data["boundaries"], "rim": {"law": "lumped", "mass": "5 kg", "cooling": "1 W/K"}}
    return tf.Study("standing", data, None, study.folder).run()


@pytest.fixture(scope="session")
def stopped(study):
    """Interrupted after a good half of the drive."""
    return study.run(stopper(70.0), partial=True)


@pytest.fixture(scope="session")
def phased(study):
    """Rolling, then standing to cool: the hottest moment lies before the end."""
    data = dict(study.data)
    drive = {key: value for key, value in data["drive"].items() if key not in ("speed", "duration")}
    data["drive"] = {
        **drive,
        "phases": [
            {"name": "roll", "speed": {"from": "20 mph", "to": "40 mph"}, "duration": "120 s"},
            {"name": "stand", "speed": "0 mph", "duration": "600 s"},
        ],
    }
    return tf.Study("phased", data, None, study.folder).run()
