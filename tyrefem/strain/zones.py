"""Put the strain zones on a mesh, as named subdomains beside the regions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tyrefem.meshing import TyreMesh
from tyrefem.strain import Zone


def with_zones(tyre: TyreMesh, zones: Sequence[Zone]) -> TyreMesh:
    """The mesh with one subdomain per zone: the elements of its region whose centre lies between its ends.

    Both meshers conform to the shoulder, so zones end at element borders; a user's own mesh is cut at the nearest.
    """
    mesh = tyre.mesh
    centres = mesh.p[:, mesh.t].mean(axis=1)
    s = np.abs(tyre.section.locate(centres.T)[0])
    inside = {}
    for zone in zones:
        elements = np.asarray(mesh.subdomains[zone.region])
        inside[zone.name] = elements[(s[elements] >= zone.start) & (s[elements] < zone.end)]
    return replace(tyre, mesh=mesh.with_subdomains(inside))
