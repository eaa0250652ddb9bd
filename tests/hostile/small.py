"""Studies and a rig so small that every command ends within seconds."""

from __future__ import annotations

from pathlib import Path

import numpy as np

DRIVE = 'drive = { speed = "20 mph", load = "2700 lbf", pressure = "83 psi", ambient = "25 degC", duration = "20 s" }'
SENSORS = """[sensors]
crown = { s = "0.33 in", depth = "0.30 in", lag = "2 s" }
shoulder = { s = "2.00 in", depth = "0.07 in", lag = "2 s" }
"""
#: One fitted and one held-out run; a second fitted run.
MEASURED, SECOND = (
    "".join(
        f'[[measured]]\ntable = "measured.csv"\nrun = "{run}"\ndrive = {{ {drive} }}\nhold_out = {hold_out}\n'
        for run, drive, hold_out in runs
    )
    for runs in (
        [("slow", "", "false"), ("fast", 'speed = "25 mph"', "true")],
        [("loaded", 'load = "3000 lbf"', "false")],
    )
)
#: All but these effects are left out of a diagnosis.
RIVALS = ("hot-road", "sensor-offset")


def study(*, drive: str = DRIVE, sensors: str = SENSORS, measured: str = MEASURED, cases: str = "") -> str:
    """A study file."""
    from tyrefem.effects import catalogue

    left_out = ", ".join(f'"{name}"' for name in sorted(catalogue()) if name not in RIVALS)
    return f"""title = "small"
section = "nasa-22x5.5-8pr"
materials = {{ carcass = "nasa-carcass", tread = "nasa-tread", sidewall = "nasa-sidewall", bead = "nasa-bead" }}
{cases}
{drive}
boundaries = {{ road = {{ law = "constant", coefficient = "2500 W/m**2/K" }} }}
mesh = {{ size = "15 mm", element = "P1" }}
numerics = {{ tolerance = "1 K" }}
output = {{ every = "5 s" }}
diagnosis = {{ exclude = [{left_out}] }}
{sensors}
{measured}
"""


def table(crown: float = 0.1, shoulder: float = 0.137) -> str:
    """Three measured runs of both sensors, which warm up by so many kelvin a second: as computed, or otherwise."""
    rng = np.random.default_rng(1)
    rows = ["run,time [s],crown [degC],shoulder [degC]"] + [
        f"{run},{t:g},{25 + crown * t + rng.normal():.2f},{25 + shoulder * t + rng.normal():.2f}"
        for run in ("slow", "loaded", "fast")
        for t in np.arange(0.0, 21.0, 2.0)
    ]
    return "\n".join(rows) + "\n"


RIG = """title = "small rig"
[laser]
spot_diameter = "10 mm"
[patch]
radius = "40 mm"
[phases]
idle = "10 s"
heating = "20 s"
cooling = "10 s"
[surroundings]
ambient = "22 degC"
characteristic_length = "100 mm"
[[layers]]
name = "tread"
thickness = "6 mm"
density = { value = "1150 kg/m**3", source = "estimate" }
conductivity = { value = "0.25 W/m/K", relative_sd = 0.5, source = "estimate" }
specific_heat = { value = "1700 J/kg/K", relative_sd = 0.3, source = "estimate" }
[sensors.outer]
instrument = "camera"
face = "outer"
window = "4 mm"
noise = "0.1 delta_degC"
[runs.a]
power = "1 W"
"""


THERMAL = """title = "one body"
[bodies.tyre]
heat_share = 1.0
[[films]]
between = ["tyre", "air"]
[[runs]]
name = "a"
speed = "10 m/s"
rolling_resistance = "50 N"
air = "20 degC"
plateau = { tyre = "70 degC" }
warm_up = { tyre = "600 s" }
"""


def write(folder: Path) -> Path:
    """A folder with ``study.toml``, its table, a rig with its table, a thermal card; returns it."""
    from tyrefem.cli import main

    folder.mkdir(parents=True)
    (folder / "study.toml").write_text(study())
    (folder / "measured.csv").write_text(table())
    (folder / "thermal.toml").write_text(THERMAL)
    (folder / "rig").mkdir()
    (folder / "rig" / "rig.toml").write_text(RIG)
    assert main(["rig", "simulate", str(folder / "rig"), "--seed", "1", "--out", str(folder / "simulated")]) == 0
    (folder / "simulated" / "a.csv").rename(folder / "rig" / "a.csv")
    return folder
