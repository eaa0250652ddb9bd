"""A failing plugin names file, class and what was expected; it never takes the rest down."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

import tyrefem as tf
from tyrefem.boundaries import laws
from tyrefem.contracts import template
from tyrefem.diagnose.forward.fixed_step import breaks
from tyrefem.effects import catalogue, use_effects
from tyrefem.errors import PluginWarning
from tyrefem.mechanics.strain_laws import strain_laws
from tyrefem.plugins import registry, use
from tyrefem.sweep.question import sweep_questions

pytestmark = pytest.mark.fast

Write = Callable[..., Path]
COARSE = {"mesh.size": "12 mm", "mesh.element": "P1", "drive.duration": "60 s"}
FILM = {"law": "power-film", "at_10_m_s": "30 W/m**2/K"}
LOSS = {"law": "arrhenius", "value": 0.2, "activation": "800 K", "source": "estimate: a test"}
FRICTION = {"law": "falling", "at_rest": 1.1, "source": "estimate: a test"}
#: Kind -> changes of a study that use its template.
USES = {
    "effect": {"effects": [{"name": "lamp", "shine": "50 W/m**2"}]},
    "boundary-law": {"boundaries.outside_air": FILM},
    "tan-delta-law": {"materials.tread": {"base": "nasa-tread", "loss_tangent": LOSS}},
    "strain-law": {"mechanics.strain": "crown-to-bead"},
    "friction-law": {"materials.tread": {"base": "nasa-tread", "friction": FRICTION}},
}
SIGNATURES = {
    "effect": ("def flux(self, tyre, surface, x, t)", "def flux(self, tyre, x)", "flux(self, tyre, surface, x, t)"),
    "boundary-law": ("def film(self, speed)", "def film(self)", "film(self, speed)"),
    "tan-delta-law": (
        "(self, temperature, frequency)",
        "(self, temperature)",
        "tan_delta(self, temperature, frequency)",
    ),
    "strain-law": ("def provider(self, study)", "def provider(self)", "provider(self, study)"),
    "friction-law": ("(self, speed, pressure, temperature)", "(self, speed)", "mu(self, speed, pressure, temperature)"),
    "sweep-answer": ("def rows(self, variants)", "def rows(self)", "rows(self, variants)"),
}


def study(changes: dict) -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", {**COARSE, **changes})


@pytest.mark.parametrize("kind", SIGNATURES)
def test_a_wrong_signature_is_found_at_loading(write: Write, kind: str) -> None:
    right, wrong, expected = SIGNATURES[kind]
    file = write(kind, (right, wrong))
    with pytest.warns(PluginWarning) as warned:
        assert registry().plugins == ()
    (message,) = [str(warning.message) for warning in warned]
    assert message.startswith(f"left out: {file}: class ")
    assert f"method must be {expected}" in message
    assert study({}).run().peaks["tyre"].temperature > 30
    if kind in USES:
        with pytest.raises(tf.InputError) as caught:
            study(USES[kind])
        assert str(file) in str(caught.value)
        assert expected in str(caught.value)


@pytest.mark.parametrize("kind", USES)
@pytest.mark.parametrize(
    ("broken", "words"),
    [("import nothing_like_it\n", "ModuleNotFoundError"), ("def f(:\n", "line 1: SyntaxError"), ("1 / 0\n", "(line 1)"),
     ("raise SystemExit\n", "SystemExit")],
)  # fmt: skip
def test_a_file_that_cannot_be_loaded_is_named_where_it_is_used(
    write: Write, kind: str, broken: str, words: str
) -> None:
    file = write(kind)
    file.write_text(broken + file.read_text(encoding="utf-8"), encoding="utf-8")
    with pytest.warns(PluginWarning, match=r"cannot be loaded"):
        loaded = study({})
    with pytest.raises(tf.InputError) as caught:
        loaded.replace(USES[kind])
    assert str(caught.value).startswith(str(file))
    assert "stands in this file, which cannot be loaded" in str(caught.value)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


VALUES = {
    "film nan": ("boundary-law", "self.at_rest + ", "np.nan + ", "film(0 m/s) must be a finite number of at least 0"),
    "film text": ("boundary-law", "return self", "return 'much' #", "must be a finite number of at least 0 W/m2/K"),
    "film without return": ("boundary-law", "return self", "self", "of at least 0 W/m2/K, not None"),
    "film as text": ("boundary-law", "return self", "return '30' #", "of at least 0 W/m2/K, not '30'"),
    "film negative": ("boundary-law", "return self", "return -self", "not -6"),
    "film array": ("boundary-law", "return self", "return np.ones(3) #", "not an array of shape (3,)"),
    "tan delta shape": ("tan-delta-law", "return self", "return np.ones(3) #", "must give shape (13,), not (3,)"),
    "tan delta in percent": ("tan-delta-law", "self.value *", "100 * self.value *", "from 0 to 10"),
    "tan delta nan": ("tan-delta-law", "self.value *", "np.log(-1.0 * self.value) *", "not nan"),
    "mu negative": ("friction-law", "return self", "return -self", "mu(0 to 60 m/s, 1 to 5000 kPa, -20 degC)"),
    "mu text": ("friction-law", "return self", "return self.grip + self", "AttributeError"),
}


@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")
@pytest.mark.parametrize("fault", VALUES)
def test_wrong_values_of_a_law_are_refused_when_its_card_is_read(write: Write, fault: str) -> None:
    kind, old, new, words = VALUES[fault]
    file = write(kind, (old, new), ("from typing", "import numpy as np\nfrom typing"))
    assert study({}).name
    with pytest.raises(tf.InputError) as caught:
        study(USES[kind])
    assert str(file) in str(caught.value)
    assert words in str(caught.value)


EFFECTS = {
    "nan": ("return self.shine", "return float('nan')", "must be finite numbers of shape", "not nan"),
    "shape": ("return self.shine", "return x", "flux: must give a number, or ", "array of shape (2, "),
    "text": ("return self.shine", "return 'much'", "flux: must give a number, or ", "'much'"),
    "error": ("return self.shine", "return self.shade", "flux: AttributeError", "(line "),
}


@pytest.mark.parametrize("fault", EFFECTS)
def test_wrong_values_of_an_effect_end_before_the_first_step(write: Write, fault: str) -> None:
    old, new, *words = EFFECTS[fault]
    file = write("effect", (old, new))
    reached: list[float] = []
    with pytest.raises(tf.InputError) as caught:
        study(USES["effect"]).run(reached.append)
    assert reached == []
    assert str(caught.value).startswith(f"{file}: class Lamp")
    for word in words:
        assert word in str(caught.value)


def test_an_error_in_mid_run_names_the_plugin(write: Write) -> None:
    file = write("effect", ("return self.shine", "return 'much' + 1 if 20 < t < 25 else self.shine"))
    with pytest.raises(tf.InputError, match=r"class Lamp, flux: TypeError: .*\(line \d+\)") as caught:
        study(USES["effect"]).run()
    assert str(caught.value).startswith(str(file))


STRAINS = {
    "negative": ("return (CROWN", "return -(CROWN", "energy_density('carcass'"),
    "shape": ("return (CROWN", "return np.ones(3) * (CROWN", "class CrownToBead, energy_density: ValueError"),
    "no zones": ("return tuple(Zone(", "return () and tuple(Zone(", "the strain cycle's zones must be a tuple"),
    "no return": ("return (CROWN", "(CROWN", "numbers for 7 points, not None"),
    "zones of one name": ("Zone(region, region, region)", "Zone('all', region, region)", "the name 'all' twice"),
    "zones that fail": ("return tuple(Zone(", "return tuple(Zon(", "class CrownToBead, zones: NameError"),
    "unknown region": ("Zone(region, region, region)", "Zone(region, 'belt', region)", "name the region 'belt'"),
    "no function": ("return lambda case: ", "return ", "NameError"),
}


@pytest.mark.parametrize("fault", STRAINS)
def test_wrong_strain_cycles_are_refused(write: Write, fault: str) -> None:
    old, new, words = STRAINS[fault]
    file = write("strain-law", (old, new))
    with pytest.raises(tf.InputError) as caught:
        study(USES["strain-law"]).run()
    assert str(file) in str(caught.value)
    assert "class CrownToBead" in str(caught.value)
    assert words in str(caught.value)


def test_a_class_whose_check_fails_is_left_out(write: Write) -> None:
    """Two arguments of a Prior in each other's place, which every command would meet."""
    file = write("effect", ('"flux through the sidewall", 50.0', '50.0, "flux through the sidewall"'))
    with pytest.warns(PluginWarning, match="class Lamp: effect 'lamp' cannot be checked: TypeError"):
        assert registry().plugins == ()
    assert study({}).name
    with pytest.raises(tf.InputError, match="class Lamp: effect 'lamp' cannot be checked") as caught:
        study(USES["effect"])
    assert str(file) in str(caught.value)


@pytest.mark.parametrize("broken", ["return tuple(Zone(", "return (CROWN"])
def test_an_error_of_a_strain_cycle_has_its_line(write: Write, broken: str) -> None:
    file = write("strain-law", (broken, f"return 1 / 0 or {broken.removeprefix('return ')}"))
    line = 1 + file.read_text(encoding="utf-8").partition("1 / 0")[0].count("\n")
    with pytest.raises(tf.InputError, match=rf"ZeroDivisionError: division by zero \(line {line}\)"):
        study(USES["strain-law"]).run()


@pytest.mark.parametrize("content", ["return self.at_rest + undefined * speed", "return self.at_rest / (0.0 * speed)"])
def test_an_error_of_a_method_that_gives_a_number_has_its_line(write: Write, content: str) -> None:
    """Such methods are wrapped once more, in a file with lines of its own."""
    whole = "return self.at_rest + self.at_10_m_s * (speed / 10.0) ** self.exponent"
    file = write("boundary-law", (whole, content))
    line = 1 + file.read_text(encoding="utf-8").partition(content)[0].count("\n")
    with pytest.raises(tf.InputError, match=rf"class PowerFilm, film: \w+: .* \(line {line}\)"):
        study(USES["boundary-law"]).run()


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"x = 1\n\0", "Error: source code string cannot contain null bytes"),
        (b"exec(compile('a = (', 'helper.py', 'exec'))\n", "cannot be loaded: line 1 of helper.py: SyntaxError"),
    ],
)
def test_a_line_that_is_not_of_the_file_is_not_said_to_be(folder: Path, content: bytes, words: str) -> None:
    (folder / "broken.py").write_bytes(content)
    with pytest.warns(PluginWarning) as warned:
        registry()
    assert words in str(warned[0].message)
    assert "None" not in str(warned[0].message)


COLLISIONS = {
    "effect": ("sun", lambda: catalogue()["sun"]),
    "strain-law": ("arcs", lambda: strain_laws()["arcs"].__class__),
    "sweep-answer": ("tornado", lambda: sweep_questions()["tornado"]),
    "boundary-law": ("nasa", lambda: laws("outside_air")["nasa"]),
}


@pytest.mark.parametrize("kind", COLLISIONS)
def test_a_plugin_never_replaces_a_shipped_one(write: Write, kind: str) -> None:
    name, shipped = COLLISIONS[kind]
    file = write(kind, name=name)
    with pytest.warns(PluginWarning, match=r"has the name of a shipped .*tyrefem\.\w+"):
        assert shipped().__module__.startswith("tyrefem.")
    assert shipped().__module__ != file.stem


def test_a_study_that_names_a_taken_name_is_refused_with_both(write: Write) -> None:
    file = write("effect", name="sun")
    with pytest.warns(PluginWarning):
        registry()
    with pytest.raises(tf.InputError) as caught:
        study({"effects": [{"name": "sun", "absorbed": "50 W/m**2"}]})
    assert str(file) in str(caught.value)
    assert "tyrefem.effects.sun" in str(caught.value)


def test_two_plugins_of_a_name_are_refused_with_both(write: Write, folder: Path) -> None:
    first = write("effect")
    second = folder / "second.py"
    second.write_text(first.read_text(encoding="utf-8") + "\n# another\n", encoding="utf-8")
    with pytest.warns(PluginWarning, match="has the name of class Lamp of"):
        registry()
    with pytest.raises(tf.InputError) as caught:
        study(USES["effect"])
    assert str(first) in str(caught.value)
    assert str(second) in str(caught.value)


def test_a_folder_that_is_missing_is_a_warning(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TYREFEM_PLUGINS", "/nowhere/at/all")
    with pytest.warns(PluginWarning, match="TYREFEM_PLUGINS names '/nowhere/at/all', which is not a folder"):
        assert "sun" in catalogue()
    with pytest.raises(tf.InputError, match="no such file or folder"):
        use("/nowhere/at/all")


def test_files_with_an_underscore_are_left_out(folder: Path) -> None:
    (folder / "_helper.py").write_text("1 / 0\n", encoding="utf-8")
    assert registry().modules == ()


def test_an_edited_file_is_read_again(write: Write, folder: Path) -> None:
    write("effect")
    assert "A lamp" in catalogue()["lamp"].sentence
    write("effect", ("A lamp shines", "A sun lamp shines"))
    use(folder)
    assert "A sun lamp" in catalogue()["lamp"].sentence


@pytest.mark.parametrize("place", ["~no-such-user-42/plugins", "a" * 3000])
def test_a_folder_that_cannot_be_is_a_warning_too(place: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TYREFEM_PLUGINS", place)
    with pytest.warns(PluginWarning, match="which is not a folder"):
        assert registry().plugins == ()
    with pytest.raises(tf.InputError, match="no such file or folder"):
        use(place)


def test_a_file_whose_loading_was_interrupted_is_loaded_again(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Half of its module counted as loaded, without the classes that were to follow."""
    lines = ("import os", "if os.environ.pop('INTERRUPTED', ''):", "    raise KeyboardInterrupt", "value = 1", "")
    file = folder / "slow.py"
    file.write_text("\n".join(lines), encoding="utf-8")
    monkeypatch.setenv("INTERRUPTED", "yes")
    with pytest.raises(KeyboardInterrupt):
        registry()
    assert [module.module.value for module in registry().modules if module.origin.file == file.resolve()] == [1]


def test_a_folder_with_the_separator_of_paths_in_its_name_is_refused_in_words(folder: Path) -> None:
    """As a time has it, 12:30: it was split, and said to have no effect."""
    place = folder / f"12{os.pathsep}30"
    place.mkdir()
    (place / "lamp.py").write_text(template("effect", "lamp"), encoding="utf-8")
    for name in (use, use_effects):
        with pytest.raises(tf.InputError, match="which separates the folders in TYREFEM_PLUGINS"):
            name(place)


IN_PLACE = {
    "effect": ("return self.shine", "x += 0.0"),
    "tan-delta-law": ("kelvin = np", "temperature += 0.0; kelvin = np"),
    "friction-law": ("warm = np", "speed += 0.0; warm = np"),
    "strain-law": ("return (CROWN", "points += 0.0; return (CROWN"),
}


@pytest.mark.parametrize("kind", IN_PLACE)
def test_an_array_that_a_method_is_given_cannot_be_changed_in_place(write: Write, kind: str) -> None:
    """The solver's temperatures were shifted for the effects that came after: 5 K too hot, by their order."""
    file = write(kind, IN_PLACE[kind])
    with pytest.raises(tf.InputError, match=r"read-only \(line \d+\)") as caught:
        study(USES[kind]).run()
    assert str(file) in str(caught.value)


CLASSES = {
    "surface": ('("outside_air",)', '("outside-air",)', "unknown surface 'outside-air'; did you mean 'outside_air'"),
    "text": ('("outside_air",)', '("outside_air")', "'surfaces' must be a tuple of names"),
    "jump": ("    # Unit,", "    jumps: ClassVar = 5.0\n    # Unit,", "'jumps' must be a tuple of times in seconds"),
    "jumps": ("    # Unit,", "    jumps: ClassVar = ['s']\n    # Unit,", "'jumps' must be a tuple of times in seconds"),
    "no unit": ('"W/m**2"', '""', "parameter 'shine' needs a unit"),
    "no such unit": ('"W/m**2"', '"W/mm**2/x"', "parameter 'shine': unknown unit 'W/mm"),
}


@pytest.mark.parametrize("fault", CLASSES)
def test_a_class_that_would_do_nothing_is_left_out_in_words(write: Write, fault: str) -> None:
    old, new, words = CLASSES[fault]
    write("effect", (old, new))
    with pytest.warns(PluginWarning, match=words):
        assert registry().plugins == ()


def test_jumps_may_be_a_list(write: Write) -> None:
    """Times of a diagnosis are those of all effects, also of one that the study does not have."""
    write("effect", ("    # Unit,", "    jumps: ClassVar = [5.0]\n    # Unit,"))
    assert 5.0 in breaks(study({}))


def test_a_factor_for_another_number_of_temperatures_names_the_plugin(write: Write) -> None:
    """Three, as many as the trial has: a traceback of the solver."""
    port = "def capacity_factor(self, tyre, region, T):\n        return [1.0, 1.0, 1.0]\n\n    def flux("
    file = write("effect", ("def flux(", port))
    with pytest.raises(tf.InputError, match=r"capacity_factor: must give a number, or \d+ numbers for") as caught:
        study(USES["effect"]).run()
    assert str(caught.value).startswith(f"{file}: class Lamp")


STATES = {
    "text": ("{'w': 'much'}", "{'w': 0.0}", "initial_states: 'w' must be finite, a number or an array"),
    "nothing": ("None", "{'w': 0.0}", "initial_states: must return a mapping with w, not None"),
    "shape": ("{'w': [0.0, 0.0]}", "{'w': 0.0}", r"state_rates: state 'w' has the shape \(2,\), its rate \(\)"),
}


@pytest.mark.parametrize("fault", STATES)
def test_wrong_states_name_the_plugin(write: Write, fault: str) -> None:
    """The first two were a traceback; the third named no file."""
    begin, rates, words = STATES[fault]
    states = (
        "    states: ClassVar = {'w': EffectState('K', 'warmth')}\n\n"
        f"    def initial_states(self, tyre):\n        return {begin}\n\n"
        f"    def state_rates(self, tyre, t, state, temperatures):\n        return {rates}\n\n"
    )
    file = write("effect", ("import Effect,", "import Effect, EffectState,"), ("    # Unit,", f"{states}    # Unit,"))
    with pytest.raises(tf.InputError, match=words) as caught:
        study(USES["effect"]).run()
    assert str(caught.value).startswith(f"{file}: class Lamp")


LATE = {
    "film without return": ("boundary-law", "return self", "if not 8 < speed < 9.5: return self", "film: .* not None"),
    "film nan": ("boundary-law", "return self", "return np.nan if 8 < speed < 9.5 else self", "film: .* not nan"),
    "tan delta nan": (
        "tan-delta-law", "return self", "return np.where(abs(temperature - 26.5) < 1.0, np.nan, 0.1) * self",
        "tan_delta: must give finite numbers, not nan at 2[56]",
    ),
    "energy nan": (
        "strain-law", "return (CROWN", "return np.nan if points.shape[1] > 20 else (CROWN",
        "energy_density: must be finite, of at least 0 J/m3, not nan",
    ),
}  # fmt: skip


@pytest.mark.parametrize("fault", LATE)
def test_a_value_that_no_trial_meets_names_the_plugin(write: Write, fault: str) -> None:
    """A traceback, or an error of the solver for another boundary, without the file."""
    kind, old, new, words = LATE[fault]
    file = write(kind, (old, new), ("from typing", "import numpy as np\nfrom typing"))
    with pytest.raises(tf.InputError, match=words) as caught:
        study(USES[kind]).run()
    assert str(caught.value).startswith(f"{file}: class ")


SPECTRA = {
    "error": ("1 / 0", r"spectrum: ZeroDivisionError: division by zero \(line \d+\)"),
    "shape": ("np.ones(3)", r"spectrum: must give \d+ numbers for \d+ points for each of 1 to 35 orders, not \(3,\)"),
    "too many": ("np.ones((36, points.shape[1]))", "for each of 1 to 35 orders, not .36, "),
    "nothing": ("None", "for each of 1 to 35 orders, not None"),
    "negative": ("-np.ones((2, points.shape[1]))", "spectrum: must be finite, of at least 0 J/m3, not -1"),
}


@pytest.mark.parametrize("fault", SPECTRA)
def test_a_wrong_spectrum_names_the_plugin(write: Write, fault: str) -> None:
    """A traceback in the run, or heat of further orders left out, or negative heat."""
    given, words = SPECTRA[fault]
    spectrum = f"def spectrum(self, zone, points):\n        return {given}\n\n    # J/m3 at points"
    file = write("strain-law", ("# J/m3 at points", spectrum))
    with pytest.raises(tf.InputError, match=words) as caught:
        study(USES["strain-law"]).run()
    assert str(caught.value).startswith(f"{file}: class CrownToBead")


def test_a_wrong_solved_case_names_the_plugin(write: Write) -> None:
    case = "@property\n    def solved_case(self):\n        return None\n\n    # J/m3 at points"
    file = write("strain-law", ("# J/m3 at points", case))
    with pytest.raises(tf.InputError, match=r"solved_case must be a .*LoadCase, not None") as caught:
        study(USES["strain-law"]).run()
    assert str(caught.value).startswith(f"{file}: class CrownToBead")
