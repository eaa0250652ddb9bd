"""The page of an exploration: one self-contained HTML file whose numerics run in the browser."""

from __future__ import annotations

import html
import json
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.brief import counted
from tyrefem.output import atomic_path
from tyrefem.reports.explore_data import page_data

if TYPE_CHECKING:
    from tyrefem.realtime.box_model import BoxModel

#: Scripts of the page, in their order.
SCRIPTS = ("explore_model.js", "explore_picture.js", "explore_charts.js", "explore_view.js")


def resource(name: str) -> str:
    """Text of a file beside this module."""
    return files("tyrefem.reports").joinpath(name).read_text(encoding="utf-8")


def page(model: BoxModel) -> str:
    """The page as text."""
    from jinja2 import Environment, StrictUndefined
    from markupsafe import Markup

    data = page_data(model)
    # "</" would end the script element, "<!--" with "<script" would hide its end.
    text = json.dumps(data, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    return environment.from_string(resource("explore.html")).render(
        title=data["title"],
        name=data["name"],
        style=Markup(resource("explore.css")),
        data=Markup(text),
        scripts=Markup("\n".join(resource(name) for name in SCRIPTS)),
        versions=data["versions"],
        certificate=data["certificate"],
        left_out=data["measured"]["left_out"],
    )


def write_page(model: BoxModel, path: str | Path) -> Path:
    """Write the page; a failure leaves no partial file.

    Raises
    ------
    InputError : the file cannot be written.
    """
    path = Path(path)
    text = page(model)
    with atomic_path(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return path


def framed(text: str, height: int = 1500) -> str:
    """A page within a notebook's cell."""
    return (
        f'<iframe srcdoc="{html.escape(text, quote=True)}" title="exploration" style="width: 100%; height: {height}px; '
        'border: 0" sandbox="allow-scripts allow-same-origin"></iframe>'
    )


def described(model: BoxModel) -> list[str]:
    """Lines on a model: its numbers and its certificate."""
    certificate, numbers = model.certificate, model.plan.varied
    worst: dict[str, Any] = {
        name: error
        for name, error in certificate.errors.items()
        if name in model.about["read"] or name in ("contained-air", "hottest")
    }
    errors = ", ".join(f"{name} {error:.2g}" for name, error in worst.items())
    return [
        f"{counted(len(numbers), 'number')}, {model.reduced.size} modes; "
        f"trained on {certificate.trained_on} runs and corrections",
        f"certified on {certificate.cases} fresh full runs, inside the box and at its corners: largest error "
        f"{certificate.worst:.2g} K anywhere at any time (allowed {certificate.tolerance:g} K)",
        f"  by output, K: {errors}",
    ]
