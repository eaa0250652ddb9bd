"""A coarse bias tyre with strain by finite elements, as the tests of its motion need it."""

from __future__ import annotations

import tyrefem as tf

COARSE = {"mesh.size": "14 mm", "mesh.element": "P1", "drive.duration": "60 s", "drive.load": "1000 lbf"}


def bias(**changes: object) -> tf.Study:
    """The study, which says nothing of its motion."""
    return tf.study("nasa-22x5.5-8pr", {**COARSE, "mechanics.strain": "fem", **changes})
