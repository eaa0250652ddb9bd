"""Keys of every command's answer in JSON: what `--json` prints, command by command.

A line is ``key: "kind: words"``. Kinds: text, number, integer, truth, list, table; ``?`` may be null. A key that ends
with ``*`` may be missing. Units stand at the end of keys: ``load_N``.
"""

from __future__ import annotations

from collections.abc import Mapping

Keys = Mapping[str, str]

_STUDY = {"study": "text: Name of the study.", "title": "text: Title of the study."}
_VERSIONS = {"versions": "table: Versions of tyrefem, Python and the libraries that influence results."}
_FOLDER = {
    "command": "text: The command that wrote the folder.",
    "complete": "truth: False after an interruption.",
    "files": "list: Files in the folder.",
    "checksums": "table: File -> checksum of its content.",
    "writing*": "list: Files that were being written.",
}
_AGAIN = {
    "wall_time_s": "number: Time of the computation.",
    "random_seed": "integer?: Seed; null where nothing is random.",
    "input": "table: The study as written, with all changes.",
}
_WHEEL = {
    "pressure_Pa": "number: Gauge pressure.",
    "drum_diameter_m": "number?: Diameter of the drum; null on a flat road.",
    "motion": "text: large or linear.",
}
_WORDS = {"words": "list: The answer in sentences."}
_PICTURE = {"picture": "text?: File of the picture; null without --out."}
_MESH = {"mesh": "table: Mesher, element, size, number of nodes and elements, quality."}
_ROLLED = {
    "camber_rad": "number: Camber.", "friction": "number: Coefficient of friction.",
    "slip_angle_rad": "number: Slip angle.", "slip": "number: Longitudinal slip, positive drives.",
    "turn_slip_1_m": "number: Curvature of the path.", "speed_m_s": "number: Speed over the road.",
    "F_x_N": "number: Force on the tyre, forward.", "F_y_N": "number: Force on the tyre, to the left.",
    "F_z_N": "number: Load.", "M_x_Nm": "number: Overturning moment.", "M_y_Nm": "number: Rolling resistance moment.",
    "M_z_Nm": "number: Aligning moment.", "torque_Nm": "number: Torque of the axle.",
    "deflection_m": "number: Deflection.", "travel_m_rad": "number: Travel per radian of rotation.",
    "pneumatic_trail_m": "number?: Trail of the side force.",
    "sliding_share": "number: Share of the contact that slides.", "friction_power_W": "number: Friction power.",
    "loss_power_W": "number?: Power that the rubber loses.", "axle_power_W": "number?: Power of the axle.",
    "effective_rolling_radius_m": "number: Travel per radian.", "loaded_radius_m": "number: Axle above the road.",
    "rings_friction_power_W": "table: z_m, power_W: friction power by ring of the tread.",
    "power_balance": "number?: Missing share of the power balance.",
    "rolling_resistance_N": "number?: Rolling resistance.",
}  # fmt: skip

#: Command -> its keys.
ANSWERS: dict[str, Keys] = {
    "run": {
        **_STUDY, **_FOLDER, **_AGAIN, **_VERSIONS, **_MESH,
        "hottest": "table: Temperature, time and place of the hottest point.",
        "rolling_resistance": "table: Force and coefficient at the end of a phase, warm and cold.",
        "published": "list: Results beside published ranges.",
        "contained_air": "table: Temperature and gauge pressure at the end.",
        "sensors": "table: Sensor -> end_degC and max_degC.",
        "extremes": "list: Highest temperature of the tyre and of each region, with time and place.",
        "heat_budget": "table: Heat generated, stored and lost, J; imbalance.",
        "sliding*": "table: Friction heat of phases with slip.",
        "feedback*": "table: Convergence of the feedback of temperature on the strain cycle.",
        "effects*": "list: The effects that acted.",
        "warnings": "list: Warnings.",
        "phases": "list: Phases with start, end and load case.",
        "numerics": "table: Time steps and solves.",
        "section": "table: Dimensions, areas and volumes of the section.",
        "mechanics*": "table: Facts of the strain cycle.",
    },
    "run (campaign)": {
        "study": "text: Name of the study.",
        "cases": "list: A row for each case: its name, answers, and the failure, if any.",
    },
    "compare": {
        "study": "text: Name of the study.", "summary": "text: The verdict in a sentence.",
        "notes": "list: What to know of the tables.", "k": "number: Coverage factor.",
        "reduced": "table?: Certificate of the reduced model.",
        "overall": "table: Bias, rms and number of readings of all runs.",
        "fitted": "table?: The same of the runs that a fit may use.",
        "held_out": "table?: The same of the runs that are held out.",
        "rms_by_sensor_K": "table: Sensor -> rms deviation.",
        "rows": "list: Deviation and validation uncertainty by run, sensor and phase.",
        "inputs": "list: Change of each deviation by each uncertain number.",
    },
    "diagnose": {
        **_STUDY, **_VERSIONS, **_AGAIN,
        "verdict": "text: identified, partly identified, confounded, unexplained or no gap.",
        "headline": "list: Verdict, cause and what to do, a sentence each.",
        "summary": "list: The report in sentences.",
        "reasons": "list: Why this verdict.", "effects": "list: Effects that are named.",
        "candidates": "list: Effects with probability, evidence and parameters.", "notes": "list: What to know.",
        "sets": "list: Sets of effects with probability and fit.", "gap": "table: rms before and after.",
        "noise": "table: Noise as stated and as the data have it.", "confidence": "table?: Calibrated probability.",
        "discrepancies": "list: What other errors of the model would change.",
        "possible_effects": "table: Effects that could not be told from these.",
        "strain_laws": "list: Other strain laws.", "better_strain_law": "table?: A strain law that fits better.",
        "conformal": "table?: Set with known coverage.", "prior_sensitivity": "list: Other priors and their verdicts.",
        "where": "table?: Where measurement and study disagree most.",
        "next_experiment": "table: What to measure next.", "amended_study": "text: The amended study as TOML.",
        "changes": "list: Numbers of the amended study.", "missing_heat": "table?: Heat of unknown origin.",
        "again": "list: Further rounds.", "runs": "list: The measured runs.",
        "numerics": "table: Mesh and assumptions.", "reduced": "table: Certificates of the reduced models.",
        "partly*": "table: What is certain in a partly identified verdict.",
    },
    "plan": {
        **_VERSIONS, "study": "text: Name of the study.", "after": "text?: Diagnosis or table that the plan follows.",
        "summary": "list: The plan in sentences.", "sets": "list: Sets of effects with probability.",
        "doubt_nats": "number: Entropy of the probabilities.", "steps": "list: Runs and sensors in their order.",
        "candidates": "list: Drives and sensors that were tried.", "notes": "list: What to know.",
        "wall_time_s": "number: Time of the computation.",
    },
    "isolability": {
        "study": "text: Name of the study.", "margin_nats": "number: Evidence that tells two effects apart.",
        "effects": "list: From which amplitude each effect is seen and told from others.",
        "groups": "list: Effects that look alike.", "fewest_runs": "list: Runs that tell as much as all.",
        "apart_nats": "list: Evidence between each two effects.", "notes": "list: What to know.",
        "calibration*": "table: Coverage of stated probabilities in quick cases.",
    },
    "blind": {
        "study": "text: Name of the study.", "seed": "integer: Seed of the cases.",
        "truth": "text: Model of the data.", "mesh_of_the_truth": "table: Mesh of the data.",
        "cases": "list: Hidden effect, verdict and probabilities of each case.",
        "rates": "table: How often the diagnosis is right, with intervals.",
        "reliability": "list: Stated probabilities and how often they held.",
        "by_effect": "list: Cases by effect.", "failures": "list: Cases without a verdict.",
        "notes": "list: What to know.",
    },
    "sweep": {
        **_STUDY, **_FOLDER, **_VERSIONS, **_WORDS, **_MESH,
        "random_seed": "integer?: Seed of the sample.", "input": "table: The study as written.",
        "asked": "table: The sweep as read.", "sample": "table: Sampling, numbers of variants, seconds.",
        "tolerance_K": "number: Largest error that the certificate allows.",
        "failures": "table: Variant -> why it failed.", "sweep*": "table: Main effects of the varied numbers.",
        "pareto*": "table: Variants of the Pareto front.", "indices*": "table: Sobol indices.",
        "tornado*": "table: Range of each answer by each tolerance.", "optimum*": "table: The best variant.",
        "envelope*": "table: Largest speed by load and pressure.",
    },
    "export": {
        "steady": "table: Largest errors in steady drives, K (rolling_resistance: N).",
        "driven": "table: The same in changing drives.", "worst": "number: Largest error of a temperature, K.",
        "tolerance": "number: Allowed error, K.", "cases": "list: Numbers of steady and changing drives.",
        "trained_on": "integer: Number of full runs of the training.", "duration": "number: Length of a drive, s.",
        "tables": "table: Errors of tabulated films and heat.", "file": "text: The model.", "fmu*": "text: The FMU.",
    },
    "press": {
        **_STUDY, **_WHEEL, **_VERSIONS, **_MESH,
        "camber_rad": "number: Camber.", "radius_growth_m": "number: Growth of the crown's radius by inflation.",
        "width_growth_m": "number: Growth of the width.",
        "cords_least_mean_greatest": "table: Region -> strain, stress and tension of the cords.",
        "bead_tension_N": "number?: Tension of a bead.", "load_N": "number: Load.",
        "deflection_m": "number: Deflection.",
        "bottoming_deflection_m": "number?: Deflection at which the tyre bottoms.",
        "secant_stiffness_N_m": "number: Load over deflection.", "tangent_stiffness_N_m": "number: Slope of the load.",
        "footprint_length_m": "number: Length of the footprint.", "footprint_width_m": "number: Its width.",
        "footprint_area_m2": "number: Area of rubber in contact.",
        "mean_contact_pressure_Pa": "number: Load over area.", "peak_contact_pressure_Pa": "number: Greatest pressure.",
        "loaded_radius_m": "number: Axle above the road.", "rolling_radius_m": "number: Travel per radian.",
        "speed_m_s": "number: Speed of the loss.", "temperature_degC": "number?: Temperature of the loss.",
        "loss_per_revolution_J": "number?: Heat of a revolution.",
        "rolling_resistance_N": "number?: Rolling resistance.",
        "rolling_resistance_coefficient": "number?: Rolling resistance over load.",
        "published": "list: Results beside published ranges.", "harmonics": "integer: Number of Fourier harmonics.",
        "error": "number: Relative error of the harmonics.", "balanced": "truth: True in large motion.",
        "left_out_by_linear_strains": "table?: Strains that linear strains leave out.",
        "tolerance": "number: Allowed error of the harmonics.",
        "unstable_harmonics": "list: Harmonics with negative stiffness.",
        "secant_moduli": "table?: Moduli at the strain amplitude of each region.",
        "rolling*": "table: Turning of the tyre with inertia.",
    },
    "press --critical-speed": {
        "study": "text: Name of the study.",
        "critical": "list: Speed, wave and pressure of every pressure and temperature.",
        "rises*": "list: Heat and strain below the critical speed.",
    },
    "roll": {
        **_STUDY, **_WHEEL, **_ROLLED, **_VERSIONS,
        "harmonics": "integer: Number of Fourier harmonics.", "error": "number: Relative error of the harmonics.",
        "standing*": "table: Stiffness of the standing tyre.", "rolling*": "table: Turning of the tyre with inertia.",
    },
    "roll (curve)": {
        **_STUDY, **_VERSIONS, "varied": "text: slip_angle or slip.", "points": "list: The forces at every slip.",
        "*": "any: Stiffnesses of the curve.",
    },
    "forces": {
        **_STUDY, **_WHEEL, **_VERSIONS, "friction": "number: Coefficient of friction.",
        "magic_formula": "table: Coefficients, nominal load and pressure, rms over the largest force.",
        "points": "list: Forces, moments and wheel state of every point.",
    },
    "modes": {
        **_STUDY, **_VERSIONS, "pressure_Pa": "number: Gauge pressure.", "mass_kg": "number: Mass of the tyre.",
        "modes": "list: Number of waves, frequency, shares of motion.",
        "strain_amplitude": "number: Amplitude of the vibration.",
        "modulus_over_that_of_the_card": "table: Region -> factor on the modulus.",
        "nodes_of_nine_node_elements": "integer: Nodes of the mechanical mesh.",
        "angular_speed_rad_s*": "number: Rotation.", "speed_m_s*": "number: Speed of the rotation.",
    },
    "life": {
        **_STUDY, **_FOLDER, **_VERSIONS, "about": "text: What a life is.", "sum": "text: How the phases are summed.",
        "shortest_km": "number?: Shortest life, mean of a place.", "shortest_point_km": "number?: Shortest at a point.",
        "distance_of_the_drive_km": "number: Length of the drive.",
        "temperatures": "text: Temperatures of the life.", "motion": "text: Motion of the footprint.",
        "regions": "table: Region -> shortest life, km.",
        "left_out_without_fatigue_table": "list: Regions whose card has no [fatigue].",
        "share_of_phases_at_the_shortest": "table: Phase -> share of the damage.",
        "drift_of_the_energy_over_its_peak_median": "number?: Error of the closed cycle.",
        "places": "list: Places that fail first, with plane, energy and temperature.",
        "sensitivity": "list: Shortest life for other inputs.", "cards": "table: Region -> its [fatigue].",
        "mesh": "table: Mechanical mesh.",
    },
    "wear": {
        **_STUDY, **_FOLDER, **_VERSIONS, "about": "text: What is computed.",
        "slip_angle_rad*": "number: Slip angle.", "slip*": "number: Longitudinal slip.",
        "camber_rad*": "number: Camber.", "force_N*": "list: Force of the road, x, y, z.",
        "friction_power_W": "number: Friction power.", "mean_wear_mm_per_1000_km": "number: Mean wear of the rings.",
        "most_wear_mm_per_1000_km": "number: Greatest wear.", "mass_mg_per_km": "number: Mass worn.",
        "card": "table: The [wear] of the tread.", "phases*": "list: Wear of every phase of the drive.",
        "distance_km*": "number: Distance of the worn section.", "worn_section*": "any: The worn section.",
    },
    "strain": {
        **_STUDY, **_MESH, **_VERSIONS, "phase": "text: Phase of the load.", "load_N": "number: Load.",
        "pressure_Pa": "number: Gauge pressure.", "load_law_deflection_m": "number?: Deflection by the load law.",
        "loss_convention": "text: nasa or sinusoid.", "parts": "table: Parts of the section with region and title.",
        "volume_m3": "table: Part -> volume.",
        "laws": "table: Law -> deflection, energies by part, coefficient, temperatures.",
        "refused": "table: Law -> why it has no solution.",
    },
    "rig simulate": {
        "highest_degC": "table: Run -> sensor -> highest reading.", "words": "list: What to know.",
        "folder": "text: Folder of the tables.",
    },
    "rig identify": {
        **_VERSIONS, **_WORDS, "rig": "text: Title of the rig.", "file": "text?: File of the rig.",
        "tests": "list: Measured tests.", "reference_temperatures_degC": "table: Layer -> reference temperature.",
        "estimates": "list: Properties with 95 % interval, prior and verdict.",
        "coverage_factor": "number: Of the intervals.", "diffusivities": "list: Layer, value and relative sd.",
        "determined": "list: Properties that the tests determine.", "not_determined": "list: Those that they do not.",
        "poorly_determined": "list: Those with a wide interval.", "correlation": "table: Names and matrix.",
        "linear_in_temperature": "table: Evidence for properties linear in temperature.",
        "model_error": "table: Error of the model over the rise.", "residuals": "list: Mean and rms by run and sensor.",
        "solutions": "integer: Number of computed tests.",
    },
    "rig layers": {"rows": "list: Number of layers, misfit, evidence and properties."},
    "road film": {
        "films_W_m2_K": "table: Law -> film during contact.",
        "constant_road_temperature_W_m2_K": "number: Film of a road of constant temperature.",
        "contact_s": "number: Time of contact.", "penetration_m": "number: Depth that the heat reaches in the tread.",
    },
    "road table": {
        "table_1": "list: Rows of table 1 of the paper, recomputed.", "table_2": "list: Rows of table 2.",
        "largest_deviation_of_table_2_W_m2_K": "number: Largest deviation from the printed value.",
    },
    "road averaging": {
        **_PICTURE, "rows": "list: Surface temperatures, resolved and averaged, by footprint length and speed.",
        "holds_from_m_s": "table: Footprint length in m -> speed from which averaging holds; null: at none.",
    },
    "road figures": {"pictures": "list: Files of the pictures."},
    "slide rise": {
        "contact_pressure_Pa": "number: Contact pressure.", "heat_flux_W_m2": "number: Friction heat.",
        "time_under_pad_s": "number: Time of a point under the pad.", "exit_rise_K": "number: Rise at the exit edge.",
        "mean_rise_K": "number: Mean rise.", "exit_rise_shared_K": "number: Rise with the slider's share.",
        "share_into_track_at_start": "number: Share of the heat.", "peclet_number": "number: Peclet number.",
        "heated_depth_m": "number: Depth that is heated.", "rise_behind_K*": "number: Rise behind the pad.",
        "share_into_slider*": "number: Share of the heat after sliding.",
    },
    "slide tables": {
        **_PICTURE, "rubber_on_wood": "list: Rows of table 2, measured and predicted.",
        "rubber_on_ice": "table: Rows of table 3, with distance and pressure.",
    },
    "slide locked-wheel": {
        **_PICTURE, "rows": "list: Rise and friction by speed.",
        "decomposition_from_km_h": "number: Speed from which decomposition limits friction.",
    },
    "check": {"file": "text: The file.", "words": "text: What the file is."},
    "list": {"kind": "text: What is listed.", "entries": "list: Name and title, with file, side or family."},
    "new": {
        "kind": "text: study, section or material.", "file": "text: The new file.",
        "copy_of*": "text: The card that was copied.", "note*": "text: Numbers that hold for one tyre only.",
        "size*": "text: The size.", "rules*": "text: Rules of the size.",
        "outer_diameter_m*": "number: Outer diameter.", "overall_width_m*": "number: Overall width.",
        "numbers*": "table: Number of the rules -> quantity.", "estimates*": "integer: Numbers that are estimates.",
    },
    "show": {
        "kind": "text: What is shown.", "name": "text: Its name.", "file*": "text: Its file.",
        "content*": "table: The card, or the effect.", "facts*": "table: What the picture shows, in numbers.",
        "picture*": "text: File of the picture or mesh.",
    },
    "schema": {
        "folder": "text: Folder of the schemas.", "schemas": "list: Their files.",
        "settings": "text?: Settings for Taplo; null where yours were kept.",
    },
}  # fmt: skip
