"""Meshes of sections, structured or from gmsh, with the section's names; and meshes from files."""

from tyrefem.geometry.meshing.mesh import MESHERS, TyreMesh, build
from tyrefem.geometry.meshing.mesh_files import read, read_for, write

__all__ = ["MESHERS", "TyreMesh", "build", "read", "read_for", "write"]
