"""What a user may state, and what the error says when it does not fit."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import skfem

from tyrefem.conduction import Conduction, Convection, Film, Fixed, Flux, Material, Radiation, Reservoir, SolverError
from tyrefem.conduction.datum import checked
from tyrefem.conduction.linear_solver import Ordering
from tyrefem.conduction.transient import Integration
from tyrefem.errors import InputError

RUBBER = Material(conductivity=0.21, heat_capacity=2.09e6)


def square(n: int = 6, cls: type = skfem.MeshTri):
    mesh = cls.init_tensor(np.linspace(0.1, 1.1, n + 1), np.linspace(0, 1, n + 1))
    return mesh.with_subdomains(
        {
            "carcass": lambda x: x[0] < 0.6,
            "tread": lambda x: x[0] > 0.6,
            "all": lambda x: x[0] > 0,
        }
    ).with_boundaries({"inside": lambda x: x[0] < 0.1001, "outside": lambda x: x[0] > 1.0999})


REGIONS = {"carcass": RUBBER, "tread": RUBBER}
MESH = square()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"regions": {"carcas": RUBBER, "tread": RUBBER}}, "did you mean 'carcass'"),
        ({"regions": {"carcass": RUBBER}}, r"36 elements belong to no region \(in all, tread\)"),
        ({"regions": {**REGIONS, "all": RUBBER}}, "region 'all' shares 72 elements with carcass, tread"),
        ({"regions": {"carcass": RUBBER, "tread": 0.2}}, "must be a Material"),
        ({"boundaries": {"outsid": Film(1.0, 2.0)}}, "did you mean 'outside'"),
        ({"boundaries": {"outside": 20.0}}, "must be a Film, Flux, Radiation or Fixed"),
        ({"boundaries": {"outside": Film(1.0, "air")}}, "unknown reservoir 'air'"),
        ({"sources": {"trad": 1.0}}, "did you mean 'tread'"),
        ({"sources": {"tread": "hot"}}, "must be a number or f"),
        ({"element": "P3"}, "unknown element 'P3'"),
        ({"reservoirs": {"gas": Reservoir(1.0, exchanges=((1.0, "rmi"),)), "rim": Reservoir(1.0)}}, "'rim'"),
    ],
)
def test_problems_that_do_not_fit_the_mesh(change: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Conduction(**{"mesh": MESH, "regions": REGIONS, "boundaries": {}, **change})


@pytest.mark.parametrize(
    "make",
    [
        lambda: Material(-0.2, 2e6),
        lambda: Material(0.2, 0.0),
        lambda: Material((1.0, 2.0, 3.0), 2e6),
        lambda: Material("rubber", 2e6),
        lambda: Film(-1.0, 25.0),
        lambda: Film(float("nan"), 25.0),
        lambda: Flux(float("inf")),
        lambda: Radiation(1.2, 25.0),
        lambda: Radiation(0.9, -300.0),
        lambda: Fixed(None),
        lambda: Reservoir(-1.0),
    ],
)
def test_impossible_numbers_are_refused(make) -> None:
    with pytest.raises(InputError):
        make()


@pytest.mark.parametrize("times", [[0.0], [0.0, 0.0], [1.0, 0.5], [0.0, np.nan], [[0.0, 1.0]]])
def test_bad_times_are_refused(times) -> None:
    with pytest.raises(InputError, match="strictly increasing"):
        Conduction(MESH, REGIONS).transient(times)


def test_bad_run_arguments_are_refused() -> None:
    problem = Conduction(MESH, REGIONS)
    for arguments in (
        {"tolerance": 0.0},
        {"initial": np.zeros(3)},
        {"initial": np.nan},
        {"max_step": -1.0},
        {"breakpoints": [np.inf]},
    ):
        with pytest.raises(InputError):
            problem.transient([0.0, 1.0], **arguments)


def test_functions_returning_nonsense_are_named() -> None:
    wrong_shape = Conduction(MESH, REGIONS, {"outside": Film(lambda x, t: np.ones(2), 25.0)})
    with pytest.raises(InputError, match=r"boundaries.outside.h: the function returned shape \(2,\)"):
        wrong_shape.transient([0, 1])
    not_finite = Conduction(MESH, REGIONS, {}, {"tread": lambda x, t, T: T * np.nan})
    with pytest.raises(InputError, match=r"sources\.tread"):
        not_finite.transient([0, 1])
    negative = Conduction(MESH, {**REGIONS, "tread": Material(lambda T: -T, 2e6)}, {"outside": Fixed(50.0)})
    with pytest.raises(InputError, match=r"regions.tread.conductivity: is not positive"):
        negative.steady()


def test_a_film_that_turns_negative_is_named_at_every_look() -> None:
    cooling = Conduction(MESH, REGIONS, {"outside": Film(lambda x, t: 1.0 - t, 25.0)})
    film = cooling._balance().loads[0].h  # type: ignore[attr-defined]
    assert film(0.5) == 0.5
    for _ in range(2):
        with pytest.raises(InputError, match=r"boundaries.outside.h: is below 0 at t = 2 s"):
            film(2.0)


def test_any_finite_number_may_be_returned() -> None:
    large = np.array([1e200, -1e200, 0.0])
    assert checked(large, 3, "q", 0.0) is large
    for value in (np.nan, np.inf, np.array([1.0, np.inf, -np.inf]), np.array([np.nan, 1.0, 1e200])):
        with pytest.raises(InputError, match="q: the function returned a value that is not finite at t = 3 s"):
            checked(value, 3, "q", 3.0)


def test_steady_problem_without_a_sink_is_refused() -> None:
    with pytest.raises(InputError, match="needs a Fixed, Film or Radiation"):
        Conduction(MESH, REGIONS, {"outside": Flux(10.0)}).steady()
    floating = {"gas": Reservoir(5.0)}
    with pytest.raises(InputError, match="needs a Fixed, Film or Radiation"):
        Conduction(MESH, REGIONS, {"inside": Film(5.0, "gas")}, reservoirs=floating).steady()


def test_runaway_has_no_steady_state() -> None:
    """A source growing faster with temperature than the films can carry away."""
    problem = Conduction(MESH, REGIONS, {"outside": Film(1.0, 25.0)}, {"all": lambda x, t, T: 50 * np.exp(T / 20)})
    with pytest.raises(SolverError):
        problem.steady()


def test_points_outside_are_named_with_their_distance() -> None:
    field = Conduction(MESH, REGIONS, {"outside": Fixed(50.0)}).steady()
    with pytest.raises(InputError, match=r"point \(1.3, 0.5\) m lies 0.2 m outside the mesh"):
        field.at([(0.5, 0.5), (1.3, 0.5)])
    assert field.at([(1.1 + 5e-10, 0.5)]) == pytest.approx([50.0])
    with pytest.raises(InputError, match="finite pairs"):
        field.at([(0.5, 0.5, 0.5)])
    with pytest.raises(InputError, match="did you mean 'outside'"):
        field.flux_through("outsid")


@pytest.mark.parametrize("cls", [skfem.MeshTri, skfem.MeshQuad])
@pytest.mark.parametrize("element", ["P1", "P2"])
def test_interpolation_reproduces_a_linear_field(element: str, cls: type) -> None:
    mesh = square(5, cls)
    x, y = mesh.p
    bent = type(mesh)(np.stack([x + 0.1 * y, y + 0.2 * x]), mesh.t).with_subdomains(mesh.subdomains)
    problem = Conduction(bent, {"all": Material((2.0, 3.0), 1e6)}, axisymmetric=False, element=element)
    start = 5 + 3 * problem.points("all")[0] - 2 * problem.points("all")[1]
    field = problem.transient([0.0, 1e-6], start).field(0)
    a, b = np.random.default_rng(0).uniform(0, 1, (2, 50))
    inside = np.column_stack([0.1 + a + 0.1 * b, b + 0.2 * (0.1 + a)])
    assert field.at(inside) == pytest.approx(5 + 3 * inside[:, 0] - 2 * inside[:, 1], abs=1e-10)
    assert field.flux_at(inside) == pytest.approx(np.tile([-6.0, 6.0], (50, 1)), abs=1e-8)
    assert field.at(bent.p.T[:4]) == pytest.approx(5 + 3 * bent.p[0, :4] - 2 * bent.p[1, :4], abs=1e-10)


def test_problems_on_one_mesh_share_their_operators() -> None:
    first = Conduction(MESH, REGIONS, {"outside": Film(5.0, 20.0)}, {"tread": 1.0})
    other = {"carcass": Material(9.0, 1e6), "tread": Material((1.0, 2.0), 1e6)}
    second = Conduction(MESH, other, {"outside": Film(7.0, 20.0)}, {"tread": 2.0})
    assert second.operators is first.operators
    assert second.operators.mass("tread") is first.operators.mass("tread")
    assert second.operators.surface("outside") is first.operators.surface("outside")
    assert second.points("tread") is first.points("tread")


def test_source_sees_the_same_points_at_every_call() -> None:
    seen: set[int] = set()
    sizes: set[tuple[int, ...]] = set()

    def source(x, t, T):
        seen.add(id(x))
        sizes.add((*x.shape, *T.shape))
        return 1e5 + 0 * T

    problem = Conduction(MESH, REGIONS, {}, {"tread": source}, element="P2")
    problem.transient([0, 10.0])
    n = problem.points("tread").shape[1]
    assert seen == {id(problem.points("tread"))}
    assert sizes == {(2, n, n)}


def test_interrupted_run_keeps_what_was_finished() -> None:
    def stop(t: float) -> None:
        if t > 250:
            raise KeyboardInterrupt

    problem = Conduction(MESH, REGIONS, {"outside": Film(50.0, 20.0)}, {"tread": 2e5})
    whole = problem.transient(np.arange(0, 1001, 100.0), max_step=30.0)
    # A part is for those who ask for one: everybody else would take it for the whole.
    with pytest.raises(KeyboardInterrupt):
        problem.transient(np.arange(0, 1001, 100.0), max_step=30.0, progress=stop)
    part = problem.transient(np.arange(0, 1001, 100.0), max_step=30.0, progress=stop, partial=True)
    assert part.interrupted
    assert not whole.interrupted
    assert part.times.tolist() == [0.0, 100.0, 200.0]
    assert part.values == pytest.approx(whole.values[:3], abs=1e-12)
    assert part.budget.imbalance < 1e-9
    assert part.field(-1).time == 200.0


@pytest.mark.parametrize("shape", [(150, 4), (110, 110)], ids=["thin: banded", "square: sparse"])
def test_factorisation_suits_the_shape_and_solves(shape: tuple[int, int]) -> None:
    mesh = skfem.MeshTri.init_tensor(*(np.linspace(0.1, 1.1, n + 1) for n in shape))
    mesh = mesh.with_subdomains({"body": np.arange(mesh.t.shape[1])})
    problem = Conduction(mesh, {"body": RUBBER}, element="P2")
    ops = problem.operators
    free = np.arange(5, ops.size)
    ordering = ops.ordering(free)
    assert isinstance(ordering, Ordering)
    assert ordering.banded == (shape[1] == 4)
    data = ops.mass("body") + 0.01 * sum(ops.conduction("body", None))
    x = np.random.default_rng(0).normal(size=free.size)
    A = ops.matrix(data)[free][:, free]
    assert ordering.factor(data).solve(A @ x) == pytest.approx(x, abs=1e-9)


@pytest.mark.parametrize(("element", "close"), [("P1", 2e-2), ("P2", 1e-4)])
def test_curved_triangles_hold_a_disc(element: str, close: float) -> None:
    """T = 1 - x^2 - y^2 for a source of 4 W/m3 and k = 1; all of 4 pi W leaves through the rim."""
    disc = skfem.MeshTri2.init_circle(3)
    disc = disc.with_subdomains({"disc": np.arange(disc.t.shape[1])}).with_boundaries({"rim": disc.boundary_facets()})
    body = {"disc": Material(1.0, 1.0)}
    problem = Conduction(disc, body, {"rim": Fixed(0.0)}, {"disc": 4.0}, axisymmetric=False, element=element)
    field = problem.steady()
    edge = 0.9999 * np.array([np.cos(0.1), np.sin(0.1)])
    assert field.at([(0, 0), (0.3, 0.4), edge]) == pytest.approx([1.0, 0.75, 1 - 0.9999**2], abs=close)
    assert field.flux_through("rim") == pytest.approx(4 * np.pi, rel=1e-5)


def test_results_survive_pickling() -> None:
    """Runs come back from worker processes."""
    problem = Conduction(MESH, REGIONS, {"outside": Film(5.0, 20.0)}, {"tread": 1e5})
    history = problem.transient([0.0, 60.0])
    copy = pickle.loads(pickle.dumps(history))
    assert copy.at([(0.8, 0.3)]) == pytest.approx(history.at([(0.8, 0.3)]), abs=0)
    assert copy.field(-1).flux_through("outside") == history.field(-1).flux_through("outside")


def test_a_body_whose_every_node_has_a_given_temperature_is_refused() -> None:
    mesh = skfem.MeshQuad.init_tensor(np.array([0.1, 0.2]), np.array([0.0, 1.0]))
    mesh = mesh.with_subdomains({"all": lambda x: x[0] > 0}).with_boundaries(
        {"inside": lambda x: x[0] < 0.11, "outside": lambda x: x[0] > 0.19}
    )
    with pytest.raises(InputError, match="nothing is left to compute"):
        Conduction(mesh, {"all": RUBBER}, {"inside": Fixed(1.0), "outside": Fixed(2.0)})


def test_a_region_without_elements_is_refused() -> None:
    mesh = MESH.with_subdomains({"none": lambda x: x[0] > 9})
    with pytest.raises(InputError, match="region 'none' has no elements"):
        Conduction(mesh, {**REGIONS, "none": RUBBER})


@pytest.mark.parametrize("order", [("none", "all"), ("all", "none")])
def test_a_source_where_there_are_no_elements_has_no_heat(order: tuple[str, str]) -> None:
    mesh = MESH.with_subdomains({"none": lambda x: x[0] > 9})
    sources = {name: lambda x, t, T: 1e5 for name in order}
    history = Conduction(mesh, REGIONS, {"outside": Film(10.0, 20.0)}, sources).transient([0.0, 10.0], 20.0)
    assert history.budget.generated["none"][-1] == 0.0
    assert history.budget.generated["all"][-1] > 0.0
    assert history.budget.imbalance < 1e-9


def test_ctrl_c_between_the_parts_of_one_time_leaves_the_whole_times(monkeypatch: pytest.MonkeyPatch) -> None:
    record, seen = Integration._record, []

    def stop_at_the_third(self: Integration, *given: object) -> None:
        record(self, *given)
        seen.append(given)
        if len(seen) == 3:
            raise KeyboardInterrupt

    monkeypatch.setattr(Integration, "_record", stop_at_the_third)
    problem = Conduction(MESH, REGIONS, {"outside": Film(10.0, 20.0)})
    history = problem.transient(np.linspace(0.0, 100.0, 11), 50.0, partial=True)
    assert history.interrupted
    assert len(history.times) == len(history.values) == len(history.budget.residual) == 2


@pytest.mark.parametrize("condition", [Film(lambda x, t: 50.0 + 50.0 * (t > 0.3), 20.0), Fixed(lambda x, t: 100.0 + t)])
@pytest.mark.parametrize(
    "breakpoints", [[0.3, 0.1 + 0.2], [0.3, 0.3 + 1e-15], [5e-324, 0.3], [0.3, float(np.nextafter(1.0, 0.0))]]
)
def test_breakpoints_that_differ_by_rounding_are_one(condition: Film | Fixed, breakpoints: list[float]) -> None:
    """A phase that starts at 0.1 s + 0.2 s, and an effect that begins at 0.3 s."""
    problem = Conduction(MESH, REGIONS, {"outside": condition}, {"all": lambda x, t, T: 1e6 * (1 + (t > 0.3)) + 0 * T})
    history = problem.transient([0.0, 0.3, 1.0], 25.0, breakpoints=breakpoints)
    once = problem.transient([0.0, 0.3, 1.0], 25.0, breakpoints=[0.3])
    assert history.values[-1] == pytest.approx(once.values[-1], abs=1e-9)
    assert history.budget.imbalance < 1e-9


@pytest.mark.parametrize("rate", [0.01, 0.1])
def test_a_thermal_runaway_is_named(rate: float) -> None:
    """Heat that doubles with every few kelvins has no solution beyond a finite time: c dT/dt = q exp(b (T - T_0))."""

    def heat(x: np.ndarray, t: float, T: np.ndarray) -> np.ndarray:
        return 1e6 * np.exp(np.minimum(rate * (T - 25.0), 300.0))

    problem = Conduction(square(1), REGIONS, {}, {"all": heat})
    ends = RUBBER.heat_capacity / (1e6 * rate)
    with pytest.raises(SolverError, match="temperatures rise without bound") as error:
        problem.transient([0.0, 10 * ends], 25.0)
    assert float(str(error.value).split("t = ")[1].split()[0]) == pytest.approx(ends, rel=1e-3)


def test_far_too_much_heat_ends_a_run() -> None:
    problem = Conduction(square(1), REGIONS, {}, {"all": 1e12})
    with pytest.raises(SolverError, match="far too much heat"):
        problem.transient([0.0, 600.0], 25.0)


def test_a_function_cannot_move_the_points_that_it_is_given() -> None:
    """Problems on an equal mesh share them: ``x -= ...`` in a film would have moved those of the next problem."""

    def film(x: np.ndarray, t: float) -> np.ndarray:
        x -= 0.1
        return 20.0 + 0.0 * x[0]

    def source(x: np.ndarray, t: float, T: np.ndarray) -> np.ndarray:
        x *= 2.0
        return x[0]

    for conditions, sources in (({"outside": Film(film, 25.0)}, {}), ({"outside": Fixed(25.0)}, {"tread": source})):
        with pytest.raises(ValueError, match="read-only"):
            Conduction(MESH, REGIONS, conditions, sources).steady()
    with pytest.raises(ValueError, match="read-only"):
        Conduction(MESH, REGIONS, {"outside": Fixed(lambda x, t: film(x, t))}).steady()


def test_fields_and_histories_can_be_compared_and_counted() -> None:
    """An equality of arrays has no truth value: ``field in fields`` ended with a ValueError of numpy."""
    problem = Conduction(MESH, REGIONS, {"outside": Film(20.0, 25.0)})
    fields = [problem.steady(), problem.steady()]
    histories = [problem.transient([0.0, 1.0]), problem.transient([0.0, 1.0])]
    for first, second in (fields, histories):
        assert first == first
        assert first != second
        assert second in [first, second]
        assert len({first, second}) == 2
    for values in (fields[0].values, histories[0].values, histories[0].times, histories[0].points):
        with pytest.raises(ValueError, match="read-only"):
            values += 1.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mesh": None}, "mesh: a NoneType is not supported; use MeshTri or MeshQuad"),
        ({"mesh": "tyre.msh"}, "mesh: a str is not supported"),
        ({"regions": [RUBBER]}, r"regions: must be a mapping of names, not \[Material"),
        ({"regions": None}, "regions: must be a mapping of names, not None"),
        ({"boundaries": ["inside"]}, r"boundaries: must be a mapping of names, not \['inside'\]"),
        ({"sources": 1e5}, r"sources: must be a mapping of names, not 100000\.0"),
        ({"sources": {"tread": np.nan}}, r"sources\.tread: must be finite, not nan"),
        ({"reservoirs": {"gas": 50.0}}, r"reservoirs\.gas: must be a Reservoir, not 50\.0"),
    ],
)
def test_a_table_that_is_none(change, message):
    given = {"mesh": MESH, "regions": REGIONS, "boundaries": {"outside": Film(20.0, 25.0)}} | change
    with pytest.raises(InputError, match=message):
        Conduction(**given)


@pytest.mark.parametrize(
    ("times", "options", "message"),
    [
        (["a", "b"], {}, r"times: must be at least two finite, strictly increasing times, not \['a', 'b'\]"),
        ((t for t in (0.0, 1.0)), {}, "times: must be at least two finite, strictly increasing times, not <generator"),
        ([0.0, 1.0], {"initial": "25 degC"}, r"initial: must be a finite number or array \(49,\), not '25 degC'"),
        ([0.0, 1.0], {"breakpoints": ["a"]}, r"breakpoints: must be finite times, not \['a'\]"),
        ([0.0, 1.0], {"max_step": "1 s"}, "max_step: must be positive, not '1 s'"),
    ],
)
def test_times_and_temperatures_that_are_no_numbers(times, options, message):
    with pytest.raises(InputError, match=message):
        Conduction(MESH, REGIONS, {"outside": Film(20.0, 25.0)}).transient(times, **options)


@pytest.mark.parametrize("exchanges", [(2.0, 25.0), [(2.0,)], ["ab"]])
def test_exchanges_are_pairs(exchanges):
    with pytest.raises(InputError, match=r"exchanges: must be pairs \(conductance, other\), not "):
        Reservoir(50.0, exchanges=exchanges)


def test_a_function_cannot_change_the_temperatures_that_it_is_given():
    """``T += 273.15`` in a film had given 342 instead of 331 degC, in a source no steady field."""

    def film(T):
        T -= 20.0
        return 5.0 + abs(T)

    def source(x, t, T):
        T += 273.15
        return 300.0 - T

    for change in ({"boundaries": {"outside": Convection(film, 20.0)}}, {"sources": {"all": source}}):
        given = {"mesh": MESH, "regions": REGIONS, "boundaries": {"outside": Film(20.0, 25.0)}} | change
        with pytest.raises(ValueError, match="read-only"):
            Conduction(**given).steady()
