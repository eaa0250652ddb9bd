"""Meshes of sections, structured or from gmsh, with the section's own names; and meshes from files."""

from tyrefem.meshing.build import MESHERS, build
from tyrefem.meshing.files import read, read_for, write
from tyrefem.meshing.tyre_mesh import TyreMesh

__all__ = ["MESHERS", "TyreMesh", "build", "read", "read_for", "write"]
