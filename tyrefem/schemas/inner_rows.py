"""Keys deeper inside the answers: tables that several commands have (`COMMON`), and those of one command (`INNER`).

Written as in `tyrefem.schemas.rows`. Words with ``->`` say: any names, each with a value.
"""

from __future__ import annotations

from tyrefem.schemas.answers import Keys

_PARAMETER = {
    "value": "number: Value.", "sd": "number?: Standard deviation.", "unit": "text: Unit.",
    "*": "any: Further numbers of the parameter.",
}  # fmt: skip
_MOVES = {
    "largest_K": "number: Largest change of a reading, with its sign.", "sensor": "text: Of which sensor.",
    "run": "text: In which run.",
}  # fmt: skip
_DEVIATION = {
    "bias_K": "number?: Mean of computed minus measured.", "rms_K": "number?: Root mean square.",
    "n": "integer: Number of readings.",
}  # fmt: skip
_ENERGY = {"energy_J": "number: Over the drive.", "power_W*": "number: At the end."}
_BEFORE_AFTER = {"before": "number?: Of the study.", "after": "number?: Of the amended study."}
_LEFT_OUT = {
    "mean": "number: Strain, mean by energy.", "greatest": "number: Greatest.", "region": "text: Where that is.",
}  # fmt: skip
_TURNING = {
    "angular_speed_rad_s": "number: Rotation.", "centrifugal_growth_m": "number: Growth of the radius by rotation.",
    "pressure_offset_m": "number?: Of the contact's pressure, to the front.",
    "rolling_resistance_by_offset_N": "number?: By the moment of that offset.",
    "rolling_resistance_by_loss_N": "number?: By the loss.", "rolling_resistance_balance": "number?: Their difference.",
}  # fmt: skip
_FREQUENCY = {
    "share": "number?: Share.", "low": "number: Lower end of the 95 % interval.", "high": "number: Upper end.",
    "*": "any: Numbers of cases.",
}  # fmt: skip
_RELIABILITY = {
    "bins": "list: Stated probabilities and how often they held.",
    "expected_calibration_error": "number?: Mean distance of both.",
    "p_value": "number?: That both agree.",
}  # fmt: skip
_BIN = {"stated": "number: Mean stated probability.", **_FREQUENCY}
_OTHER_MODEL = {
    "strain_law": "text?: Strain law; null: the study's, with other energies.",
    "strain_factor": "number?: Factor on its heat.",
    "strain_modes": "list: Relative changes of the energy along the meridian, by cosine.",
    "strain_modes_rms": "number?: Their root mean square.", "gauges": "table: Region -> factor on its thickness.",
    "film_speed_exponents": "table: Effect on a film -> exponent of speed added to its law.",
    "mesh": "table: Dotted name -> value.", "time_integration": "text: In words.",
}  # fmt: skip
_PLACE_OF_LAW = {
    "place": "text: In words.", "kind": "text: heat, flux, share ...", "where": "text: Layer, surface or region.",
    "station_m": "number?: Along the meridian.", "amplitude_W_m3*": "number: At the references.",
    "amplitude_sd_W_m3*": "number: Its standard deviation.", "amplitude_W_m2*": "number: The same through a surface.",
    "amplitude_sd_W_m2*": "number: Its standard deviation.", "amplitude_1*": "number: The same as a share.",
    "amplitude_sd_1*": "number: Its standard deviation.", "other_sources": "any: Sources beside it.",
    "log_evidence_below_best": "number: Below the best place, nats.",
}  # fmt: skip

#: Facts of a mesh.
MESH: Keys = {
    "mesher*": "text: mapped, gmsh or a file.", "cell*": "text?: quad or tri.",
    "element*": "text: P1 or P2.", "size_m*": "number?: Size of the elements; null: of a file.",
    "nodes*": "integer: Number.", "elements*": "integer: Number.",
    "half*": "truth: Half of a symmetric section?", "scaled_jacobian*": "number: Least quality.",
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
    "name": "text: Name.", "half": "truth: Half of a symmetric section?",
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
        "locked": "truth: Does the wheel stand?", "sliding_speed": "number: Highest, m/s.",
        "pressure": "number: Of the contact at the end, Pa.", "friction": "number: At the highest sliding speed.",
        "friction_lowest": "number: Least coefficient.", "capped": "truth: Limited by decomposition of the rubber?",
        "friction_work": "number: J, of one footprint.", "tread_heat": "number: The tread's part of it, J.",
        "tread_start": "number: Mean of the tread's surface, degC.", "tread_highest": "number: Its highest, degC.",
        "half_space_highest": "number?: The same of a half-space, for a locked wheel, degC.",
        "exit_edge_highest": "number: Highest of a contact, degC.", "exit_edge_time": "number: When, s.",
        "heated_depth": "number: Depth that the heat reaches, m.",
    },
    "run.feedback": {
        "converged": "truth: Is the change below the tolerance?", "iterations": "integer: Runs.",
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
    **{
        f"diagnose.{rows}[].variant": {
            "*": "any: Choice of the effect, such as sensor, and what was chosen; empty without a choice.",
        }
        for rows in ("effects", "candidates", "changes")
    },
    "diagnose.effects[].parameters{}": _PARAMETER, "diagnose.candidates[].parameters{}": _PARAMETER,
    "diagnose.discrepancies[].parameters{}": _PARAMETER,
    "diagnose.effects[].moves": _MOVES,
    "diagnose.effects[].support": {"*": "any: Least probability without a sensor or a run, and which."},
    **{
        f"diagnose.gap.{when}": {
            "rms_K": "number?: Of the fitted runs.", "held_out_rms_K": "number?: Of the runs held out.",
        }
        for when in ("before", "after")
    },
    "diagnose.noise.series[]": {
        "run": "text: Measured run.", "sensor": "text: Sensor.", "stated_K": "number?: Of the study.",
        "from_data_K": "number?: By the scatter of the readings.", "used_K": "number: As used.",
        "resolution_K": "number: Step of rounded readings; 0: not rounded.",
    },
    "diagnose.runs[].drive": {"*": "any: Number of the drive -> its value in this run."},
    "diagnose.numerics": {
        "tolerance_K": "number: Of the time steps.", "mesh": "table: Mesh of the study.",
        "assumed": "written: The table [diagnosis]; keys as in schemas/study.json.",
    },
    "diagnose.numerics.mesh": MESH,
    "diagnose.prior_sensitivity[]": {
        "effect": "text: Effect.", "prior": "text: Which prior.", "factor": "number: Its change.",
        "verdict": "text: Verdict with it.", "best": "text: Most probable set with it.",
        "share": "number: Probability of that.", "decides": "truth: Is the verdict another?",
    },
    "diagnose.reduced": {
        "used": "truth: Were reduced models used?", "modes*": "table: Run -> number of modes.",
        "points_by_reduced_models*": "integer: Simulations.", "points_by_lean_simulations*": "integer: The same.",
        "allowed_whitened*": "number: Allowed error over the noise.", "worst_whitened*": "number: Largest.",
        "worst_K*": "number: Largest error.", "certificates*": "list: By set of effects and run.",
        "*": "any: Why they were not used.",
    },
    "diagnose.reduced.certificates[]": {
        "effects": "list: Set of effects.", "run": "text: Run.", "used": "truth: Is the reduced model good enough?",
        "points": "integer: Full simulations of the certificate.", "whitened": "number?: Error over the noise.",
        "worst_K": "number?: Largest error.", "*": "any: Why it is not good enough.",
    },
    "diagnose.better_strain_law": {
        "stated": "text: Law of the study.", "law": "text: The better one.",
        "heat_factor": "number: Fitted factor on its heat.", "rms_K": "number: Of the fit.",
        "held_out_rms_K": "number?: Of the runs held out.", "log_evidence_gain": "number: Over the study's law, nats.",
        "log_odds": "number: For it, nats.", "held_out_lead": "number?: Of the runs held out.",
        "no_effect_missing": "truth: Does it explain the data alone?",
        "heat_ratio": "any: Its heat over that of the study's law, by zone.",
    },
    "diagnose.conformal": {
        "sentence": "text: In words.", "sets": "list: Sets of effects.", "effects_in_all": "list: Effects of all sets.",
        "coverage_wanted": "number: Share of cases that hold the truth.", "threshold": "number: Of the score.",
        "fresh_cases": "table: held, of and further numbers of the check -> value.",
    },
    "diagnose.next_experiment": {
        "between*": "list: The two sets that it tells apart.", "sensors*": "list: Places of a new sensor, best first.",
        "drives*": "list: Drives, best first.",
    },
    "diagnose.next_experiment.sensors[]": {
        "place": "text: In words.", "s_m*": "number: Along the meridian.",
        "depth_m*": "number: From the inner surface.", "gain": "number: Expected information, nats.",
        "largest_K": "number: Largest difference of both sets.", "run": "text: In which run.",
    },
    "diagnose.next_experiment.drives[]": {"gain": "number: Expected information, nats.", "*": "any: The drive."},
    "diagnose.missing_heat": {
        "sources": "list: Places, signs, amounts and courses in time.",
        "law": "table?: How the largest scales over the runs; null: no law was looked for.",
        "cooling_run": "truth?: Do sources go on while the tyre stands?", "kind": "text: heat or flux.",
        "region": "text: Region of the largest.", "station_m": "number: Its place along the meridian.",
        "stations_m": "list: Stations along the meridian.", "watts": "list: Heat by station, whole tyre.",
        "runs": "list: Heat and flux by station of every run.",
    },
    "diagnose.missing_heat.runs[]": {
        "run": "text: Run.", "speed_m_s": "number: Speed.", "heat_W_m3": "list: Inside, by station.",
        "heat_sd_W_m3": "list: Its standard deviation.", "flux_W_m2": "list: Through the outer surface, by station.",
        "flux_sd_W_m2": "list: Its standard deviation.",
    },
    "diagnose.missing_heat.sources[]": {
        "sentence": "text: In words.", "stated": "truth: Is the amount beyond two standard deviations?",
        "sign": "text: heat is missing, or cooling is missing.", "station_m": "number: Along the meridian.",
        "place": "text: In words.", "where": "text: Layer or surface.",
        "inside_told_from_surface": "truth: Do the data tell them apart?", "kind": "text: heat or flux.",
        "amount_W_m3*": "number: Inside; of a flux amount_W_m2.", "amount_sd_W_m3*": "number: Its standard deviation.",
        "amount_W_m2*": "number: Through a surface.", "amount_sd_W_m2*": "number: Its standard deviation.",
        "moves": "table?: Largest change of a reading.", "station_probabilities": "list: By station.",
        "depth": "table: Layer or surface -> probability.", "course": "text: Most probable course in time.",
        "course_probabilities": "table: Course -> probability.", "time_s": "number?: When it begins or ends.",
        "time_sd_s": "number?: Its standard deviation.", "log_evidence_gain": "number: Over no source, nats.",
        "runs": "list: The amount over time.",
    },
    "diagnose.missing_heat.sources[].moves": _MOVES,
    "diagnose.missing_heat.sources[].station_probabilities[]": {
        "station_m": "number: Along the meridian.", "probability": "number: Posterior probability.",
    },
    "diagnose.missing_heat.sources[].runs[]": {
        "run": "text: Run.", "times_s": "list: Times.", "amount_W_m3*": "list: Amounts; of a flux amount_W_m2.",
        "amount_sd_W_m3*": "list: Standard deviations.", "amount_W_m2*": "list: Through a surface.",
        "amount_sd_W_m2*": "list: Standard deviations.",
    },
    "diagnose.missing_heat.law": {
        "sentences": "list: In words.", "holds": "truth: Is it stated?",
        "lead_nats": "number: Over sources with a free strength in every run.",
        "share": "number: Of their gain in evidence.", **_PLACE_OF_LAW,
        "exponents": "list: Of every variable that varies.", "switch": "text: When the heat acts.",
        "switch_probabilities": "table: Switch -> probability.", "time_s": "number?: When it begins or ends.",
        "time_sd_s": "number?: Its standard deviation.", "alternatives": "list: Other laws within 2.3 nats.",
        "hardly_vary": "list: Variables that hardly vary.", "vary_together": "list: Pairs that vary together.",
        "signatures": "list: Effects and mechanisms, most alike first.",
        "draft_effect": "text?: File of the draft effect.", "places": "list: Places that competed.",
    },
    "diagnose.missing_heat.law.exponents[]": {
        "name": "text: Variable.", "in_law": "truth: Is it in the law?", "mean": "number: Exponent.",
        "sd": "number: Its standard deviation.", "probability": "number: That it acts.",
        "told_by_runs": "truth: Do the runs tell more than the prior?",
        "reference": "number: Value at which the amplitude holds, SI.",
    },
    "diagnose.missing_heat.law.alternatives[]": {
        "terms": "table: Variable -> exponent.", "switch": "text: When it acts.",
        "log_evidence_below_best": "number: Below the best law, nats.",
    },
    "diagnose.missing_heat.law.signatures[]": {
        "name": "text: Effect or mechanism.", "kind": "text: effect or mechanism.",
        "likeness": "number: 1: the same over these runs.", "log_evidence_below_best": "number?: Nats.",
        "station_m": "number?: Along the meridian.", "where": "text?: Layer or surface.",
        "exponents": "table: Variable -> exponent.",
    },
    "diagnose.missing_heat.law.places[]": {**_PLACE_OF_LAW, "law": "text: Its law."},
    "isolability.calibration": {
        "study": "text: Study.", "layout": "table: Sensors and runs.", "seed": "integer: Of the cases.",
        "cases": "integer: Number.", "ranks": "table: Of what -> test that ranks are uniform.",
        "fitted": "truth: Simulated and fitted as a diagnosis does; else linear.",
        "reliability": "table: Of what -> stated probabilities and how often they held.",
        "unexplained": "table: How often this verdict is false.", "conformal": "table: Sets with known coverage.",
    },
    "isolability.calibration.layout": {"sensors": "list: Sensors.", "runs": "list: Runs."},
    "isolability.calibration.ranks{}": {"counts": "list: Cases by bin.", "p_value": "number: That ranks are uniform."},
    "isolability.calibration.reliability{}": _RELIABILITY,
    "isolability.calibration.reliability{}.bins[]": _BIN,
    "isolability.calibration.unexplained": {
        "cases_with_a_cause_in_the_catalogue": "table: Share.", "nothing_hidden": "table: Criterion -> share.",
    },
    "isolability.calibration.unexplained.cases_with_a_cause_in_the_catalogue": _FREQUENCY,
    "isolability.calibration.unexplained.nothing_hidden{}": _FREQUENCY,
    "isolability.calibration.conformal": {
        "coverage_wanted": "number: Share of cases.", "thresholds": "table: Lead -> threshold of the score.",
        "fresh_cases": "table: Lead -> check of the coverage.", "median_sets": "table: Lead -> number of sets.",
    },
    "isolability.calibration.conformal.fresh_cases{}": {"held": "integer: Cases that hold.", **_FREQUENCY},
    "blind.mesh_of_the_truth": {"*": "any: Dotted name -> value, as of --set."},
    "blind.cases[].rms_K": _BEFORE_AFTER, "blind.cases[].held_out_rms_K": _BEFORE_AFTER,
    "blind.cases[].other_model": _OTHER_MODEL, "blind.failures[].other_model": _OTHER_MODEL,
    "blind.cases[].points": {"reduced": "integer: By reduced models.", "lean": "integer: By simulations."},
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
        "speed_km_h": "number?: The same.", "at_limit": "truth: Is the limit met there?",
        "settled": "truth: Did the search end there? False: a larger speed may be safe.",
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
        "limited_by_loss_only": "truth: Beyond the critical speed without loss?",
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
        "printed_follows": "truth: Does the printed value follow from the paper's equations?",
        "same_load_exit_rise_K": "number: Rise at the exit edge at the first row's load.",
        "needed_pressure_Pa": "number: Contact pressure with which the row holds.",
        "above_melting": "truth: Would the ice melt?",
    },
}  # fmt: skip
