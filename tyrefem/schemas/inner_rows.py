"""Keys deeper inside the answers: tables that several commands have (`COMMON`), and those of one command (`INNER`).

Written as in `tyrefem.schemas.rows`. Words with ``->`` say: any names, each with a value.
"""

from __future__ import annotations

from tyrefem.schemas.answers import Keys

_DEVIATION = {
    "bias_K": "number?: Mean of computed minus measured.", "rms_K": "number?: Root mean square.",
    "n": "integer: Number of readings.",
}  # fmt: skip
_ENERGY = {"energy_J": "number: Over the drive.", "power_W*": "number: At the end."}
_LEFT_OUT = {
    "mean": "number: Strain that a linear strain leaves out, root mean square over the volume by that of the strain.",
    "greatest": "number: Greatest.", "region": "text: Where that is.",
}  # fmt: skip
_TURNING = {
    "angular_speed_rad_s": "number: Rotation.", "centrifugal_growth_m": "number: Growth of the radius by rotation.",
    "pressure_offset_m": "number?: Of the contact's pressure, to the front.",
    "rolling_resistance_by_offset_N": "number?: By the moment of that offset.",
    "rolling_resistance_by_loss_N": "number?: By the loss.",
    "rolling_resistance_balance": "number?: That by offset over that by loss, less 1.",
}  # fmt: skip

#: Facts of a mesh.
MESH: Keys = {
    "mesher*": "text: mapped, gmsh or a file.", "cell*": "text?: quad or tri.",
    "element*": "text: P1 or P2.", "size_m*": "number?: Size of the elements; null: of a file.",
    "nodes*": "integer: Number.", "elements*": "integer: Number.",
    "half*": "boolean: Half of a symmetric section?", "scaled_jacobian*": "number: Least quality.",
    "edge_ratio*": "number: Longest over shortest edge of an element, greatest.",
    "nodes_of_nine_node_elements*": "integer: Of the mechanical mesh.",
    "through*": "integer: Elements through a layer.", "section*": "text: half or full.",
    "file*": "text: Mesh file.",
}  # fmt: skip
#: Key of any command -> rows below it.
COMMON: dict[str, dict[str, Keys]] = {
    "mesh": {"mesh": MESH},
    "left_out_by_linear_strains": {"left_out_by_linear_strains": _LEFT_OUT},
    "published": {
        "published[]": {
            "quantity": "text: What.", "value": "number?: Computed.", "unit": "text: Its unit.",
            "low": "number?: Least published value.", "high": "number?: Greatest.",
            "verdict": "text: inside or outside.", "source": "text: Where published.",
        },
    },
    "rolling": {"rolling": _TURNING},
}  # fmt: skip
#: Facts of a section.
SECTION: Keys = {
    "name": "text: Name.", "half": "boolean: Half of a symmetric section?",
    "outer_diameter_m": "number: Of the unloaded tyre.", "overall_width_m": "number: Width.",
    "crown_thickness_m": "number: Thickness at the crown.", "meridian_length_m": "number: From crown to bead.",
    "shoulder_s_m": "number: Place of the shoulder along the meridian.", "bead_r_m": "number: Radius of the bead.",
    "bead_z_m": "number: Its axial place.", "area_m2": "table: Region -> area of the section.",
    "volume_m3": "table: Region -> volume of its ring; of a half section, of that half.",
    "inner_surface_m2": "number: Surface towards the contained air; of a half section, of that half.",
    "gas_volume_m3": "number?: Of the contained air; of a half section, of that half.",
    "boundaries": "list: Their names.", "*": "any: Further dimensions of the section.",
}  # fmt: skip

#: Place in an answer -> its keys.
INNER: dict[str, Keys] = {
    "run.footprint.left_out_by_linear_strains": _LEFT_OUT,
    "run.heat_budget.generated{}": _ENERGY, "run.heat_budget.stored{}": _ENERGY, "run.heat_budget.lost{}": _ENERGY,
    "run.heat_budget.lumped{}": _ENERGY, "run.heat_budget.sliding{}": _ENERGY,
    "run.sliding": {"phases": "list: Every phase with slip."},
    "run.sliding.phases[]": {
        "name": "text: Name.", "start": "number: Begin, s.", "end": "number: End, s.",
        "locked": "boolean: Does the wheel stand?", "sliding_speed": "number: Highest, m/s.",
        "pressure": "number: Of the contact at the end, Pa.", "friction": "number: At the highest sliding speed.",
        "friction_lowest": "number: Least coefficient.", "capped": "boolean: Limited by decomposition of the rubber?",
        "friction_work": "number: J, of one footprint.", "tread_heat": "number: The tread's part of it, J.",
        "tread_start": "number: Mean of the tread's surface, degC.", "tread_highest": "number: Its highest, degC.",
        "half_space_highest": "number?: The same of a half-space, for a locked wheel, degC.",
        "exit_edge_highest": "number: Highest of a contact, degC.", "exit_edge_time": "number: When, s.",
        "heated_depth": "number: Depth that the heat reaches, m.",
    },
    "run.feedback": {
        "converged": "boolean: Is the change below the tolerance?", "iterations": "integer: Runs.",
        "change_K": "list: Largest change of a temperature by every run.", "tolerance_K": "number: Allowed.",
        "start": "table: At the begin.", "end": "table: At the end.",
        "relative_modulus_at_end": "table: Region -> modulus over that of the card.",
        "friction_temperature_at_end_degC": "number?: Of the tread's surface.",
    },
    **{
        f"run.feedback.{when}": {
            "time_s": "number: Time.", "gauge_pressure_Pa": "number: Pressure.", "deflection_m": "number: Deflection.",
        }
        for when in ("start", "end")
    },
    "run.numerics": {
        "tolerance_K": "number: Allowed error of the time steps.", "accepted": "integer: Steps.",
        "rejected": "integer: Steps that were repeated.", "factorisations": "integer: Of matrices.",
        "solves": "integer: With them.",
    },
    "run.section": SECTION,
    "compare.reduced": {
        "worst": "number?: Largest error in full runs, K.", "tolerance": "number: Allowed, K.",
        "cases": "integer: Full runs of the certificate.", "reduced": "integer: Runs by the reduced model.",
        "full": "integer: Full runs.", "corrections": "integer: Corrections of its training.",
        "*": "any: Why it was not used.",
    },
    "compare.fitted": _DEVIATION, "compare.held_out": _DEVIATION,
    "sweep.sample.finished": {
        "full": "integer: By full runs.", "reduced": "integer: By the reduced model.",
        "failed": "integer: Without answers.",
    },
    "sweep.sample.reduced_model": {
        "largest_error_K": "number: In fresh full runs.", "tolerance_K": "number: Allowed.",
        "fresh_cases": "integer: Their number.", "training_runs": "integer: Full runs of the training.",
        "corrections": "integer: Corrections of the training.", "largest_errors": "table: Answer -> largest error.",
    },
    "sweep.indices": {"rows": "list: By answer and number.", "words": "list: In sentences."},
    "sweep.indices.rows[]": {
        "answer": "text: Answer.", "number": "text: Varied number.",
        "first": "number?: First-order index: share in the variance by this number alone.",
        "first_95": "number?: Half of its 95 % interval.", "total": "number?: With all its interactions.",
        "total_95": "number?: Half of its 95 % interval.",
    },
    "sweep.tornado": {
        "rows": "list: Range of each answer by each tolerance.", "failures": "table: Number -> why its run failed.",
        "words": "list: In sentences.",
    },
    "sweep.envelope.rows[]": {
        "load": "text: Load.", "pressure": "text: Gauge pressure.", "load_N": "number: Load.",
        "pressure_Pa": "number: Gauge pressure.", "speed_m_s": "number?: Largest speed.",
        "speed_km_h": "number?: The same.", "at_limit": "boolean: Is the limit met there?",
        "settled": "boolean: Did the search end there? False: a larger speed may be safe.",
        "tkph": "number?: Load times speed, tonne km/h.", "by": "text: reduced or full.",
        "error_K": "number?: Error of the reduced model.", "failure": "text: Why there is none; else empty.",
        "*": "any: The limited answer there.",
    },
    "sweep.envelope.rating_tkph[]": {
        "pressure": "text: Gauge pressure.", "tkph": "number?: Least load times speed, tonne km/h.",
    },
    "sweep.optimum.as_it_is": {"answers": "table: Answer -> value.", "by": "text: reduced or full."},
    "sweep.optimum.limits{}": {"below*": "number?: Upper limit.", "above*": "number?: Lower limit."},
    "press.cords_least_mean_greatest{}": {
        "strain": "list: Least, mean, greatest.", "stress_Pa": "list: The same.", "tension_N": "list?: Of a cord.",
    },
    "press.secant_moduli": {
        "amplitudes": "table: Region -> shear strain amplitude.",
        "factors": "table: Region -> modulus over that of its card.", "passes": "integer: Presses that it took.",
    },
    "press --critical-speed.rises[]": {
        "pressure_Pa": "number: Gauge pressure.", "temperature_degC": "number: Of tan delta.",
        "load_N": "number: Load.", "rises": "list: By speed.",
        "refused_m_s": "number?: Speed without a solution.", "refused_because": "text?: Why.",
        "standing_wave": "table?: The effect standing-wave nearest to the rise; null: hardly any rise.",
    },
    "press --critical-speed.rises[].rises[]": {
        "pressure_Pa": "number: Gauge pressure.", "temperature_degC": "number: Of tan delta.",
        "load_N": "number: Load.", "speed_m_s": "number: Speed.",
        "rolling_resistance_N": "number: By the loss.", "loss_factor": "number: Heat over that without inertia.",
        "strain_factor": "number: Strain over that without inertia.",
        "standing_wave_factor": "number?: The same by the effect standing-wave.",
        "limited_by_loss_only": "boolean: Beyond the critical speed without loss?",
        "limited_because": "text: What the press says of it; else empty.",
    },
    "press --critical-speed.rises[].standing_wave": {
        "gain": "number: Of the effect.", "critical_speed_m_s": "number: Of the effect.",
        "largest_deviation": "number: From the computed rise.",
    },
    "roll.rings_friction_power_W": {"z_m": "list: Axial place of the rings.", "power_W": "list: Their friction power."},
    "roll (curve).peak": {
        "force_N": "number: Largest force.", "slip_angle_rad*": "number: Where.", "slip*": "number: Where.",
    },
    "forces.magic_formula": {
        "nominal_load_N": "number: FNOMIN.", "nominal_pressure_Pa": "number: NOMPRES.",
        "unloaded_radius_m": "number: UNLOADED_RADIUS.", "points": "integer: Fitted points.",
        "rms_over_largest": "table: Force or moment -> rms of the fit over its largest value.",
        "coefficients": "table: Coefficient of the Magic Formula -> value.",
    },
    "life.sensitivity[]": {
        "change": "text: Other input.", "shortest_km": "number?: Shortest life with it.",
        "over_the_life_before": "number?: Over that of the study.", "region": "text?: Where.",
        "temperature_degC": "number?: Temperature there.",
    },
    "wear.phases[]": {
        "name": "text: Phase.", "distance_m": "number: Its distance.", "friction_work_J": "number: Of the rings.",
        "mean_wear_mm_per_1000_km": "number: Mean of the rings.",
    },
    "strain.laws{}.hottest": {
        "temperature_degC": "number: Highest temperature.", "region": "text: Where.", "time_s": "number: When.",
        "r_m": "number: Radius.", "z_m": "number: Axial place, from the middle.",
        "s_m": "number: Along the meridian, from the crown.", "depth_m": "number: From the inner surface.",
    },
    "strain.parts{}": {"region": "text: Region.", "title": "text: In words."},
    "rig simulate.highest_degC{}": {"*": "any: Sensor -> highest reading, degC."},
    "rig identify.tests[]": {
        "run": "text: Test.", "table": "text: Its file.", "power_W": "number: Of the laser.",
        "until_s": "number: Last reading.", "readings": "table: Sensor -> number of readings.",
    },
    "rig identify.correlation": {"names": "list: Unknowns.", "matrix": "list: Rows of correlations."},
    "rig identify.linear_in_temperature": {
        "chosen": "list: Slopes that the data ask for.", "probability": "table: Slope -> probability.",
        "log_evidence_over_constant": "list: By set of slopes.",
    },
    "rig identify.linear_in_temperature.log_evidence_over_constant[]": {
        "slopes": "list: Set of slopes.", "log_evidence": "number: Over constant properties, nats.",
    },
    "rig identify.model_error": {
        "relative_to_rise": "table: Sensor -> standard deviation over the rise.",
        "correlation_time_s": "number: Of the error.",
    },
    "slide tables.rubber_on_ice": {
        "distance_behind_m": "number: Where it is measured.", "rows": "list: Rows of table 3.",
        "pressure_of_first_row_Pa": "number: Contact pressure with which the first row holds.",
    },
    "slide tables.rubber_on_ice.rows[]": {
        "name": "text: Slider and speed.", "measured_K": "number: Of the paper.",
        "corrected_K": "number: Corrected by the paper.", "predicted_K": "number: Here.",
        "deviation_K": "number: Predicted minus corrected.",
        "printed_follows": "boolean: Does the printed value follow from the paper's equations?",
        "same_load_exit_rise_K": "number: Rise at the exit edge at the first row's load.",
        "needed_pressure_Pa": "number: Contact pressure with which the row holds.",
        "above_melting": "boolean: Would the ice melt?",
    },
}  # fmt: skip
