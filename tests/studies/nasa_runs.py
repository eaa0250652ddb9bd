"""Runs of the shipped NASA studies at the report's operating conditions, each done once."""

from __future__ import annotations

import functools

import tyrefem as tf

TYRES = {"8PR": "nasa-22x5.5-8pr", "12PR": "nasa-22x5.5-12pr"}


@functools.cache
def run(ply_rating, load=None, pressure=None, speed=20, air="gas"):
    """Result after 5.4 km (600 s at 20 mph) at a load (lbf), pressure (psi) and speed (mph)."""
    drive = {"load": f"{load} lbf", "pressure": f"{pressure} psi"} if load else {}
    drive |= {"speed": f"{speed} mph", "duration": f"{600 * 20 / speed} s"}
    changes = {f"drive.{key}": value for key, value in drive.items()}
    return tf.study(TYRES[ply_rating]).replace({**changes, "boundaries.contained_air": {"law": air}}).run()


def end(result):
    """Readings at the end, degC."""
    return result.readings.iloc[-1]
