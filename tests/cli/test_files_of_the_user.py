"""Files of the user beside what is written: tables of a copied study, a study of the same name, results from Python."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.errors import InputError
from tyrefem.inputs.origin import WRITTEN, StudyOrigin
from tyrefem.output.file import results_file

QUICK = {"mesh.size": "15 mm", "mesh.element": "P1", "drive.duration": "20 s"}
#: A file that the user has edited since `tyrefem new` wrote it.
EDITED = '# made by: tyrefem new study mine\ntitle = "mine"\n'


def test_a_copied_study_does_not_replace_tables_beside_it(here: Path, refused: Callable[..., str]) -> None:
    (here / "run-1.csv").write_text("mine")
    words = ("new", "study", "second", "--from", "example-validation", "--out", "second.toml")
    assert "run-1.csv: --out: would be overwritten by that of example-validation" in refused(*words)
    assert [path.name for path in here.iterdir()] == ["run-1.csv"]
    assert (here / "run-1.csv").read_text() == "mine"
    assert main([*words, "--force"]) == 0
    assert len(tf.study("second.toml").measured) == 3
    # Equal tables are no loss, and a copy beside its source shares them.
    (here / "second.toml").unlink()
    assert main([*words]) == 0
    assert main(["new", "study", "third", "--from", "second.toml", "--out", "third.toml"]) == 0
    assert len(tf.study("third.toml").measured) == 3


def test_a_model_does_not_replace_a_study_of_its_name(here: Path, refused: Callable[..., str]) -> None:
    (here / "tyre.toml").write_text(EDITED)
    settings = [word for key, value in QUICK.items() for word in ("--set", f"{key}={value}")]
    for command, suffix in (("export", "npz"), ("explore", "html")):
        error = refused(command, "nasa-22x5.5-8pr", *settings, "--out", f"tyre.{suffix}")
        assert "tyre.toml: --out: exists and was not made by tyrefem" in error
    assert (here / "tyre.toml").read_text() == EDITED
    assert [path.name for path in here.iterdir()] == ["tyre.toml"]


def test_a_study_edited_below_its_first_lines_is_the_users(here: Path) -> None:
    study = tf.study("nasa-22x5.5-8pr", QUICK)
    origin = StudyOrigin.beside(study, Path("tyre.npz"))
    for change in (str, lambda text: text.replace("\n", "\r\n"), lambda text: text + "# mine\n"):
        (here / "tyre.toml").unlink(missing_ok=True)
        origin.write(here)
        text = change((here / "tyre.toml").read_text())
        (here / "tyre.toml").write_text(text, newline="")
        assert origin.wrote(here / "tyre.toml") == (change is str)
    with (
        pytest.raises(InputError, match=r"tyre\.toml: .*or has changed since"),
        results_file("tyre.npz", (".npz",), origin=origin),
    ):
        pass
    assert (here / "tyre.toml").read_text() == text
    assert tf.study("tyre.toml").card == study.card


def test_a_new_tyre_is_written_whole_or_not_at_all(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    study = here / "studies" / "passenger-225-45r17" / "study.toml"
    study.parent.mkdir(parents=True)
    study.symlink_to("nothing")
    assert main(["new", "tyre", "225/45R17", "--force"]) == 2
    assert "study.toml: --out: is a link to nothing" in capfd.readouterr().err
    assert not list(here.rglob("geometry/*"))


def test_a_result_from_python_does_not_replace_another_study(here: Path) -> None:
    result = tf.study("nasa-22x5.5-8pr", QUICK).run()
    (here / "study.toml").write_text(EDITED)
    with pytest.raises(InputError, match=r"would overwrite files that it did not write.* study\.toml.*force=True"):
        result.save(here)
    assert [path.name for path in here.iterdir()] == ["study.toml"]
    assert (here / "study.toml").read_text() == EDITED
    result.save("out")
    result.save("out")
    assert Path("out/study.toml").read_text().startswith(WRITTEN)
    # By its own file, it is the user's study, and stays as it is.
    text = Path("out/study.toml").read_text().replace(WRITTEN, "# mine")
    (here / "study.toml").write_text(text)
    tf.study("study.toml").run().save(here)
    assert (here / "study.toml").read_text() == text
