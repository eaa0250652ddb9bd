"""Plugins of installed packages, in worker processes, on other machines, in reduced models and kept results."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.plugins import registry, sent, use
from tyrefem.variants.answer_store import effects_source, study_digest
from tyrefem.variants.dask_cluster import Dask
from tyrefem.variants.plan import plan_of
from tyrefem.variants.schedulers import Here, Local
from tyrefem.variants.task import Bundle, Task, VersionError, bundle, perform, unpacked

Write = Callable[..., Path]
COARSE = {"mesh.size": "12 mm", "mesh.element": "P1", "drive.duration": "60 s", "output.fields": 2}
FILM = {"law": "power-film", "at_10_m_s": "30 W/m**2/K"}
LOSS = {"law": "arrhenius", "value": 0.2, "activation": "800 K", "source": "estimate: a test"}
OWN = {
    "boundaries.outside_air": FILM,
    "materials.tread": {"base": "nasa-tread", "loss_tangent": LOSS},
    "mechanics.strain": "crown-to-bead",
    "effects": [{"name": "lamp", "shine": "50 W/m**2"}],
}
OWN_OF_KIND = {
    "strain-law": {"mechanics.strain": "crown-to-bead"},
    "effect": {"effects": OWN["effects"]},
    "boundary-law": {"boundaries.outside_air": FILM},
}
KINDS = ("effect", "boundary-law", "tan-delta-law", "strain-law")


@pytest.fixture
def study(write: Write) -> tf.Study:
    """A coarse study with an own effect, boundary law, tan delta law and strain law."""
    for kind in KINDS:
        write(kind)
    return tf.study("nasa-22x5.5-8pr", {**COARSE, **OWN})


def package(place: Path, text: str, version: str = "1.2", entry: str = "hot_laws") -> Path:
    """An installed package with an entry point."""
    place.mkdir(exist_ok=True)
    (place / "hot_laws.py").write_text(text, encoding="utf-8")
    info = place / f"hot_laws-{version}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: hot-laws\nVersion: {version}\n", encoding="utf-8")
    (info / "entry_points.txt").write_text(f"[tyrefem]\nlaws = {entry}\n", encoding="utf-8")
    return place


def listed(packages: Path, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    """A command with packages beside the installed ones."""
    paths = os.pathsep.join([str(packages), os.environ.get("PYTHONPATH", "")])
    environment = os.environ | {"PYTHONPATH": paths, "TYREFEM_PLUGINS": ""} | variables
    command = [sys.executable, "-m", "tyrefem", *arguments]
    return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=False)


def test_a_package_s_laws_are_known_and_can_be_switched_off(write: Write, tmp_path: Path) -> None:
    text = write("boundary-law").read_text(encoding="utf-8") + write("effect").read_text(encoding="utf-8")
    packages = package(tmp_path / "site", text)
    done = listed(packages, "list", "plugins")
    assert done.stderr == ""
    assert done.stdout.count("[package hot-laws 1.2 (hot_laws)]") == 2
    for off in ("laws", "all", "other, laws"):
        assert listed(packages, "list", "plugins", TYREFEM_PLUGINS_OFF=off).stdout == ""
    assert listed(packages, "list", "plugins", TYREFEM_PLUGINS_OFF="other").stdout == done.stdout


def test_an_entry_point_may_name_a_single_class(write: Write, tmp_path: Path) -> None:
    text = write("boundary-law").read_text(encoding="utf-8") + write("effect").read_text(encoding="utf-8")
    done = listed(package(tmp_path / "site", text, entry="hot_laws:PowerFilm"), "list", "plugins")
    assert [line.split()[0] for line in done.stdout.splitlines()] == ["boundary"]


def test_a_failing_package_names_itself(write: Write, tmp_path: Path) -> None:
    packages = package(tmp_path / "site", "import nothing_like_it\n")
    done = listed(packages, "list", "strain-laws")
    assert done.returncode == 0
    assert "arcs" in done.stdout
    assert done.stderr.startswith("tyrefem: warning: left out: package hot-laws 1.2 (hot_laws): cannot be loaded: Mod")
    assert done.stderr.count("\n") == 1


def test_worker_processes_have_the_same_plugins(study: tf.Study) -> None:
    speeds = {"drive.speed": ["10 mph", "20 mph"]}
    here = study.sweep(speeds, reduced="never").table["hottest_degC"].to_numpy()
    there = study.sweep(speeds, reduced="never", scheduler=Local(2)).table["hottest_degC"].to_numpy()
    assert np.array_equal(here, there)
    assert here[0] < here[1]


def test_pickled_laws_are_found_in_another_process(study: tf.Study) -> None:
    law = pickle.dumps(study.materials["tread"].loss_tangent)
    code = "import pickle, sys; print(float(pickle.load(sys.stdin.buffer)(60.0)))"
    came = subprocess.run([sys.executable, "-c", code], input=law, capture_output=True, timeout=120, check=True)
    assert float(came.stdout) == float(study.materials["tread"].loss_tangent(60.0))


def test_a_study_takes_its_plugins_to_another_machine(study: tf.Study, tmp_path: Path) -> None:
    """A process without the folder, as a Dask worker on another machine, runs the packed study."""
    task = Task(0, bundle(study), {})
    code = (
        "import pickle, sys; from tyrefem.variants.task import perform; "
        "print(perform(pickle.load(sys.stdin.buffer)).answers['hottest_degC'])"
    )
    environment = {name: text for name, text in os.environ.items() if not name.startswith("TYREFEM")}
    came = subprocess.run(
        [sys.executable, "-c", code], input=pickle.dumps(task), env=environment, capture_output=True, timeout=120,
        check=True, cwd="/",
    )  # fmt: skip
    assert float(came.stdout) == perform(task).answers["hottest_degC"]


def test_workers_of_a_dask_cluster_have_the_plugins(study: tf.Study) -> None:
    """Two workers that know no folder of plugins give the answers of this process."""
    distributed = pytest.importorskip("distributed")
    vary = {"drive.speed": ("10 mph", "20 mph", 6)}
    # A nanny sets these before its worker begins.
    none = {"TYREFEM_PLUGINS": "", "TYREFEM_EFFECTS": "", "OMP_NUM_THREADS": "1"}
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, worker_class=distributed.Nanny,
            env=none,
        ) as cluster,
        distributed.Client(cluster) as client,
    ):  # fmt: skip
        assert client.run(lambda: os.environ["TYREFEM_PLUGINS"]) == dict.fromkeys(client.nthreads(), "")
        far = study.sweep(vary, scheduler=Dask(client), reduced="never")
    assert far.failed == {}
    here = study.sweep(vary, scheduler=Here(), reduced="never")
    assert np.array_equal(far.table["hottest_degC"], here.table["hottest_degC"])


def test_the_sender_s_files_go_before_the_worker_s(study: tf.Study, write: Write, folder: Path) -> None:
    packed = bundle(study)
    expected = perform(Task(0, packed, {})).answers["hottest_degC"]
    write("strain-law", ("100e3, 5e3", "10e3, 5e3"))
    use(folder)
    assert perform(Task(0, bundle(study), {})).answers["hottest_degC"] < expected - 1
    assert perform(Task(0, packed, {})).answers["hottest_degC"] == expected


def test_a_missing_package_is_said(study: tf.Study) -> None:
    packed = bundle(study)
    lacking = Bundle(packed.name, packed.data, packed.files, packed.version, type(packed.plugins)(
        packed.plugins.files, {"hot_laws": ("hot-laws", "1.2", "0")}))  # fmt: skip
    with pytest.raises(VersionError, match=r"the plugin package 'hot-laws' 1\.2 is not installed on this worker"):
        unpacked(lacking)


def keys_of(study: tf.Study) -> list[str]:
    """Keys under which results of a study are kept."""
    plan = plan_of(study, {"drive.speed": ["9 mph"]})
    return [bundle(study).digest, effects_source(), study_digest(study), plan.digest]


def test_an_edited_plugin_makes_other_keys(study: tf.Study, write: Write, folder: Path) -> None:
    before = keys_of(study)
    write("tan-delta-law", ("self.value *", "0.9 * self.value *"))
    use(folder)
    after = keys_of(tf.study("nasa-22x5.5-8pr", {**COARSE, **OWN}))
    assert all(old != new for old, new in zip(before, after, strict=True))


def test_without_plugins_keys_are_as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TYREFEM_PLUGINS", "")
    monkeypatch.setenv("TYREFEM_EFFECTS", "")
    assert sent().digest == ""
    assert registry().plugins == ()


def test_a_reduced_model_with_own_laws_is_certified(study: tf.Study) -> None:
    """The certified reduced model answers as full runs do, to the certificate's error."""
    vary = {"drive.speed": ("10 mph", "20 mph", 4), "drive.ambient": ("10 degC", "30 degC", 4)}
    study = study.replace({"effects": []})  # a flux has no reduced model
    reduced = study.sweep(vary, reduced="always")
    assert reduced.swept is not None
    assert reduced.swept.certificate is not None
    assert reduced.swept.reduced == 16
    full = study.sweep(vary, reduced="never")
    error = np.abs(reduced.table["hottest_degC"] - full.table["hottest_degC"]).max()
    assert error <= 2 * reduced.swept.certificate.worst + 1e-9


def test_a_law_of_frequency_has_full_runs_where_it_cannot_be_reduced(write: Write) -> None:
    write("tan-delta-law", ("return self.value", "return (frequency / 10) ** 0.1 * self.value"),
          ("    at: Temp", "    of_frequency: ClassVar[bool] = True\n    at: Temp"))  # fmt: skip
    changes = {"materials.tread": {"base": "nasa-tread", "loss_tangent": LOSS}}
    study = tf.study("nasa-22x5.5-8pr", {**COARSE, **changes})
    faster = study.replace({"drive.speed": "40 mph"})
    # At other revolutions tan delta is another: more than in proportion.
    heats = [each.run().heat_budget.total("generated") for each in (study, faster)]
    assert heats[1] > 2 * heats[0]
    swept = study.sweep({"drive.speed": ("10 mph", "20 mph", 12)}).swept
    assert swept is not None
    assert swept.failed == {}


def test_a_comparison_records_what_it_used(write: Write) -> None:
    file = write("effect")
    coarse = {"mesh.size": "12 mm", "mesh.element": "P1", "numerics.tolerance": "0.5 delta_degC"}
    study = tf.study("example-validation", {**coarse, "effects": OWN["effects"]})
    (used,) = study.compare(inputs=False).to_dict()["plugins"]
    assert (used["kind"], used["name"], used["file"]) == ("effect", "lamp", str(file))
    assert study.replace({"effects": []}).compare(inputs=False).to_dict()["plugins"] == []


def test_a_tyre_rolls_with_an_own_friction_law_as_with_the_same_shipped_one(write: Write) -> None:
    write("friction-law")
    base = {"mechanics.strain": "fem", "mechanics.motion": "linear", "mesh.size": "12 mm", "mesh.element": "P1"}
    constant = {"law": "constant", "coefficient": 0.9, "source": "estimate: a test"}
    same = {"law": "falling", "at_rest": 0.9, "falls_by_half": "1e9 m/s", "rate": "0 1/delta_degC", "source": "a test"}
    falling = {**same, "falls_by_half": "2 m/s"}
    forces = []
    for friction in (constant, same, falling):
        tread = {"base": "nasa-tread", "friction": friction}
        rolled = tf.study("nasa-22x5.5-8pr", {**base, "materials.tread": tread}).roll(slip_angle=0.05)
        forces.append(rolled.summary()["F_y_N"])
    assert forces[1] == pytest.approx(forces[0], rel=1e-8)
    assert abs(forces[2]) < 0.99 * abs(forces[0])


@pytest.mark.parametrize("kind", ["strain-law", "effect", "boundary-law"])
def test_a_loaded_run_names_the_plugin_that_is_missing(
    write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    file = write(kind)
    changes = {"mesh.size": "14 mm", "mesh.element": "P1", "drive.duration": "30 s", **OWN_OF_KIND[kind]}
    tf.study("nasa-22x5.5-8pr", changes).run().save(tmp_path / "out")
    assert tf.load(tmp_path / "out").study.card is not None
    monkeypatch.setenv("TYREFEM_PLUGINS", "")
    with pytest.raises(tf.InputError) as caught:
        tf.load(tmp_path / "out")
    assert f"the result used the {kind.replace('-', ' ')} '" in str(caught.value)
    assert f"of {file}, which this process has not: set TYREFEM_PLUGINS={file.parent}, or" in str(caught.value)


def test_a_class_of_a_package_stays_the_package_s_where_a_file_extends_it(
    write: Write, folder: Path, tmp_path: Path
) -> None:
    """It counted as the file's: the package's class "has the name of" it, and no study could use it."""
    packages = package(tmp_path / "site", write("effect").read_text(encoding="utf-8"))
    (folder / "lamp.py").unlink()
    (folder / "mine.py").write_text('import hot_laws\n\n\nLamp = hot_laws.Lamp\n\n\nclass Second(Lamp):\n    """."""\n'
                                    '\n    name = "second"\n', encoding="utf-8")  # fmt: skip
    done = listed(packages, "list", "plugins", TYREFEM_PLUGINS=str(folder))
    assert done.stderr == ""
    lamp, second = done.stdout.splitlines()
    assert lamp.endswith("[package hot-laws 1.2 (hot_laws)]")
    assert second.endswith(f"[{folder / 'mine.py'}]")


def test_a_package_has_the_same_digest_whatever_is_loaded_of_it(
    write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Workers that had loaded fewer of its modules refused the study, as from another package."""
    text = write("boundary-law").read_text(encoding="utf-8")
    packages = package(tmp_path / "site", "", entry="hot_laws.air")
    (packages / "hot_laws.py").unlink()
    (packages / "hot_laws").mkdir()
    for name, content in (("__init__", ""), ("air", text), ("tools", "x = 1\n")):
        (packages / "hot_laws" / f"{name}.py").write_text(content, encoding="utf-8")
    monkeypatch.setenv("TYREFEM_PLUGINS", "")
    code = "from tyrefem.plugins import sent; print(sent().packages)"
    digests = []
    for first in ("", "import hot_laws.tools; "):
        environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(packages), os.environ.get("PYTHONPATH", "")])}
        command = [sys.executable, "-c", first + code]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=True)
        digests.append(done.stdout)
    assert "hot_laws.air" in digests[0]
    assert digests[0] == digests[1]


def test_an_edited_law_acts_in_the_next_sweep_of_this_process(write: Write, folder: Path) -> None:
    """A sweep went on with materials and films of the former law, which the tyres of the last sweep had."""
    write("tan-delta-law")
    changes = {**COARSE, "materials.tread": {"base": "nasa-tread", "loss_tangent": LOSS}}
    study, speeds = tf.study("nasa-22x5.5-8pr", changes), {"drive.speed": ["20 mph"]}
    before = study.sweep(speeds, reduced="never", scheduler=Here()).table["hottest_degC"][0]
    write("tan-delta-law", ("return self.value *", "return 2.0 * self.value *"))
    use(folder)
    changed = study.replace({"drive.speed": "20 mph"})
    run = changed.run().peaks["tyre"].temperature
    assert run > before + 1
    for each in (study, changed):
        swept = each.sweep(speeds, reduced="never", scheduler=Here()).table["hottest_degC"][0]
        assert swept == pytest.approx(run, abs=1e-9)
    (old,), (new,) = (plugin_summary(each)["plugins"] for each in (study, changed))
    assert old["name"] == new["name"] == "arrhenius"
    assert old["sha256"] != new["sha256"]
