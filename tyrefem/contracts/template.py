"""Templates of plugins: short files that work, to be edited."""

from __future__ import annotations

import ast
import keyword
import re
import tempfile
from pathlib import Path

from tyrefem.errors import InputError
from tyrefem.plugins.kind import is_ours, kind_of
from tyrefem.plugins.loading import load_file

#: Kinds of templates, as `tyrefem new` takes them: kind -> the name of its example.
TEMPLATES = {
    "effect": "lamp",
    "boundary-law": "power-film",
    "tan-delta-law": "arrhenius",
    "strain-law": "crown-to-bead",
    "friction-law": "falling",
    "sweep-answer": "highest",
}
_ALLOWED = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


def template(kind: str, name: str) -> str:
    """The text of a plugin's file of a kind, with a name.

    Raises
    ------
    InputError : a name that is not of small letters, digits and single hyphens, or whose class would be a word of
        Python, such as none, or a class that the template imports, such as zone.

    >>> "class HotWind(OutsideAirLaw):" in template("boundary-law", "hot-wind")
    True
    """
    if not _ALLOWED.fullmatch(name) or keyword.iskeyword(class_name(name)):
        raise InputError(f"'{name}' is not allowed as a plugin's name; allowed: small letters, digits, -, as hot-wind")
    text = (Path(__file__).parent / "templates" / f"{kind}.txt").read_text(encoding="utf-8")
    if class_name(name) in _imported(text):
        words = f"its class would hide {class_name(name)}, which the template imports: choose another name"
        raise InputError(f"'{name}' is not allowed as the name of this {kind.replace('-', ' ')}: {words}")
    return re.sub("CLASS|NAME", lambda place: {"CLASS": class_name(name), "NAME": name}[place[0]], text)


def _imported(text: str) -> set[str]:
    """The names that a Python file imports.

    >>> _imported("from typing import Any") == {"Any"}
    True
    """
    imports = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Import | ast.ImportFrom)]
    return {alias.asname or alias.name for node in imports for alias in node.names}


def check_free(kind: str, name: str) -> None:
    """Refuse a name that a shipped plugin of the kind has: its class would be left out.

    Raises
    ------
    InputError : the name is taken, or is not allowed.

    >>> check_free("effect", "hot-wind")
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / file_name(name)
        file.write_text(template(kind, name), encoding="utf-8")
        classes = load_file(file).classes
    for cls in classes:
        its_kind = kind_of(cls)
        if its_kind is None or is_ours(cls):
            continue
        if its_kind.name_of(cls) in its_kind.shipped():
            raise InputError(f"'{name}' is the name of a shipped {its_kind.name}: choose another")
        words = its_kind.complaint(cls)
        if words:
            raise InputError(f"'{name}' {words}")


def class_name(name: str) -> str:
    """The class of a plugin's name.

    >>> class_name("hot-wind")
    'HotWind'
    """
    return "".join(part.capitalize() for part in name.split("-"))


def file_name(name: str) -> str:
    """The file of a plugin's name: ``hot_wind.py``."""
    return f"{name.replace('-', '_')}.py"
