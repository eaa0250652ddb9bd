"""The folder of schemas, written or compared."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

from tyrefem.schemas.answer_schema import answers_schema
from tyrefem.schemas.files import FILES
from tyrefem.schemas.line import settings_text


def texts() -> dict[str, str]:
    """File name -> text of every schema."""
    made = {f"{kind}.json": schema() for kind, (_, schema) in FILES.items()} | {"answers.json": answers_schema()}
    return {name: json.dumps(schema, indent=1, ensure_ascii=False) + "\n" for name, schema in made.items()}


def are_settings(text: str) -> bool:
    """Whether a text is that of `settings` for some folder, without changes by a person.

    >>> are_settings(settings("schemas")), are_settings(settings("my/schemas") + "[formatting]\\n")
    (True, False)
    """
    try:
        path = tomllib.loads(text)["rule"][0]["schema"]["path"]
        return text == settings(str(path).rpartition("/")[0])
    except (tomllib.TOMLDecodeError, LookupError, TypeError):
        return False


def settings(folder: str) -> str:
    """The editor's settings; ``folder`` holds the schemas, relative to the settings."""
    return settings_text({kind: patterns for kind, (patterns, _) in FILES.items()}, Path(folder).as_posix())
