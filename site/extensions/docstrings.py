"""Docstrings of tyrefem as reStructuredText.

They are plain text for an editor's window: names in single backticks, numpy's headings over lists of
``name : meaning``, formulas with stars and bars. Here the headings become definition lists, stars and bars stay signs,
and a name in backticks becomes a link where the site documents it.
"""

from __future__ import annotations

import importlib
import re
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util import logging

LOG = logging.getLogger(__name__)
HEADINGS = ("Parameters", "Raises", "Returns", "Attributes")
ITEM = re.compile(r"([\w, *]+?) ?: (.+)")
SPAN = re.compile(r"(``.+?``|`[^`]+`)")
BULLET = re.compile(r"[-*] ")


def escaped(text: str) -> str:
    """Text whose stars, bars and underscores are signs; spans in backticks stay."""
    parts = SPAN.split(text)
    parts[::2] = [re.sub(r"([\\*|_])", r"\\\1", part) for part in parts[::2]]
    return "".join(parts)


def sections(lines: list[str]) -> list[tuple[str, list[str]]]:
    """The text under every heading of numpy's kind; the text before the first has the heading ``""``."""
    parts: list[tuple[str, list[str]]] = [("", [])]
    skip = False
    for line, following in zip(lines, [*lines[1:], ""], strict=True):
        if skip:
            skip = False
        elif line in HEADINGS and following and not following.strip("-"):
            parts.append((line, []))
            skip = True
        elif parts[-1][0] and re.match(r"Raises InputError|>>> ", line):
            # Text goes on after a list without a heading of its own.
            parts.append(("", [line]))
        else:
            parts[-1][1].append(line)
    return parts


def items(lines: list[str]) -> list[str]:
    """``name : meaning`` with continuation lines, as a definition list."""
    written: list[str] = []
    for line in lines:
        item = ITEM.fullmatch(line)
        if item is not None:
            written += ["", f"``{item[1]}``", f"    {escaped(item[2])}"]
        elif line.strip():
            written.append(f"    {escaped(line.strip())}" if written else escaped(line.strip()))
    return [*written, ""]


def prose(lines: list[str]) -> list[str]:
    """Sentences, lists, formulas and doctests."""
    written: list[str] = []
    kind = "blank"
    for line in lines:
        before = kind
        if not line.strip():
            kind = "blank" if before != "formula" else "formula"
        elif line.startswith((">>>", "...")) or (before == "doctest" and line.strip()):
            kind = "doctest"
        elif BULLET.match(line) or (line.startswith("  ") and before == "bullet"):
            kind = "bullet"
        elif line.startswith("    ") and before in ("blank", "formula"):
            kind = "formula"
        else:
            kind = "text"
        if line.strip() and kind != before and before != "blank":
            written.append("")
        if kind == "formula" and before != "formula":
            written += ["::", ""]
        written.append(line if kind in ("doctest", "formula") else escaped(line))
    return written


def process(_app: Sphinx, _what: str, name: str, _object: Any, _options: Any, lines: list[str]) -> None:
    """Rewrite the docstring of an object of tyrefem in place."""
    if not name.startswith("tyrefem"):
        return
    written: list[str] = []
    for heading, body in sections(lines):
        if heading:
            written += ["", f".. rubric:: {heading}", "", *items(body)]
        else:
            written += prose(body)
    lines[:] = written


def exists(name: str) -> bool:
    """Can ``tyrefem.room.module.Class.member`` be imported?"""
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        try:
            value: Any = importlib.import_module(".".join(parts[:count]))
        except ImportError:
            continue
        for part in parts[count:]:
            if not hasattr(value, part) and part not in getattr(value, "__annotations__", {}):
                return False
            value = getattr(value, part, None)
        return True
    return False


def unlisted(_app: Sphinx, _env: Any, node: Any, shown: nodes.Element) -> nodes.Element | None:
    """Names that the site does not document stay text; a full name of tyrefem that does not exist is a warning."""
    if node.get("refdomain") != "py":
        return None
    target = node["reftarget"].rstrip("()")
    if target.startswith("tyrefem.") and not exists(target):
        LOG.warning("there is no %s", target, location=node)
    return shown


def setup(app: Sphinx) -> dict[str, Any]:
    """Register both steps."""
    app.connect("autodoc-process-docstring", process)
    app.connect("missing-reference", unlisted)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
