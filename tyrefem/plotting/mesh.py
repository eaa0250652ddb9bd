"""The mesh as the solver sees it: elements coloured by region, boundaries by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from tyrefem.plotting.section import BOUNDARIES
from tyrefem.plotting.style import FILLS, FONT, INK, TITLE, add_axes, figure, millimetres, section_axes, title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from tyrefem.meshing import TyreMesh


def mesh_figure(tyre_mesh: TyreMesh) -> Figure:
    """Every element of the mesh, as modelled (a half section is not mirrored)."""
    from matplotlib.collections import LineCollection, PolyCollection

    mesh = tyre_mesh.mesh
    points = np.stack(millimetres(mesh.p.T), axis=1)
    low, high = points.min(axis=0), points.max(axis=0)
    tall = 5.6 if tyre_mesh.section.half else 4.6
    scale = (high[1] - low[1]) / tall
    wide = (high[0] - low[0]) / scale
    legend = max(2.4, 0.075 * max(len(f"{region}: 1000 elements") for region in tyre_mesh.section.regions) + 0.5)
    drawn = figure(max(wide + 0.9 + legend, 7.4), tall + 0.3 + 0.5 + TITLE)
    axes = add_axes(drawn, 0.7, 0.5, wide + 0.2, tall + 0.3)
    axes.set_xlim(low[0] - 0.1 * scale, high[0] + 0.1 * scale)
    axes.set_ylim(low[1] - 0.15 * scale, high[1] + 0.15 * scale)
    # Thin edges on fine meshes: black must not cover the regions' colours.
    edge = float(np.clip(0.6 * np.sqrt(2000 / max(tyre_mesh.n_elements, 1)), 0.08, 0.6))
    for number, region in enumerate(tyre_mesh.section.regions):
        elements = np.asarray(mesh.subdomains[region])
        axes.add_collection(
            PolyCollection(
                points[mesh.t[:, elements].T], facecolors=FILLS[number % len(FILLS)], edgecolors="#404040", lw=edge,
                label=f"{region}: {len(elements)} elements",
            )
        )  # fmt: skip
    for name, facets in (mesh.boundaries or {}).items():
        ends = points[mesh.facets[:, np.asarray(facets)].T]
        color = BOUNDARIES.get(name, INK)
        axes.add_collection(
            LineCollection(ends, colors=color, lw=2.2, ls=":" if name == "symmetry" else "-",
                           label=f"{name.replace('_', ' ')}: {ends.shape[0]} edges")
        )  # fmt: skip
    section_axes(axes)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=FONT, frameon=False)
    quality = tyre_mesh.quality
    title(
        drawn, f"{tyre_mesh.section.name}: {tyre_mesh.mesher} mesh",
        f"{tyre_mesh.n_nodes} nodes, {tyre_mesh.n_elements} {tyre_mesh.cell}s of {tyre_mesh.size * 1e3:.3g} mm; "
        f"scaled Jacobian ≥ {quality['scaled_jacobian']:.2f}, edge ratio ≤ {quality['edge_ratio']:.1f}",
    )  # fmt: skip
    return drawn
