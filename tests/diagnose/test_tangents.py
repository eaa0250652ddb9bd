"""Tangents of a transient against runs with the parameter changed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from skfem import MeshQuad

from tyrefem.conduction import Conduction, Film, Flux, Material, Reservoir
from tyrefem.conduction.sensitivity import Perturbed, stage_times, tangents
from tyrefem.errors import InputError

BREAKS = (0.0, 300.0, 600.0)
POINTS = [(0.505, 0.01), (0.52, 0.02), (0.515, 0.002)]
#: Parameter -> its value: one for every place where a number can enter.
VALUES = {
    "conductivity": 0.25, "slope": 0.002, "capacity": 2.0e6, "film": 40.0, "sink": 30.0, "heat": 2.0e5, "loss": 0.006,
    "flux": 400.0, "gas": 300.0, "initial": 25.0,
}  # fmt: skip


def ring(cells: int) -> Any:
    """A square ring of so many cells each way."""
    square = MeshQuad.init_tensor(np.linspace(0.5, 0.53, cells + 1), np.linspace(0.0, 0.03, cells + 1))
    edges = {
        "outer": lambda x: x[0] > 0.53 - 1e-9,
        "inner": lambda x: x[0] < 0.5 + 1e-9,
        "end": lambda x: x[1] > 0.03 - 1e-9,
    }
    return square.with_subdomains({"ring": lambda x: x[0] > 0}).with_boundaries(edges)


@pytest.fixture(scope="module")
def mesh() -> Any:
    """What all problems share."""
    return ring(4)


def problem(mesh: Any, **changes: float) -> Conduction:
    """A ring heated inside until 300 s, with air within, a film without and a flux at its end."""
    p = VALUES | changes
    return Conduction(
        mesh,
        regions={"ring": Material(lambda T: p["conductivity"] * (1 + p["slope"] * (T - 25.0)), p["capacity"])},
        boundaries={"outer": Film(p["film"], p["sink"]), "inner": Film(15.0, "gas"), "end": Flux(p["flux"])},
        sources={"ring": lambda x, t, T: p["heat"] * np.exp(-p["loss"] * (T - 25.0)) * (t < 300.0)},
        reservoirs={"gas": Reservoir(p["gas"])},
    )


def run(mesh: Any, times: Any, **changes: float) -> Any:
    """The history at times, resolved well beyond what is asked of the tangents."""
    initial = changes.get("initial", VALUES["initial"])
    return problem(mesh, **changes).transient(times, initial, 1e-4, breakpoints=BREAKS[1:-1])


def test_tangents_are_what_changed_runs_say(mesh: Any) -> None:
    times = stage_times(BREAKS, first=1.5, growth=1.4, longest=20.0)
    base = problem(mesh)
    history = base.transient(times, VALUES["initial"], 1e-4, breakpoints=BREAKS[1:-1])
    gas = history.reservoirs["gas"][:, None]
    steps = {name: 1e-4 * value for name, value in VALUES.items()}
    perturbed = [
        Perturbed(problem(mesh, **{name: VALUES[name] + step}), step, VALUES["initial"] + step * (name == "initial"))
        for name, step in steps.items()
    ]
    # All on the operators of one mesh, as the tyre's are.
    derivatives = tangents(base, times, history.values, gas, perturbed)
    at_points = derivatives.at(POINTS)
    for number, name in enumerate(VALUES):
        h = 0.03 * VALUES[name]
        high, low = (run(mesh, times, **{name: VALUES[name] + sign * h}) for sign in (1, -1))
        wanted = (high.at(POINTS) - low.at(POINTS)) / (2 * h)
        wanted_gas = (high.reservoirs["gas"] - low.reservoirs["gas"]) / (2 * h)
        # Ends of steps: the stages within are of lower order.
        close = {"rtol": 0, "atol": 0.02 * np.abs(wanted).max(), "err_msg": name}
        np.testing.assert_allclose(at_points[number, ::2], wanted[::2], **close)
        np.testing.assert_allclose(derivatives.reservoirs[number, ::2, 0], wanted_gas[::2], **close)


def test_error_falls_with_the_square_of_the_step(mesh: Any) -> None:
    # With a conductivity that varies with temperature a small error stays: its slope is not in dF/du.
    even, step, errors = {"slope": 0.0}, 0.01 * VALUES["heat"], []
    every = np.linspace(0.0, 300.0, 3)
    high, low = (run(mesh, every, heat=VALUES["heat"] + sign * step, **even) for sign in (1, -1))
    wanted = (high.at(POINTS) - low.at(POINTS))[-1] / (2 * step)
    for size in (60.0, 30.0, 15.0):
        times = stage_times((0.0, 300.0), first=size, growth=1.0, longest=size)
        base = problem(mesh, **even)
        history = base.transient(times, VALUES["initial"], 1e-5)
        item = Perturbed(problem(mesh, heat=VALUES["heat"] + step, **even), step, VALUES["initial"])
        derivatives = tangents(base, times, history.values, history.reservoirs["gas"][:, None], [item])
        errors.append(float(np.abs(derivatives.at(POINTS)[0, -1] - wanted).max()))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders.min() > 1.6


def test_another_mesh_is_refused(mesh: Any) -> None:
    times = stage_times((0.0, 10.0))
    base = problem(mesh)
    history = base.transient(times, 25.0)
    with pytest.raises(InputError, match="own mesh"):
        tangents(base, times, history.values, history.reservoirs["gas"][:, None], [Perturbed(problem(ring(3)), 1.0)])
