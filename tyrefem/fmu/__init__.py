"""A real-time model as an FMU (FMI 2.0, co-simulation): C source, compiled where a compiler is at hand.

Whoever imports it needs neither Python nor numpy. `tyrefem.fmu.write_fmu` makes it from the file of `tyrefem export`.
"""

from __future__ import annotations

import hashlib
import json
import platform
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from tyrefem.errors import InputError
from tyrefem.fmu.description import IDENTIFIER, description
from tyrefem.fmu.source import data_header
from tyrefem.output import atomic_path
from tyrefem.realtime import RealTimeTyre
from tyrefem.results_file import MARK

#: Compilers looked for, in this order.
COMPILERS = ("cc", "gcc", "clang")
_SYSTEMS = {"linux": ("linux", ".so"), "darwin": ("darwin", ".dylib"), "win32": ("win", ".dll")}


def write_fmu(model: str | Path, path: str | Path, *, compiler: str | None = None) -> Path:
    """Write an FMU of a real-time model.

    Parameters
    ----------
    model : ``.npz`` file of `tyrefem export`. path : ``.fmu`` file. compiler : a C compiler; without, the first of
        `COMPILERS` that is found. With none the FMU holds its source only, which the importing tool compiles.

    Raises
    ------
    InputError : not a real-time model, or the compiler failed.
    """
    try:
        tyre = RealTimeTyre(model)
    except (ValueError, OSError) as error:
        raise InputError(str(error)) from None
    path = Path(path)
    guid = hashlib.sha256(Path(model).read_bytes()).hexdigest()[:32]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sources = folder / "sources"
        sources.mkdir()
        shutil.copy(Path(__file__).with_name("tyre.c"), sources / "tyre.c")
        (sources / "tyre_data.h").write_text(data_header(tyre, guid), encoding="ascii")
        (folder / "modelDescription.xml").write_text(description(tyre, guid), encoding="utf-8")
        (folder / "resources").mkdir()
        (folder / "resources" / "about.json").write_text(json.dumps(tyre.about, indent=1), encoding="utf-8")
        compiler = compiler or next((one for one in COMPILERS if shutil.which(one)), None)
        if compiler is not None:
            _compiled(compiler, folder)
        with atomic_path(path) as temporary, zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as packed:
            for file in sorted(folder.rglob("*")):
                if file.is_file():
                    packed.write(file, file.relative_to(folder).as_posix())
            packed.comment = MARK
    return path


def _compiled(compiler: str, folder: Path) -> None:
    system, suffix = _SYSTEMS.get(sys.platform, ("linux", ".so"))
    place = folder / "binaries" / f"{system}{64 if sys.maxsize > 2**32 else 32}"
    if platform.machine().lower() not in ("x86_64", "amd64", "i386", "i686"):
        # FMI 2.0 knows these folders for x86 only: elsewhere the importing tool compiles.
        return
    place.mkdir(parents=True)
    command = [compiler, "-std=c99", "-O3", "-shared", "-fPIC", "-fvisibility=hidden", "-o"]
    command += [str(place / f"{IDENTIFIER}{suffix}"), str(folder / "sources" / "tyre.c"), "-lm"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise InputError(f"'{compiler}' cannot be run: {error.strerror or error}") from None
    if done.returncode:
        raise InputError(f"'{compiler}' failed: {done.stderr.strip()[-300:]}")
