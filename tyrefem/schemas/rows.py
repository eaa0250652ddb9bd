"""Keys inside the answers: rows of lists, and tables within tables.

``COMMAND.KEY[]`` is a row of a list, ``COMMAND.KEY{}`` the table behind each name, ``COMMAND.KEY`` the table itself.
Lines are written as in `tyrefem.schemas.answers`. Further keys may come; those here stay.
"""

from __future__ import annotations

from tyrefem.schemas.answers import ANSWERS, Keys
from tyrefem.schemas.diagnosis_rows import DIAGNOSIS_INNER, DIAGNOSIS_ROWS
from tyrefem.schemas.inner_rows import COMMON, INNER, MESH, SECTION

_PLACE = {
    "r_m": "number: Radius.", "z_m": "number: Axial place, from the middle.",
    "s_m": "number: Along the meridian, from the crown.", "depth_m": "number: From the inner surface.",
}  # fmt: skip
_DEVIATION = {
    "bias_K": "number?: Mean of computed minus measured.", "rms_K": "number?: Root mean square.",
    "n": "integer: Number of readings.",
}  # fmt: skip
_PLUGIN = {
    "kind": "text: effect, boundary law, tan delta law, strain law, friction law or sweep answer.",
    "name": "text: Its name.", "class": "text: Its class.", "file*": "text: Its file.",
    "package*": "text: Its package.", "entry*": "text: Its entry point.", "version": "text: Its version, or empty.",
    "sha256": "text: Checksum of the file.",
}  # fmt: skip
_MEAN = {
    "low": "any: Least number, or first choice.", "high": "any: Greatest number, or last choice.",
    "number": "text: Varied number with its unit.",
    "effect": "number: Change of the answer from least to greatest.",
}  # fmt: skip

_POINT = {
    "F_x_N": "number: Force on the tyre, forward.", "F_y_N": "number: To the left.", "F_z_N": "number: Load.",
    "M_x_Nm": "number: Overturning moment.", "M_y_Nm": "number: Rolling resistance moment.",
    "M_z_Nm": "number: Aligning moment.", "slip_angle_rad": "number: Slip angle.", "slip": "number: Slip.",
    "camber_rad*": "number: Camber.", "speed_m_s": "number: Speed.", "torque_Nm": "number: Torque of the axle.",
    "sliding_share": "number: Share of the load on points that slide.", "friction_power_W": "number: Friction power.",
    "turn_slip_1_m": "number: Curvature of the path.", "deflection_m": "number: Deflection.",
    "travel_m_rad": "number: Travel per radian of rotation.", "pneumatic_trail_m": "number?: Trail.",
    "loss_power_W": "number?: Power that the rubber loses.", "axle_power_W": "number?: Power of the axle.",
    "footprint_length_m": "number: Greatest length of the contact.",
    "footprint_width_m": "number: Width, with its grooves.", "footprint_area_m2": "number: Area of the contact.",
    "mean_contact_pressure_Pa": "number: Load over area.", "peak_contact_pressure_Pa": "number: Greatest pressure.",
}  # fmt: skip

#: Place in an answer -> its keys.
ROWS: dict[str, Keys] = {
    "run.hottest": {
        "temperature_degC": "number: Highest temperature.", "time_s": "number: When.", "region": "text: Where.",
        **_PLACE,
    },
    "run.rolling_resistance": {
        "phase": "text: The phase, at whose end it is, or before it rests or leaves the road.",
        "force_N": "number: Force, warm.",
        "coefficient": "number: Force over load.", "cold_force_N": "number: Force at the starting temperature.",
        "cold_coefficient": "number: The same over load.",
    },
    "run.published[]": {
        "quantity": "text: What.", "value": "number: Computed.", "unit": "text: Its unit.",
        "low": "number: Least published value.", "high": "number: Greatest.", "verdict": "text: inside or outside.",
        "source": "text: Where published.",
    },
    "run.footprint": {
        "motion": "text: large or linear.", "load_N": "number: Load.", "deflection_m": "number: Deflection.",
        "tangent_stiffness_N_m": "number: Slope of the load.", "length_m": "number: Length.",
        "width_m": "number: Width.", "area_m2": "number: Area of rubber in contact.",
        "rolling_radius_m": "number: Travel per radian.", "harmonics": "integer: Number of Fourier harmonics.",
        "error": "number: Their relative error; of rolling with friction, that of the horizontal force.",
        "left_out_by_linear_strains*": "table: Strains that linear strains leave out.",
    },
    "run.contained_air": {
        "temperature_degC": "number: At the end.", "gauge_pressure_Pa": "number: At the end.",
    },
    "run.sensors{}": {"end_degC": "number: Last reading.", "max_degC": "number: Highest reading."},
    "run.extremes[]": {
        "region": "text: A region, or tyre.", "temperature_degC": "number: Highest temperature.",
        "time_s": "number: When.", **_PLACE,
    },
    "run.heat_budget": {
        "imbalance": "number: Largest residual of any time over the largest heat exchanged.",
        "residual_J": "number: Generated + sliding - stored - lost at the end.",
        "generated": "table: Part of the section -> energy_J, power_W at the end.",
        "stored": "table: Region -> energy_J, power_W at the end.",
        "lost": "table: Way out -> energy_J, power_W at the end.",
        "lumped": "table: Body of one temperature -> energy_J.",
        "sliding*": "table: Friction heat -> energy_J, power_W at the end.",
    },
    "run.states{}": {
        "unit": "text: Unit.", "meaning": "text: What it is.", "start": "number: At the begin.",
        "end": "number: At the end.", "min": "number: Least.", "max": "number: Greatest.",
    },
    "run.phases[]": {
        "name": "text: Name.", "start": "number: Begin, s.", "end": "number: End, s.", "speed": "number: m/s.",
        "load": "number: N.", "pressure": "number: Gauge, Pa.", "deflection": "number: m.",
        "rolling_radius": "number: m.", "footprint_length": "number: m.", "footprint_area": "number?: m2.",
        "road_fraction": "number: Share of a turn on the road.", "road_film": "number: W/m2/K, during contact.",
        "air_film": "number: W/m2/K.", "propagation_depth": "number?: Depth of a turn's temperature wave, m.",
        "sliding_speed": "number: m/s.", "locked": "boolean: Does the wheel stand?",
    },
    "run (campaign).cases[]": {
        "case": "text: Name of the case.", "note": "text: Note of the table of cases.",
        "section": "text?: Its section.",
        "load_N": "number?: Load at the end of the last phase.", "pressure_Pa": "number?: Its gauge pressure.",
        "speed_m_s": "number?: Its speed.", "deflection_m": "number?: Its deflection.",
        "road_fraction": "number?: Its share of a turn on the road.",
        "hottest_degC": "number?: Highest temperature.", "hottest_region": "text?: Where.",
        "hottest_s_m": "number?: Along the meridian.", "hottest_depth_m": "number?: From the inner surface.",
        "hottest_time_s": "number?: When.",
        "rolling_resistance_phase": "text?: The rolling phase with most heat.",
        "rolling_resistance_N": "number?: Force at its end.",
        "rolling_resistance_coefficient": "number?: Force over load.",
        "heat_budget_imbalance": "number?: Largest residual of any time over the largest heat exchanged.",
        "failure": "text?: Why it failed; else empty.",
        "*": "any: REGION_max_degC and SENSOR_degC.",
    },
    "compare.rows[]": {
        "run": "text: Measured run.", "sensor": "text: Sensor.", "phase": "text: Phase, or all.",
        "hold_out": "boolean: Is the run held out?", **_DEVIATION,
        "n_effective": "number: Number of independent readings.", "largest_K": "number?: Largest deviation.",
        "at_s": "number?: When.", "u_num_K": "number: Standard uncertainty of the numerics.",
        "u_input_K": "number: Of the inputs.", "u_data_K": "number: Of the data.", "u_val_K": "number: All of them.",
        "u_reading_K": "number: Of a single reading.", "beyond": "boolean: Is the deviation beyond k u_val?",
        "verdict": "text: In words.",
    },
    "compare.inputs[]": {
        "run": "text: Measured run.", "sensor": "text: Sensor.", "phase": "text: Phase, or all.",
        "key": "text: Dotted name of the input.", "relative_sd": "number: Its relative standard deviation.",
        "sd": "text: The same as people read it: a share, of a temperature kelvins.",
        "change_K": "number: Change of the mean deviation by one standard deviation.",
        "regions": "text: Regions that have it.",
    },
    "compare.overall": _DEVIATION,
    "sweep.sample": {
        "sample": "text: grid, sobol, latin-hypercube, list ...", "count": "integer?: Number of variants wanted.",
        "seed": "integer?: Seed.", "variants": "integer: Number of variants.",
        "finished": "table: full, reduced, failed: numbers of variants.",
        "reduced_model": "table?: Certificate.", "why_full_runs": "text?: Why no reduced model.",
        "linked*": "table: Name -> numbers that change together.",
        "seconds": "number: Time, s.", "taken_up": "integer: Variants of an earlier, interrupted sweep.",
    },
    "sweep.sweep": {"main_effects": "table: Answer -> rows.", "words": "list: In sentences."},
    "sweep.sweep.main_effects{}[]": _MEAN,
    "sweep.pareto": {
        "aims": "table: Answer -> min or max.", "variants": "list: Variants on the front.",
        "words": "list: In sentences.",
    },
    "sweep.tornado.rows[]": {
        "answer": "text: Answer.", "number": "text: Uncertain number.", "tolerance": "number: Relative tolerance.",
        "nominal": "number?: Answer of the unchanged study.", "less": "number?: Change by the smaller number.",
        "more": "number?: By the larger.", "range": "number?: Distance of both.", "also": "text: Further regions.",
        "failure": "text: Why a run failed; else empty.",
    },
    "sweep.envelope": {
        "rows": "list: Largest speed of every load and pressure.", "rating_tkph": "list: Load times speed.",
        "runs": "integer: Evaluated variants, by full runs or the reduced model.",
        "why_full_runs": "text?: Why no reduced model.",
        "asked": "written: As read; keys as in schemas/sweep.json.",
        "words": "list: In sentences.",
    },
    "sweep.optimum": {
        "changes": "table: Number -> value of the best variant.", "answers": "table: Answer -> value, by a full run.",
        "as_it_is": "table: The study's own answers.", "limits": "table: Answer -> limits.",
        "evaluated": "integer: Number of variants.", "exhaustive": "boolean: Was every variant tried?",
        "ended": "text: Why the search ended.", "why_full_runs": "text?: Why no reduced model.",
        "asked": "written: As read; keys as in schemas/sweep.json.",
        "words": "list: In sentences.",
    },
    "press --critical-speed.critical[]": {
        "pressure_Pa": "number: Gauge pressure.", "temperature_degC": "number?: Temperature of the cards.",
        "speed_m_s": "number?: Critical speed; null: none.", "waves": "integer?: Waves round the wheel.",
        "wavelength_m": "number?: Their length.", "radius_m": "number?: Radius of the crown at this speed.",
        "radius_growth_m": "number?: Its growth by the rotation.",
        "any_wave_m_s": "number?: Speed from which any wave stands, also of the tread alone.",
        "any_wave_waves": "integer?: Its waves.", "any_wave_region": "text?: Where it moves most.",
        "speed_without_centrifugal_tension_m_s": "number?: Critical speed without the tension of the rotation.",
        "highest_harmonic": "integer: Of the search.",
    },
    "modes.modes[]": {
        "harmonic": "integer: Waves round the wheel.", "frequency_Hz": "number: Natural frequency.",
        "direction*": "text: forward, backward or standing, of a rotating tyre.",
        "axle_frequency_Hz*": "number: Of a rotating tyre, seen from the axle.",
        "name": "text: Its name.", "radial": "number: Share of the motion.", "lateral": "number: The same.",
        "circumferential": "number: The same.", "belt": "number: Motion of the belt over that of the tyre.",
    },
    "life.places[]": {
        "region": "text: Region.", **_PLACE, "life_km": "number?: Distance until a crack.",
        "normal_r": "number: Normal of the worst plane.", "normal_z": "number: The same.",
        "normal_t": "number: The same.",
        "plane_from_circumference_deg": "number: Angle of the plane to the circumference, degrees.",
        "normal_from_axis_deg": "number: Angle of its normal to the axis, degrees.",
        "peak_J_m3": "number: Greatest cracking energy.", "valley_J_m3": "number: Least.",
        "tearing_energy_J_m2": "number: Energy release of the flaw.", "stretch": "number: Greatest stretch.",
        "shear_share": "number: Share of shear.", "temperature_degC": "number: Temperature.",
        "phase": "text: Phase that hurts most.", "phase_share": "number: Its share.", "reason": "text: In words.",
    },
    "strain.laws{}": {
        "deflection_m": "number: Deflection.", "energy_J": "table: Part -> strain energy.",
        "mean_energy_J_m3": "table: Part -> mean density.",
        "heating_energy_J": "table: Part -> strain energy that heats.",
        "cold_coefficient": "number: Rolling resistance over load, cold.", "coefficient": "number: At the end.",
        "temperatures_degC": "table: Hottest of the whole run, sensors and contained air at its end -> temperature.",
        "hottest": "table: As of run.",
    },
    "rig identify.estimates[]": {
        "name": "text: Layer and property.", "unit": "text: Unit.", "group": "text: property, slope or rig.",
        "value": "number: Best estimate.", "low_95": "number: Lower end of the 95 % interval.",
        "high_95": "number: Upper end.", "sd": "number: Standard deviation.", "relative_sd": "number?: Over the value.",
        "prior_value": "number: Before the tests.", "prior_sd": "number: Before the tests.",
        "share_of_prior_sd_left": "number: Standard deviation over that before.", "verdict": "text: determined ...",
    },
    "rig identify.residuals[]": {
        "run": "text: Test.", "sensor": "text: Sensor.", "mean_K": "number: Mean.",
        "rms_K": "number: Root mean square.",
    },
    "rig identify.diffusivities[]": {
        "layer": "text: Layer.", "value_m2_s": "number: Diffusivity, m2/s.", "relative_sd": "number: Over the value.",
    },
    "rig layers.rows[]": {
        "layers": "integer: Number of layers.", "names": "text: Their names.",
        "transient_misfit_K": "number: While heating and cooling.", "steady_misfit_K": "number: At the plateau.",
        "rms_K": "number: Of all residuals.", "model_error": "number: Error of the model over the rise.",
        "log_evidence": "number: Over one layer, nats.", "determined": "integer: Properties that are determined.",
        "doubtful": "integer: Properties in doubt: the model misses the readings.",
        "properties": "integer: Of how many.",
    },
    "thermal-card.numbers[]": {
        "name": "text: Conductance or capacity.", "unit": "text: Unit.", "value": "number: Value.",
        "sd": "number: Standard deviation.", "verdict": "text: determined ...", "per_area*": "number?: Over its area.",
        "per_area_sd*": "number?: Its standard deviation.", "area_m2*": "number?: The area.",
    },
    "thermal-card.rows[]": {
        "run": "text: Run.", "body": "text: Body.", "quantity": "text: plateau, warm_up or cool_down.",
        "unit": "text: Unit.",
        "measured": "number: Measured.", "computed": "number: Computed.", "sd": "number: Standard deviation.",
    },
    "road averaging.rows[]": {
        "footprint_length_m": "number: Length of the footprint.", "speed_m_s": "number: Speed.",
        "resolved_degC": "number: Surface, every contact resolved.", "averaged_degC": "number: Film averaged.",
        "difference_K": "number: Averaged minus resolved.", "swing_K": "number: Swing of a revolution.",
    },
    "road table.table_1[]": {
        "speed_m_s": "number: Speed.", "footprint_length_m": "number: Length of the footprint.",
        "literature_W_m2_K": "number: Of the paper's source.", "printed_W_m2_K": "number: Of the paper.",
        "recomputed_W_m2_K": "number: Here.",
    },
    "road table.table_2[]": {
        "speed_km_h": "number: Speed.", "footprint_length_m": "number: Length of the footprint.",
        "printed_W_m2_K": "number: Of the paper.", "recomputed_W_m2_K": "number: Here.",
    },
    "slide locked-wheel.rows[]": {
        "speed_km_h": "number: Speed.", "exit_rise_K": "number: Rise at the exit edge.", "mean_rise_K": "number: Mean.",
        "uncapped_exit_rise_K": "number: Without decomposition.", "friction": "number: Coefficient of friction.",
    },
    "slide tables.rubber_on_wood[]": {
        "name": "text: Slider and speed.", "observed_K": "number: Of the paper.", "uncertainty_K": "number: Its error.",
        "predicted_K": "number: Here.", "deviation_K": "number: Predicted minus observed.",
        "deviation": "number: The same over observed.", "printed_K": "number: Prediction of the paper.",
        "printed_follows": "boolean: Does it follow from the paper's equations?",
    },
    "check.plugins[]": {**_PLUGIN, "contracts": "list: The contracts."},
    "check.plugins[].contracts[]": {
        "words": "text: What the plugin must do.", "fault": "text?: What is wrong; null: kept.",
        "trials": "integer: How often it was tried.",
    },
    "roll (curve).points[]": _POINT,
    "forces.points[]": {**_POINT, "free": "number: 1: the torque is given, not the slip."},
    "show.facts": {
        **{f"{key.removesuffix('*')}*": line for key, line in {**MESH, **SECTION}.items() if key != "*"},
        "load_N*": "number: Load of the strains.", "pressure_Pa*": "number: Gauge pressure.",
        "deflection_m*": "number: Deflection.", "rolling_radius_m*": "number: Travel per radian.",
        "footprint_length_m*": "number: Length of the footprint.",
        "road_fraction*": "number: Share of a turn on the road.", "regions*": "list: Strain and energy by region.",
        "*": "any: What else the picture shows.",
    },
    "show.facts.regions[]": {"*": "any: Column of the table that is printed -> value."},
    **DIAGNOSIS_ROWS,
    "list.entries[]": {
        "name": "text: Name.", "title*": "text: Title.", "file*": "text?: File.",
        "side*": "text: Side of a boundary law.",
        "family*": "text: Family of an effect.", "plugin*": "text: Where a plugin is from.",
    },
}  # fmt: skip


def rows_of(command: str) -> dict[str, Keys]:
    """Places inside a command's answer, without the command's name, and their keys.

    >>> list(rows_of("rig layers"))
    ['rows[]']
    """
    known = {key.removesuffix("*") for key in ANSWERS[command]}
    places = {place: keys for key, rows in COMMON.items() if key in known for place, keys in rows.items()}
    inner = {**ROWS, **INNER, **DIAGNOSIS_INNER}.items()
    places |= {place.partition(".")[2]: keys for place, keys in inner if place.partition(".")[0] == command}
    if "plugins[]" not in places and any(key.removesuffix("*") == "plugins" for key in ANSWERS[command]):
        places["plugins[]"] = _PLUGIN
    return places
