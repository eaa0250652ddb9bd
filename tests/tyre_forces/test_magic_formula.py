"""The Magic Formula: its slopes and peaks, coefficients from points, `.tir` files."""

from dataclasses import replace

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.tyre_forces.fitting import ALIGNING, LATERAL, LONGITUDINAL, MagicFormulaFit, fit_magic_formula
from tyrefem.tyre_forces.magic_formula import ALL, MagicFormula
from tyrefem.tyre_forces.points import ForcePoints
from tyrefem.tyre_forces.property_file import TyreDimensions, read_tir, tir_text

pytestmark = pytest.mark.fast

KNOWN = {
    "PCX1": 1.65, "PDX1": 1.1, "PDX2": -0.08, "PEX1": 0.3, "PEX2": 0.1, "PKX1": 22.0, "PKX2": 1.0, "PKX3": 0.1,
    "PCY1": 1.35, "PDY1": 0.98, "PDY2": -0.12, "PEY1": -0.8, "PEY2": -0.3, "PKY1": -17.0, "PKY2": 1.7, "PKY4": 2.0,
    "PKY6": -0.9, "PVY3": -0.2, "PHY1": 0.002, "PVY1": 0.01, "QBZ1": 9.0, "QBZ2": -1.0, "QBZ10": 1.0, "QCZ1": 1.15,
    "QDZ1": 0.1, "QDZ2": -0.01, "QEZ1": -2.0, "QHZ1": 0.003,
}  # fmt: skip
TYRE = MagicFormula(KNOWN, 4000.0, 2.2e5, 0.31)
LOADS = np.array([2000.0, 3500.0, 5000.0, 6500.0])
PARTS = TyreDimensions(0.205, 0.2032, 0.165, 0.55, 9.2, 2.0e5, 16.7)


ANGLES = np.radians(np.linspace(-12, 12, 17))
CAMBERS = np.radians([0.0, 2.0, 4.0])


def curves(loads=LOADS, angles=ANGLES, cambers=CAMBERS):
    load, angle, camber = (part.ravel() for part in np.meshgrid(loads, angles, cambers, indexing="ij"))
    steered = ForcePoints.of({
        "load": load, "slip_angle": angle, "camber": camber, "pressure": np.full(load.shape, 2.2e5),
        "lateral": TYRE.lateral_force(load, angle, camber), "aligning": TYRE.aligning_moment(load, angle, camber),
    })  # fmt: skip
    load, slip = (part.ravel() for part in np.meshgrid(loads, np.linspace(-0.3, 0.3, 20), indexing="ij"))
    driven = {"load": load, "slip": slip, "pressure": np.full(load.shape, 2.2e5)}
    driven["longitudinal"] = TYRE.longitudinal_force(load, slip)
    both = ForcePoints.of(driven)
    return ForcePoints.of({
        name: np.concatenate([getattr(steered, name), getattr(both, name)]) for name in ForcePoints.__annotations__
    })  # fmt: skip


@pytest.fixture(scope="module")
def fit():
    return fit_magic_formula(curves(), 0.31, nominal_load=4000.0)


def test_stiffness_is_the_slope_and_the_peak_is_friction_times_load():
    tyre = MagicFormula(KNOWN | {"PHY1": 0.0, "PVY1": 0.0}, 4000.0, 2.2e5, 0.31)
    step = 1e-6
    slope = (tyre.lateral_force(LOADS, step) - tyre.lateral_force(LOADS, -step)) / (2 * step)
    assert slope == pytest.approx(tyre.cornering_stiffness(LOADS), rel=1e-6)
    slope = (tyre.longitudinal_force(LOADS, step) - tyre.longitudinal_force(LOADS, -step)) / (2 * step)
    assert slope == pytest.approx(tyre.slip_stiffness(LOADS), rel=1e-6)
    largest = np.abs(tyre.longitudinal_force(4000.0, np.linspace(0, 1, 20001))).max()
    assert largest == pytest.approx(1.1 * 4000.0, rel=1e-5)


def test_moment_is_force_times_trail_near_straight_ahead():
    tyre = MagicFormula(KNOWN | {"PHY1": 0.0, "PVY1": 0.0, "QHZ1": 0.0}, 4000.0, 2.2e5, 0.31)
    assert tyre.trail(4000.0, 0.0) == pytest.approx(0.1 * 0.31)
    assert tyre.aligning_moment(4000.0, 0.01) == pytest.approx(
        -tyre.trail(4000.0, 0.01) * tyre.lateral_force(4000.0, 0.01)
    )
    assert tyre.aligning_moment(4000.0, 0.01) > 0 > tyre.lateral_force(4000.0, 0.01)


def test_residual_moment_of_camber_rises_with_pressure_and_has_its_square():
    """Pacejka 2012, 4.E47, at alpha = 0 without side force: F_z R_0 ((q_Dz8 (1 + p_pz2 dpi) + q_Dz10 |g|) g."""
    bare = {"PCY1": 1.3, "PDY1": 1.0, "PKY1": -20.0, "PKY2": 1.5, "PKY4": 2.0, "QBZ10": 1.0}
    tyre = MagicFormula(bare | {"QDZ8": -0.1, "PPZ2": 0.5, "QDZ10": 0.2, "QDZ11": 0.4}, 4000.0, 2.2e5, 0.31)
    camber = np.array([-0.05, 0.05])
    moments = tyre.aligning_moment(5000.0, 0.0, camber, 1.1 * 2.2e5)
    expected = 5000.0 * 0.31 * (-0.1 * (1 + 0.5 * 0.1) + (0.2 + 0.4 * 0.25) * 0.05) * camber
    assert moments == pytest.approx(expected, rel=1e-9)


def test_the_trail_is_the_lever_of_the_force_without_camber():
    """Pacejka 2012, 4.E32. With the whole force a file was read with 10 % of the largest moment too little or much."""
    bare = {"PCY1": 1.3, "PDY1": 1.0, "PKY1": -20.0, "PKY2": 1.5, "PKY4": 2.0, "PKY6": -0.9, "PKY3": 0.5, "QBZ10": 1.0}
    tyre = MagicFormula(bare | {"QDZ1": 0.1, "QCZ1": 1.2, "QBZ1": 9.0}, 4000.0, 2.2e5, 0.31)
    assert tyre.lateral_force(5000.0, 0.0, 0.05) < -100.0
    assert tyre.aligning_moment(5000.0, 0.0, 0.05) == 0.0
    angles = np.array([-0.06, 0.02])
    expected = -tyre.trail(5000.0, angles, 0.05) * tyre.lateral_force(5000.0, angles)
    assert tyre.aligning_moment(5000.0, angles, 0.05) == pytest.approx(expected, rel=1e-12)


def test_every_program_reads_the_same_trail_with_camber():
    """QDZ3 goes with the camber or with its size, as a program takes it; the fit has its square, QDZ4."""
    tyre = MagicFormula(KNOWN | {"QDZ3": -2.0}, 4000.0, 2.2e5, 0.31)
    points = curves(cambers=np.radians([0.0, -3.0]))
    aligning = tyre.aligning_moment(points.load, points.slip_angle, points.camber)
    columns = {name: getattr(points, name) for name in ForcePoints.__annotations__} | {"aligning": aligning}
    fit = fit_magic_formula(ForcePoints.of(columns), 0.31, nominal_load=4000.0)
    assert fit.errors["aligning"] < 1e-3
    assert fit.formula.coefficients.get("QDZ3", 0.0) == 0.0
    assert fit.formula.coefficients["QDZ4"] == pytest.approx(-2.0 / np.radians(3.0), rel=0.05)


def test_a_tir_file_of_camber_squared_is_read(tmp_path):
    path = tmp_path / "tyre.tir"
    path.write_text("FITTYP = 61\nFNOMIN = 4000\nNOMPRES = 2.2e5\nUNLOADED_RADIUS = 0.31\nQDZ10 = 0.2\nQDZ11 = 0.1\n")
    assert read_tir(path).coefficients == {"QDZ10": 0.2, "QDZ11": 0.1}


def test_fit_gives_the_coefficients_back(fit):
    assert max(fit.errors.values()) < 1e-7
    for name in fit.fitted:
        assert fit.formula.coefficients[name] == pytest.approx(KNOWN.get(name, 0.0), abs=2e-3), name
    assert set(KNOWN) - {"PKY4", "QBZ10"} <= set(fit.fitted)


def test_the_formula_can_be_built_from_the_summary(fit):
    summary = fit.summary()
    assert set(fit.fitted) <= set(summary["coefficients"])
    again = MagicFormula(summary["coefficients"], summary["nominal_load_N"], 2.2e5, summary["unloaded_radius_m"])
    assert again.cornering_stiffness(4200.0) == fit.formula.cornering_stiffness(4200.0) < -1e4
    assert (again.aligning_moment(4200.0, ANGLES, 0.03) == fit.formula.aligning_moment(4200.0, ANGLES, 0.03)).all()


def test_noise_moves_the_curves_by_no_more_than_itself():
    points = curves()
    noise = np.random.default_rng(3).normal(0.0, 20.0, len(points))
    noisy = ForcePoints.of(
        {name: getattr(points, name) for name in ForcePoints.__annotations__} | {"lateral": points.lateral + noise}
    )
    fit = fit_magic_formula(noisy, 0.31, nominal_load=4000.0)
    angles = np.radians(np.linspace(-12, 12, 49))
    left = fit.formula.lateral_force(5000.0, angles) - TYRE.lateral_force(5000.0, angles)
    assert np.sqrt((left**2).mean()) < 10.0


def test_one_load_and_one_sign_tell_fewer_coefficients():
    points = curves([3500.0], np.radians(np.linspace(0, 12, 9)), [0.0])
    fit = fit_magic_formula(points.where(points.slip >= 0), 0.31)
    assert set(fit.fitted) == set(" ".join((LONGITUDINAL[1], LATERAL[1], ALIGNING[1])).split())
    assert fit.errors["longitudinal"] < 1e-6
    assert max(fit.errors.values()) < 0.03


def test_few_slips_tell_no_curvature_and_do_not_bend_between_the_points():
    """With as many coefficients as points the curve went through all of them, and elsewhere."""
    plain = MagicFormula({k: v for k, v in KNOWN.items() if k not in ("PHY1", "PVY1", "QHZ1")}, 4000.0, 2.2e5, 0.31)
    load, angle = (part.ravel() for part in np.meshgrid([3000.0, 5000.0], np.radians([0.0, 1.0, 4.0, 8.0])))
    load, angle = np.append(load, [3000.0, 5000.0] * 3), np.append(angle, np.repeat(np.radians([0.0, 4.0, -4.0]), 2))
    camber = np.where(np.arange(len(load)) < 8, 0.0, np.radians(3.0))
    columns = {"load": load, "slip_angle": angle, "camber": camber}
    columns["lateral"] = plain.lateral_force(load, angle, camber)
    columns["aligning"] = plain.aligning_moment(load, angle, camber)
    fit = fit_magic_formula(ForcePoints.of(columns), 0.31, symmetric=True)
    assert {"PKY1", "PKY2", "PDY1", "PDY2", "PCY1", "PKY6", "QBZ1", "QDZ2"} <= set(fit.fitted)
    assert not {"PEY1", "PEY2", "QEZ1", "QEZ2", "PDY3", "QBZ5"} & set(fit.fitted)
    between = np.radians([0.5, 2.0, 6.0])
    largest = np.abs(fit.points.aligning).max()
    for each in (3000.0, 5000.0):
        moment = fit.formula.aligning_moment(each, between) - plain.aligning_moment(each, between)
        assert np.abs(moment).max() < 0.1 * largest
        stiffness = fit.formula.cornering_stiffness(each)
        assert stiffness == pytest.approx(plain.cornering_stiffness(each), rel=0.05)


def test_a_symmetric_tyre_has_no_ply_steer():
    plain = MagicFormula({k: v for k, v in KNOWN.items() if k not in ("PHY1", "PVY1", "QHZ1")}, 4000.0, 2.2e5, 0.31)
    points = curves()
    lateral = plain.lateral_force(points.load, points.slip_angle, points.camber)
    aligning = plain.aligning_moment(points.load, points.slip_angle, points.camber)
    columns = {name: getattr(points, name) for name in ForcePoints.__annotations__}
    steered = ForcePoints.of(columns | {"lateral": lateral, "aligning": aligning}).where(points.free)
    fit = fit_magic_formula(steered, 0.31, nominal_load=4000.0, symmetric=True)
    assert not {"PHY1", "PVY1", "PEY3", "QHZ1", "QDZ6"} & set(fit.fitted)
    assert fit.formula.cornering_stiffness(4000.0) == pytest.approx(plain.cornering_stiffness(4000.0), rel=1e-3)
    assert max(fit.errors.values()) < 1e-4


def test_only_what_was_given_is_fitted():
    points = curves()
    fit = fit_magic_formula(points.where(points.free), 0.31)
    assert set(fit.errors) == {"lateral", "aligning"}
    assert "PKX1" not in fit.fitted


def test_a_tir_file_gives_the_forces_back(fit, tmp_path):
    path = tmp_path / "tyre.tir"
    path.write_text(tir_text(fit, PARTS, "205/55R16 by finite elements"))
    again = read_tir(path)
    angles = np.radians(np.linspace(-10, 10, 21))
    assert again.lateral_force(4200.0, angles, 0.03) == pytest.approx(
        fit.formula.lateral_force(4200.0, angles, 0.03), rel=1e-5
    )
    assert again.aligning_moment(4200.0, angles) == pytest.approx(fit.formula.aligning_moment(4200.0, angles), abs=1e-3)
    assert again.longitudinal_force(4200.0, 0.07) == pytest.approx(
        fit.formula.longitudinal_force(4200.0, 0.07), rel=1e-6
    )


def test_a_tir_file_has_every_section_once(fit):
    text = tir_text(fit, PARTS, "title")
    sections = [part.partition("]")[::2] for part in text.split("\n[")]
    assert len({name for name, _ in sections}) == len(sections)
    assert {"MODEL", "VERTICAL", "ALIGNING_COEFFICIENTS"} <= {name for name, _ in sections}
    for _, part in sections:
        names = [line.partition("=")[0].strip() for line in part.splitlines() if "=" in line]
        assert len(names) == len(set(names))
    assert all(f"\n{name} " in text for name in ALL)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("FITTYP = 52\n", "must be 61, not 52"),
        ("FITTYP = 61\nPCY1 = many\n", "line 2: 'many' is not a number"),
        ("FITTYP = 61\nNOMPRES = 2e5\nUNLOADED_RADIUS = 0.3\n", "is missing"),
        ("FITTYP = 61\nFNOMIN = 4e3\nNOMPRES = 2e5\nUNLOADED_RADIUS = 0.3\nLMUY = 0.8\n", "must be 1, not 0.8"),
        ("FITTYP = 61\nFNOMIN = nan\n", "line 2: 'nan' is not a number"),
        ("FITTYP = 61\nPDY1 = inf\n", "line 2: 'inf' is not a number"),
        ("FITTYP = 61\nFNOMIN = 0\nNOMPRES = 2e5\nUNLOADED_RADIUS = 0.3\n", "wrong.tir: FNOMIN: must be positive"),
        ("LENGTH = 'mm'\nFITTYP = 61\n", "line 1: must be 'meter', not 'mm'"),
        ("ANGLE = 'degrees'\nFITTYP = 61\n", "line 1: must be 'radians', not 'degrees'"),
        ("LENGTH = mm\nFITTYP = 61\n", "line 1: must be 'meter', not 'mm'"),
        ('FORCE = "kN"\nFITTYP = 61\n', "line 1: must be 'newton', not 'kn'"),
        ("FITTYP = 61\nPCY1 = 1.3\nPCY1 = 1.4\n", "PCY1: line 3: is 1.4 here, 1.3 above"),
        ("FITTYP = 61\nLMUY = 'large'\n", "line 2: ''large'' is not a number"),
    ],
)
def test_a_wrong_tir_file_is_one_clear_error(text, message, tmp_path):
    path = tmp_path / "wrong.tir"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        read_tir(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_tir(tmp_path / "none.tir")


def test_numbers_in_quotes_are_numbers(tmp_path):
    path = tmp_path / "quoted.tir"
    path.write_text(
        "FITTYP = 61\nFNOMIN = '4e3'\nNOMPRES = 2e5\nUNLOADED_RADIUS = 0.3\nPCY1 = '1.3'\nTYRESIDE = 'LEFT'\n"
    )
    formula = read_tir(str(path))
    assert formula.coefficients == {"PCY1": 1.3}
    assert formula.nominal_load == 4e3


def test_wrong_points_are_one_clear_error():
    with pytest.raises(InputError, match="no column 'lateral_force'"):
        ForcePoints.of({"load": [1.0], "lateral_force": [1.0]})
    with pytest.raises(InputError, match="loads must be positive"):
        ForcePoints.of({"load": [0.0]})
    with pytest.raises(InputError, match="value 2 is not finite"):
        ForcePoints.of({"load": [1.0, 2.0], "lateral": [0.0, np.nan]})
    with pytest.raises(InputError, match="too few points"):
        fit_magic_formula(ForcePoints.of({"load": [1e3, 1e3], "slip_angle": [0.0, 0.1], "lateral": [0.0, -1e3]}), 0.3)
    with pytest.raises(InputError, match="no coefficient 'PCY7'"):
        MagicFormula({"PCY7": 1.0}, 4e3, 2e5, 0.3)


@pytest.mark.parametrize(
    ("deflection", "slope"),
    [(0.020, 2.0e5), (0.022, 2.6e5), (0.018, 1.9e5), (0.030, 3.0e5)],
    ids=["linear", "progressive", "degressive", "slope above twice the secant"],
)
def test_a_simulator_has_the_load_at_the_deflection_of_the_tyre(fit, tmp_path, deflection, slope):
    """As simulators read it: q_1 = sqrt(c² - 4 q_2), c = C_z0 R_0 / F_z0. Without q_2 the slope gives 6.6 mm less."""
    file = tmp_path / "tyre.tir"
    file.write_text(tir_text(fit, replace(PARTS, vertical_stiffness=slope, deflection=deflection), "spring"))
    entries = (line.partition("=") for line in file.read_text().splitlines())
    read = {name.strip(): value.strip() for name, _, value in entries}
    nominal, radius = float(read["FNOMIN"]), float(read["UNLOADED_RADIUS"])
    c, q_2 = float(read["VERTICAL_STIFFNESS"]) * radius / nominal, float(read["Q_FZ2"])
    q_1 = np.sqrt(c**2 - 4 * q_2)
    assert q_1 == pytest.approx(float(read["Q_FZ1"]), abs=1e-3)
    x = deflection / radius
    assert nominal * (q_1 * x + q_2 * x**2) == pytest.approx(4000.0, rel=1e-4)
    tangent = nominal / radius * (q_1 + 2 * q_2 * x)
    assert tangent == pytest.approx(min(slope, 1.98 * 4000.0 / deflection), rel=1e-4)


def test_a_slope_that_is_no_number_is_a_linear_spring(tmp_path):
    """Large motion gives none where its search for the slope does not end."""
    bare = MagicFormulaFit(TYRE, ForcePoints.of({"load": [4e3]}), (), {})
    text = tir_text(bare, replace(PARTS, vertical_stiffness=np.nan, deflection=0.02), "spring")
    entries = (line.partition("=") for line in text.splitlines())
    read = {name.strip(): value.strip() for name, _, value in entries}
    assert float(read["VERTICAL_STIFFNESS"]) == pytest.approx(4000.0 / 0.02)
    assert float(read["Q_FZ1"]) == pytest.approx(0.31 / 0.02)
    assert float(read["Q_FZ2"]) == pytest.approx(0.0, abs=1e-6)
