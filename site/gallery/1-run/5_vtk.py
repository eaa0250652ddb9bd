"""
The tyre in 3D
==============

VTK files open in ParaView and pyvista. ``revolved=True`` turns the section into a ring; half of it is cut away, so that
the hot carcass shows.
"""

import tempfile

import numpy as np
import pyvista

import tyrefem as tf

result = tf.study("nasa-22x5.5-8pr").replace({"mesh.size": "10 mm", "output.fields": 3}).run()
folder = tempfile.mkdtemp()
result.to_vtk(folder, revolved=True)

reader = pyvista.get_reader(f"{folder}/nasa-22x5.5-8pr-revolved.pvd")
reader.set_active_time_value(reader.time_values[-1])
half = reader.read()[0]
plotter = pyvista.Plotter()
surface = half.clip("z").extract_surface(algorithm="dataset_surface")
bar = {"title": "degC", "vertical": True}
plotter.add_mesh(surface, scalars="temperature_degC", cmap="inferno", lighting=False, scalar_bar_args=bar)
plotter.view_vector((-1, 0.4, -0.8))
plotter.show()

# %%
# The ring's volume is that of the section by Pappus: area times the way of its centre.

section = pyvista.get_reader(f"{folder}/nasa-22x5.5-8pr.pvd").read()[0].compute_cell_sizes(length=False, volume=False)
radius = section.cell_centers().points[:, 1]
assert np.isclose(half.volume, 2 * np.pi * (section["Area"] * radius).sum(), rtol=0.005)
