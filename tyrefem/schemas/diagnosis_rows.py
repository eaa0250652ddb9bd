"""Keys inside the answers of the diagnosis: `diagnose`, `plan`, `isolability`, `blind`.

Written as in `tyrefem.schemas.rows`. Words with ``->`` say: any names, each with a value.
"""

from __future__ import annotations

from tyrefem.schemas.answers import Keys
from tyrefem.schemas.inner_rows import MESH

_FITTED = {
    "rms_K*": "number?: Root mean square of the residuals of the fitted runs.",
    "held_out_rms_K*": "number?: The same of the runs held out.",
    "misfit*": "number?: Sum of squares of the residuals over their standard deviation.",
    "blocks*": "integer: Number of independent readings.", "p_value*": "number?: Probability of a larger misfit.",
    "held_out_log_probability*": "number?: Of the runs held out, nats.",
    "held_out_p*": "number?: Probability of a larger misfit of the runs held out.",
    "largest_pull*": "number?: Largest distance of an uncertain input from its prior, in standard deviations.",
    "pulls_p*": "number?: Probability of larger pulls.", "at_bound*": "list: Parameters at a bound.",
    "converged*": "boolean: Has the fit converged?",
}  # fmt: skip
_RATE = {
    "right": "integer: Cases that hold.", "of": "integer: Cases that count.", "rate": "number?: Their share.",
    "low": "number: Lower end of the 95 % interval.", "high": "number: Upper end.", "goal*": "number: Goal.",
    "goal_is*": "text: at least or at most.",
}  # fmt: skip
_PARAMETER = {
    "value": "number: Value.", "sd": "number?: Standard deviation.", "unit": "text: Unit.",
    "*": "any: Further numbers of the parameter.",
}  # fmt: skip
_MOVES = {
    "largest_K": "number: Largest change of a reading, with its sign.", "sensor": "text: Of which sensor.",
    "run": "text: In which run.",
}  # fmt: skip
_BEFORE_AFTER = {"before": "number?: Of the study.", "after": "number?: Of the amended study."}
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

#: Place in an answer -> its keys.
DIAGNOSIS_ROWS: dict[str, Keys] = {
    "diagnose.effects[]": {
        "name": "text: Effect.", "variant": "table: Sensor, place or law that it speaks of.",
        "runs": "list?: Runs in which it acts; null: in all.", "probability": "number: Posterior probability.",
        "parameters": "table: Parameter -> value, sd, unit.",
        "moves": "table?: largest_K, sensor, run: largest change of a reading.",
        "confidence": "number?: Least of that and of those without single sensors and runs.",
        "support": "table?: Probability without each sensor and run.", "source": "text: Source of the effect.",
    },
    "diagnose.candidates[]": {
        "name": "text: Effect.", "variant": "table: Sensor, place or law that it speaks of.",
        "runs": "list?: Runs in which it acts; null: in all.",
        "probability": "number: Posterior probability of being in the set.",
        "log_evidence": "number?: Of the effect alone, nats.",
        "log_evidence_gain": "number?: The same over no effect.",
        "confounded_with": "list: Effects that explain the data as well.",
        "parameters": "table: Parameter -> value, sd, unit.", **_FITTED,
    },
    "diagnose.sets[]": {
        "effects": "list: Effects of the set.", "probability": "number: Posterior probability.",
        "log_score_below_best": "number?: Below the best set, nats; null: far below.",
        "credible": "boolean: Is it among the sets that hold 99 %?", "fitted": "boolean: Fitted with the full model?",
        **_FITTED,
    },
    "diagnose.gap": {
        "before": "table: rms_K and held_out_rms_K of the study.", "after": "table: The same of the amended study.",
        "noise_K": "number: Noise of the readings.",
    },
    "diagnose.changes[]": {
        "key": "text: Dotted name of a number of the study.", "keys": "list: Further numbers that change with it.",
        "effect": "text?: The effect that it belongs to.", "variant": "table: Sensor, place or law of the effect.",
        "runs": "list?: Runs in which it acts; null: in all.",
        "missing": "boolean: Of a named effect, or missing heat?",
        "original": "number: Value of the study.", "value": "number: Value of the amended study.",
        "sd": "number?: Standard deviation.", "unit": "text: Unit.", "pull": "number?: Change over its prior's sd.",
        "source": "text: What the amended study says of it.",
    },
    "diagnose.runs[]": {
        "run": "text: Measured run.", "hold_out": "boolean: Held out of the fit?", "drive": "table: What differs.",
        "readings": "integer: Number of readings.", "end_s": "number: Last time.",
        "noise_K": "table: Sensor -> noise.",
    },
    "diagnose.where": {
        "sensor": "text: Sensor.", "region": "text: Its region.", "phase": "text: heating, cooling ...",
        "run": "text: Measured run.", "hold_out": "boolean: Held out of the fit?", "speed_m_s": "number: Speed.",
        "mean_K": "number: Mean of measured minus computed.", "rms_K": "number: Root mean square.",
        "sigma": "number: The mean over its standard deviation.",
    },
    "diagnose.noise": {
        "stated_K": "number: Of the study.", "from_data_K": "number?: By the scatter of the readings.",
        "used_K": "number: As used.", "correlated": "boolean: Do errors of neighbouring readings go together?",
        "series": "list: The same by run and sensor.",
    },
    "diagnose.again[]": {
        "verdict": "text: Verdict of a further look.", "effects": "list: Named effects.",
        "reasons": "list: Why this verdict.", "folder": "text?: Folder of its full results.",
    },
    "diagnose.strain_laws[]": {
        "law": "text: Strain law.", "heat_factor": "number: Fitted factor on its heat.", "rms_K": "number: Of the fit.",
        "held_out_rms_K": "number?: Of the runs held out.", "log_evidence_gain": "number: Over the study's law, nats.",
    },
    "diagnose.discrepancies[]": {
        "name": "text: Error of the model.", "size_K": "number: Its standard deviation in the readings.",
        "allows_for": "text: What it stands for.",
        "probability": "number?: Posterior probability; null: of a strain law that was tried.",
        "p_value": "number: Probability of a larger misfit beside it.",
        "effects": "table: Effect -> probability beside it.", "parameters": "table: Parameter -> value, sd, unit.",
    },
    "plan.sets[]": {"effects": "text: Set of effects.", "probability": "number: Before the next run."},
    "plan.steps[]": {
        "step": "integer: Number of the step.", "kind": "text: run, sensor, or run + sensor.",
        "run": "integer?: Number of the run.",
        "drive": "text?: The drive in words.", "changes": "table?: Dotted name -> value in this drive.",
        "duration_s": "number?: Duration.", "sensor": "text?: New sensor.", "place": "text?: Its place.",
        "cost": "number: Cost of the step.", "total_cost": "number: Of all steps up to here.",
        "gain_nats": "number: Expected information.", "total_gain_nats": "number: Of all steps up to here.",
        "total_gain_sd_nats": "number: Its standard deviation.", "gain_per_cost": "number: Gain over cost.",
        "expected_probability": "number: Of the true set, expected.", "named_share": "number: Share of named causes.",
        "between": "list: The two sets that it tells apart best.", "pair_probability": "number: Of the right of both.",
    },
    "plan.candidates[]": {
        "drive": "text?: Drive.", "sensor": "text?: Sensor.", "place": "text?: Its place.", "cost": "number: Cost.",
        "gain_nats": "number: Expected information.", "gain_sd_nats": "number: Its standard deviation.",
        "gain_per_cost": "number: Gain over cost.", "expected_probability": "number: Of the true set, expected.",
    },
    "isolability.effects[]": {
        "effect": "text: Effect.", "unit": "text: Unit of its amplitude.", "usual": "number: Usual amplitude.",
        "seen_from": "number?: Amplitude from which the data show it.",
        "told_from": "number?: Amplitude from which it is told from all others.",
        "last_rival": "text: The effect that is told from it last.",
        "identifiable_at_usual": "boolean: Can it be named at its usual amplitude?",
    },
    "blind.cases[]": {
        "number": "integer: Number of the case.", "kind": "text: one, two, none, outside ...",
        "hidden": "list: Hidden effects.", "amplitude": "table: Dotted name -> value over its prior's sd.",
        "identifiable": "boolean: Could it be named?",
        "identifiable_alone*": "boolean: Could it be, were the rest of the data's model the study's?",
        "other_model*": "table: What else of the data's model differs.", "reason*": "text: Why the diagnosis failed.",
        "verdict": "text: Of the diagnosis.",
        "named": "list: Named effects.", "set": "list: Effects that remain possible.", "best": "text: Best set.",
        "probability": "number?: Of the best set.", "rms_K": "table: before, after.",
        "held_out_rms_K": "table: before, after.", "noise_K": "number: Noise.", "seconds": "number: Time, s.",
        "inclusion": "table: Effect -> probability of being in the set.",
        "leading": "list: The most probable sets with their probabilities.", "reasons": "list: Why this verdict.",
        "doubts": "list: Doubts that kept the diagnosis from naming.", "p_value": "number?: Of the best set.",
        "held_out_p": "number?: Of the runs held out.", "station_m": "number?: Hidden heat, along the meridian.",
        "missing_station_m": "number?: Where the diagnosis finds it.", "length_m": "number: Length of the meridian.",
        "points": "table: Numbers of simulations.",
    },
    "blind.rates{}": _RATE,
    "blind.reliability[]": {"stated": "number: Mean stated probability.", **_RATE},
    "blind.failures[]": {
        "number": "integer: Number of the case.", "kind": "text: one, two, none, outside ...",
        "hidden": "list: Hidden effects.", "amplitude": "table: Dotted name -> value over its prior's sd.",
        "fault": "text: What is wrong.", "verdict": "text: Of the diagnosis.", "named": "list: Named effects.",
        "leading": "list: The most probable sets with their probabilities.", "why": "text: The diagnosis's reasons.",
        "other_model*": "table: What else of the data's model differs.",
    },
    "blind.by_effect[]": {
        "effect": "text: Effect.", "cases": "integer: Cases.", "identifiable": "integer: That could be named.",
        "named": "integer: That were.", "else": "list: What was named in its place.",
    },
}  # fmt: skip

#: The same deeper inside.
DIAGNOSIS_INNER: dict[str, Keys] = {
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
        "share": "number: Probability of that.", "decides": "boolean: Is the verdict another?",
    },
    "diagnose.reduced": {
        "used": "boolean: Were reduced models used?", "modes*": "table: Run -> number of modes.",
        "points_by_reduced_models*": "integer: Simulations.", "points_by_lean_simulations*": "integer: The same.",
        "allowed_whitened*": "number: Allowed error over the noise.", "worst_whitened*": "number: Largest.",
        "worst_K*": "number: Largest error.", "certificates*": "list: By set of effects and run.",
        "*": "any: Why they were not used.",
    },
    "diagnose.reduced.certificates[]": {
        "effects": "list: Set of effects.", "run": "text: Run.", "used": "boolean: Is the reduced model good enough?",
        "points": "integer: Full simulations of the certificate.", "whitened": "number?: Error over the noise.",
        "worst_K": "number?: Largest error.", "*": "any: Why it is not good enough.",
    },
    "diagnose.better_strain_law": {
        "stated": "text: Law of the study.", "law": "text: The better one.",
        "heat_factor": "number: Fitted factor on its heat.", "rms_K": "number: Of the fit.",
        "held_out_rms_K": "number?: Of the runs held out.", "log_evidence_gain": "number: Over the study's law, nats.",
        "log_odds": "number: For it, nats.", "held_out_lead": "number?: Of the runs held out.",
        "no_effect_missing": "boolean: Does it explain the data alone?",
        "heat_ratio": "any: Its heat over that of the study's law, by zone.",
    },
    "diagnose.conformal": {
        "sentence": "text: In words.", "sets": "list: Sets of effects.", "effects_in_all": "list: Effects of all sets.",
        "coverage_wanted": "number: Share of cases that hold the true set.", "threshold": "number: Of the score.",
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
        "cooling_run": "boolean?: Do sources go on while the tyre stands?", "kind": "text: heat or flux.",
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
        "sentence": "text: In words.", "stated": "boolean: Is the amount beyond two standard deviations?",
        "sign": "text: heat is missing, or cooling is missing.", "station_m": "number: Along the meridian.",
        "place": "text: In words.", "where": "text: Layer or surface.",
        "inside_told_from_surface": "boolean: Do the data tell them apart?", "kind": "text: heat or flux.",
        "amount_W_m3*": "number: Inside; of a flux amount_W_m2.", "amount_sd_W_m3*": "number: Its standard deviation.",
        "amount_W_m2*": "number: Through a surface.", "amount_sd_W_m2*": "number: Its standard deviation.",
        "amount_at": "table?: Run and time of the amount, where a free course is clear then, but not its mean.",
        "moves": "table?: Largest change of a reading.", "station_probabilities": "list: By station.",
        "depth": "table: Layer or surface -> probability.", "course": "text: Most probable course in time.",
        "course_probabilities": "table: Course -> probability.", "time_s": "number?: When it begins or ends.",
        "time_sd_s": "number?: Its standard deviation.", "log_evidence_gain": "number: Over no source, nats.",
        "runs": "list: The amount over time.",
    },
    "diagnose.missing_heat.sources[].amount_at": {"run": "text: Run.", "time_s": "number: Time."},
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
        "sentences": "list: In words.", "holds": "boolean: Is it stated?",
        "lead_nats": "number: Over sources with a free strength in every run.",
        "share": "number: Of their gain in evidence.", **_PLACE_OF_LAW,
        "exponents": "list: Of every variable that varies.", "switch": "text: When the heat acts.",
        "switch_probabilities": "table: Switch -> probability.", "time_s": "number?: When it begins or ends.",
        "time_sd_s": "number?: Its standard deviation.", "alternatives": "list: Other laws within 4.6 nats.",
        "hardly_vary": "list: Variables that hardly vary.", "vary_together": "list: Pairs that vary together.",
        "signatures": "list: Effects and mechanisms, most alike first.",
        "draft_effect": "text?: File of the draft effect.", "places": "list: Places that competed.",
    },
    "diagnose.missing_heat.law.exponents[]": {
        "name": "text: Variable.", "in_law": "boolean: Is it in the law?", "mean": "number: Exponent.",
        "sd": "number: Its standard deviation.", "probability": "number: That it acts.",
        "told_by_runs": "boolean: Do the runs tell more than the prior?",
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
        "fitted": "boolean: Simulated and fitted as a diagnosis does; else linear.",
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
}  # fmt: skip
