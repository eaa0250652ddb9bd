"""Natural convection, and the conduction solver's film that follows the surface temperature."""

from __future__ import annotations

import numpy as np
import pytest
import skfem
from curved_patch import film as tabulated_film

from tyrefem.conduction import Conduction, Convection, Film, Fixed, Material
from tyrefem.errors import InputError
from tyrefem.rig import air, natural_film, nusselt

pytestmark = pytest.mark.fast

#: Air at 1 atm (Incropera & DeWitt, table A.4): T in K, k in W/m/K, nu in m2/s, Pr.
TABLE = [(300.0, 0.0263, 15.89e-6, 0.707), (400.0, 0.0338, 26.41e-6, 0.690), (500.0, 0.0407, 38.79e-6, 0.684)]


@pytest.mark.parametrize(("T", "k", "nu", "Pr"), TABLE)
def test_air_is_that_of_the_tables(T: float, k: float, nu: float, Pr: float) -> None:
    assert [float(v) for v in air(T - 273.15)] == pytest.approx([k, nu, Pr], rel=0.03)


def test_nusselt_number_of_a_plate() -> None:
    """Churchill & Chu at Pr = 0.71: 0.825^2 without buoyancy, and the seven tenths of a published textbook example.

    Incropera & DeWitt, example 9.2: Ra = 1.813e9, Pr = 0.690 gives Nu = 147.
    """
    assert float(nusselt(0.0, 0.71)) == pytest.approx(0.825**2)
    assert float(nusselt(1.813e9, 0.690)) == pytest.approx(147.0, rel=0.01)
    with pytest.raises(InputError, match="negative"):
        nusselt(-1.0, 0.7)


def test_film_agrees_with_tabulated_air_and_is_even_in_the_difference() -> None:
    T = np.array([25.0, 40.0, 80.0, 150.0])
    assert natural_film(T, 22.0, 0.1) == pytest.approx(tabulated_film(T, 22.0, 0.1), rel=0.01)
    assert natural_film(22.0 + 1e-6, 22.0, 0.1) == pytest.approx(natural_film(22.0 - 1e-6, 22.0, 0.1))
    with pytest.raises(InputError, match="length"):
        natural_film(40.0, 20.0, 0.0)


def wall(outside: object, n: int = 8) -> Conduction:
    mesh = skfem.MeshQuad.init_tensor(np.linspace(0, 0.02, n + 1), np.array([0.0, 0.01]))
    mesh = mesh.with_subdomains({"wall": lambda x: x[0] > -1}).with_boundaries(
        {"hot": lambda x: x[0] == 0.0, "out": lambda x: x[0] > 0.02 - 1e-9}
    )
    return Conduction(mesh, {"wall": Material(0.3, 2e6)}, {"hot": Fixed(150.0), "out": outside}, axisymmetric=False)


def test_steady_wall_loses_what_convection_takes() -> None:
    """Through the wall k (150 - T)/L = h(T) (T - 20), with h from the law itself."""
    field = wall(Convection(lambda T: natural_film(T, 20.0, 0.1), 20.0)).steady()
    T = float(field.at([(0.02, 0.005)])[0])
    through = 0.3 * (150.0 - T) / 0.02
    assert through == pytest.approx(float(natural_film(T, 20.0, 0.1)) * (T - 20.0), rel=1e-8)
    assert field.flux_through("out") == pytest.approx(through * 0.01, rel=1e-8)


def test_a_constant_law_is_a_film_and_the_budget_closes() -> None:
    times = [0.0, 100.0, 1000.0, 4000.0]
    same = wall(Convection(lambda T: np.full_like(T, 12.0), 20.0)).transient(times, 20.0, 1e-4)
    film = wall(Film(12.0, 20.0)).transient(times, 20.0, 1e-4)
    assert same.values == pytest.approx(film.values, abs=2e-4)
    varying = wall(Convection(lambda T: natural_film(T, 20.0, 0.1), 20.0)).transient(times, 20.0, 1e-3)
    assert varying.budget.imbalance < 1e-9
    steady = wall(Convection(lambda T: natural_film(T, 20.0, 0.1), 20.0)).steady().values
    late = wall(Convection(lambda T: natural_film(T, 20.0, 0.1), 20.0)).transient([0.0, 2e5], 20.0, 1e-3)
    assert late.values[-1] == pytest.approx(steady, abs=1e-3)


def test_a_law_that_cannot_be_is_refused() -> None:
    with pytest.raises(InputError, match="function of the surface temperature"):
        Convection(12.0, 20.0)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="negative"):
        wall(Convection(lambda T: -np.ones_like(T), 20.0)).steady()
    with pytest.raises(InputError, match="shape"):
        wall(Convection(lambda T: np.ones(3), 20.0)).steady()
