"""The unstructured mesher, by pygmsh; the only module that imports pygmsh and gmsh (GPL)."""

from __future__ import annotations

import contextlib
import ctypes
import signal
import threading
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError, MissingLibraryError
from tyrefem.geometry.meshing.blocks import Blocks, make_blocks
from tyrefem.geometry.meshing.groups import mirrored, named_from
from tyrefem.geometry.section import Section

#: Options for reproducible meshes and a silent gmsh.
_OPTIONS = {
    "General.Terminal": 0,
    "General.NumThreads": 1,
    "Mesh.RandomSeed": 1,
    "Mesh.ElementOrder": 1,
    "Mesh.SaveAll": 0,
    "Mesh.MeshSizeFromPoints": 0,
    "Mesh.MeshSizeExtendFromBoundary": 1,
}
_BY_CELL = {
    "tri": {"Mesh.Algorithm": 6, "Mesh.RecombineAll": 0, "Mesh.SubdivisionAlgorithm": 0},
    "quad": {"Mesh.Algorithm": 8, "Mesh.RecombineAll": 1, "Mesh.SubdivisionAlgorithm": 1},
}

#: gmsh has one global model: threads use it one after the other.
_LOCK = threading.Lock()
#: gmsh element types -> meshio cell, number of nodes.
_CELLS = {1: ("line", 2), 2: ("triangle", 3), 3: ("quad", 4)}


def gmsh_mesh(section: Section, size: float, cell: str, through: int) -> Any:
    """scikit-fem mesh of a section, unstructured within each layer and region.

    Quadrilaterals come from recombined triangles of twice the size, each cut into four.

    Raises
    ------
    MissingLibraryError : pygmsh, gmsh or a system library of gmsh is missing.
    InputError : gmsh cannot mesh this section.
    """
    half = section.as_half()
    coarse = 2.0 if cell == "quad" else 1.0
    blocks = make_blocks(half, size * coarse, max(1, round(through / coarse)))
    with _LOCK, _gmsh({**_OPTIONS, **_BY_CELL[cell]}) as pygmsh:
        try:
            _draw(pygmsh.geo.Geometry(), half, blocks).generate_mesh(dim=2)
            raw = _extract()
        except Exception as error:  # gmsh raises plain Exception for all its failures
            raise InputError(f"gmsh cannot mesh section '{section.name}': {error}", field="mesher") from error
    mesh = named_from(raw, regions=half.regions, boundaries=half.boundaries)
    return mesh if section.half else mirrored(mesh)


def _draw(geometry: Any, section: Section, blocks: Blocks) -> Any:
    """Lines, surfaces and named groups in the CAD kernel of gmsh."""
    points: dict[bytes, Any] = {}

    def lines(side: NDArray[np.float64]) -> list[Any]:
        """One CAD line per edge, so that both meshers have the same points on the outline."""
        for place in side:
            if place.tobytes() not in points:
                points[place.tobytes()] = geometry.add_point((float(place[0]), float(place[1]), 0.0))
        nodes = [points[place.tobytes()] for place in side]
        made = [geometry.add_line(a, b) for a, b in pairwise(nodes)]
        for line in made:
            geometry.set_transfinite_curve(line, 2, "Progression", 1.0)
        return made

    along = {place: lines(side) for place, side in blocks.along.items()}
    across = {place: lines(side) for place, side in blocks.across.items()}
    n, last = len(section.layers), len(blocks.spans) - 1
    groups: dict[str, list[Any]] = {}
    hollow = {k for k in range(last) if section.in_groove(blocks.middle(k))}
    for i, layer in enumerate(section.layers):
        for k in range(last):
            if i == n - 1 and k in hollow:
                continue
            back = [-line for line in reversed(along[i + 1, k])] + [-line for line in reversed(across[i, k])]
            loop = geometry.add_curve_loop([*along[i, k], *across[i, k + 1], *back])
            name = str(layer.regions.at(blocks.middle(k)))
            groups.setdefault(name, []).append(geometry.add_plane_surface(loop))
    edges: dict[str, list[Any]] = {"contained_air": [], "symmetry": []}
    for k in range(last):
        edges["contained_air"] += along[0, k]
        if k in hollow:
            walls = [line for side in (k, k + 1) if side > 0 for line in across[n - 1, side]]
            edges.setdefault(section.groove_boundary, []).extend([*along[n - 1, k], *walls])
        else:
            edges.setdefault(str(section.outer.at(blocks.middle(k))), []).extend(along[n, k])
    for i in range(n if 0 not in hollow else n - 1):
        edges["symmetry"] += across[i, 0]
    for i in range(n):
        edges[section.outer.names[-1]] += across[i, last]
    for name, members in [*groups.items(), *edges.items()]:
        geometry.add_physical(members, name)
    return geometry


def _extract() -> Any:
    """The current gmsh model as a meshio mesh, one block of cells per element type of a physical group."""
    import gmsh
    import meshio

    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags] = np.arange(len(tags))
    cells, owners = [], []
    for dimension, group in gmsh.model.getPhysicalGroups():
        name = gmsh.model.getPhysicalName(dimension, group)
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, group):
            types, _, nodes = gmsh.model.mesh.getElements(dimension, entity)
            for element_type, connected in zip(types, nodes, strict=True):
                kind, corners = _CELLS[int(element_type)]
                cells.append((kind, number[connected].reshape(-1, corners)))
                owners.append(name)
    everything = [np.arange(len(data)) for _, data in cells]
    nothing = np.zeros(0, dtype=np.int64)
    sets = {
        name: [every if owner == name else nothing for owner, every in zip(owners, everything, strict=True)]
        for name in dict.fromkeys(owners)
    }
    return meshio.Mesh(coordinates.reshape(-1, 3), cells, cell_sets=sets)


@contextlib.contextmanager
def _gmsh(options: dict[str, float]) -> Iterator[Any]:
    """pygmsh with gmsh started, silent and without its signal handler; afterwards gmsh has its previous state."""
    pygmsh, gmsh = _load()
    running = bool(gmsh.isInitialized())
    if not running:
        gmsh.initialize(readConfigFiles=False, interruptible=False)
        _ignore_broken_pipes()
    kept = {name: gmsh.option.getNumber(name) for name in options}
    model = gmsh.model.getCurrent() if running else ""
    try:
        for name, value in options.items():
            gmsh.option.setNumber(name, value)
        gmsh.model.add("tyrefem section")
        yield pygmsh
    finally:
        if running:
            gmsh.model.remove()
            gmsh.model.setCurrent(model)
            for name, value in kept.items():
                gmsh.option.setNumber(name, value)
        else:
            gmsh.finalize()


def _ignore_broken_pipes() -> None:
    """Ignore SIGPIPE as Python does. gmsh resets it at start; a write to a dead worker would then end this process."""
    if hasattr(signal, "SIGPIPE") and signal.getsignal(signal.SIGPIPE) == signal.SIG_IGN:
        # Python allows this call in the main thread only.
        set_handler = ctypes.pythonapi.PyOS_setsig
        set_handler.argtypes, set_handler.restype = (ctypes.c_int, ctypes.c_void_p), ctypes.c_void_p
        set_handler(signal.SIGPIPE, int(signal.SIG_IGN))


def gmsh_works() -> bool:
    """True if the mesher and its system libraries can be loaded."""
    try:
        _load()
    except MissingLibraryError:
        return False
    return True


def _load() -> tuple[Any, Any]:
    """pygmsh and gmsh; an error names what to install."""
    try:
        import gmsh
        import pygmsh
    except ModuleNotFoundError as error:
        raise MissingLibraryError(
            f"the gmsh mesher needs the Python package '{error.name}': pip install 'tyrefem[gmsh]',"
            " or choose mesher 'mapped'",
            field="mesher",
        ) from error
    except (ImportError, OSError) as error:
        raise MissingLibraryError(
            f"gmsh is installed but cannot be loaded: {error}. Install that system library (Debian: apt-get install"
            " libglu1-mesa libgl1 libxrender1 libxcursor1 libxfixes3 libxft2 libfontconfig1 libxinerama1 libgomp1),"
            " then pip install 'tyrefem[gmsh]' if need be; or choose mesher 'mapped'",
            field="mesher",
        ) from error
    return pygmsh, gmsh
