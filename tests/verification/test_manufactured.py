"""Manufactured axisymmetric solutions: observed order of accuracy in space, on distorted meshes."""

from __future__ import annotations

import numpy as np
import pytest
import skfem

from tyrefem.conduction import Conduction, Film, Fixed, Flux, Material

A, B, RATE, FILM = 2.0, 3.0, 0.3, 6.0
PLACES = np.column_stack(
    [np.random.default_rng(1).uniform(0.55, 1.45, 300), np.random.default_rng(2).uniform(0.05, 0.95, 300)]
)


def temperature(r, z, t):
    return 40 + 20 * np.sin(A * r) * np.cos(B * z) * np.exp(-RATE * t)


def slopes(r, z, t):
    decay = 20 * np.exp(-RATE * t)
    return A * np.cos(A * r) * np.cos(B * z) * decay, -B * np.sin(A * r) * np.sin(B * z) * decay


def distorted(n: int, cls: type):
    mesh = cls.init_tensor(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1))
    x, y = mesh.p
    bump = 0.08 * np.sin(np.pi * x) * np.sin(np.pi * y)
    small = 1e-9
    return (
        type(mesh)(np.stack([0.5 + x + bump, y - bump]), mesh.t)
        .with_subdomains({"body": np.arange(mesh.t.shape[1])})
        .with_boundaries(
            {
                "inside": lambda p: p[0] < 0.5 + small,
                "outside": lambda p: p[0] > 1.5 - small,
                "top": lambda p: p[1] > 1 - small,
            }
        )
    )


def problem(n: int, cls: type, element: str, kind: str, steady: bool) -> Conduction:
    """Fixed inside, film outside, flux on top, insulated below; the source makes `temperature` exact."""
    capacity = 0.0 if steady else 1.5

    def k(T):
        return {
            "isotropic": (0.8, 0.8),
            "orthotropic": (0.8, 2.0),
            "variable": (0.8 + 0.01 * T, 0.8 + 0.01 * T),
        }[kind]

    def when(t):
        return 0.0 if steady else t

    def source(x, t, T):
        r, z = x
        t = when(t)
        true = temperature(r, z, t)
        dr, dz = slopes(r, z, t)
        k1, k2 = k(true)
        growth = 0.01 if kind == "variable" else 0.0
        div = k1 * (-(A**2) * (true - 40) + dr / r) - k2 * B**2 * (true - 40) + growth * (dr**2 + dz**2)
        return -capacity * RATE * (true - 40) - div - 0.5 * (T - true)

    def sink(x, t):
        true = temperature(*x, when(t))
        return true + k(true)[0] * slopes(*x, when(t))[0] / FILM

    material = Material(k if kind == "variable" else k(0.0) if kind == "orthotropic" else 0.8, 1.5)
    boundaries = {
        "inside": Fixed(lambda x, t: temperature(*x, when(t))),
        "outside": Film(h=FILM, sink=sink),
        "top": Flux(lambda x, t: k(temperature(*x, when(t)))[1] * slopes(*x, when(t))[1]),
    }
    return Conduction(distorted(n, cls), {"body": material}, boundaries, {"body": source}, element=element)


def observed_order(errors: list[float]) -> float:
    return float(np.log2(errors[-2] / errors[-1]))


@pytest.mark.parametrize("kind", ["isotropic", "orthotropic", "variable"])
@pytest.mark.parametrize("cls", [skfem.MeshTri, skfem.MeshQuad])
@pytest.mark.parametrize(("element", "sizes", "order"), [("P1", (16, 32), 1.9), ("P2", (8, 16), 2.85)])
def test_steady_order_in_space(element, sizes, order, cls, kind) -> None:
    errors = []
    for n in sizes:
        field = problem(n, cls, element, kind, steady=True).steady()
        difference = field.at(PLACES) - temperature(*PLACES.T, 0.0)
        errors.append(float(np.sqrt(np.mean(difference**2))))
    assert observed_order(errors) > order
    assert errors[-1] < (0.03 if element == "P1" else 0.002)


@pytest.mark.parametrize("kind", ["orthotropic", "variable"])
@pytest.mark.parametrize("cls", [skfem.MeshTri, skfem.MeshQuad])
@pytest.mark.parametrize(("element", "sizes", "order"), [("P1", (16, 32), 1.9), ("P2", (6, 12), 2.85)])
def test_transient_order_in_space(element, sizes, order, cls, kind) -> None:
    errors = []
    for n in sizes:
        case = problem(n, cls, element, kind, steady=False)
        start = temperature(*case.points("body"), 0.0)
        history = case.transient([0.0, 1.0], initial=start, tolerance=2e-4)
        difference = history.at(PLACES)[-1] - temperature(*PLACES.T, 1.0)
        errors.append(float(np.sqrt(np.mean(difference**2))))
    assert observed_order(errors) > order


def test_turned_axes_give_the_same_field_as_coordinate_axes() -> None:
    """A planar square turned by 45 degrees with k along the turned axis equals the straight one."""
    c = np.sqrt(0.5)
    mesh = skfem.MeshTri.init_tensor(np.linspace(0, 1, 13), np.linspace(0, 1, 13))
    names = {"body": np.arange(mesh.t.shape[1])}
    edges = {"left": lambda x: x[0] < 1e-9, "top": lambda x: x[1] > 1 - 1e-9}
    straight = mesh.with_subdomains(names).with_boundaries(edges)
    turned = skfem.MeshTri(np.stack([c * (mesh.p[0] - mesh.p[1]), c * (mesh.p[0] + mesh.p[1])]), mesh.t)
    turned = turned.with_subdomains(names).with_boundaries(straight.boundaries)
    boundaries = {"left": Film(3.0, 20.0), "top": Fixed(80.0)}
    fields = []
    for shape, direction in ((straight, None), (turned, lambda x: np.full_like(x, c))):
        material = Material((5.0, 0.5), 1e3, direction=direction)
        case = Conduction(shape, {"body": material}, boundaries, {"body": 10.0}, axisymmetric=False, element="P2")
        fields.append(case.steady())
    assert fields[1].values == pytest.approx(fields[0].values, abs=1e-9)
    flux, turned_flux = fields[0].flux_at([(0.3, 0.4)])[0], fields[1].flux_at([(-0.1 * c, 0.7 * c)])[0]
    assert turned_flux == pytest.approx([c * (flux[0] - flux[1]), c * (flux[0] + flux[1])], rel=1e-9)
