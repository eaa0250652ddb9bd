"""Is an answer in JSON one object with the keys that tyrefem/schemas documents for its command?"""

from __future__ import annotations

import json

from jsonschema import Draft7Validator
from jsonschema.exceptions import best_match

from tyrefem.schemas.answer_schema import answer_of, answers_schema, unknown_keys

SCHEMA = answers_schema()


def checked(command: str, text: str) -> None:
    """The text is one JSON object, with the keys of the command."""
    data = json.loads(text)
    assert isinstance(data, dict)
    names = answer_of(command)
    assert names, f"'{command}': its keys are missing in tyrefem/schemas/answers.py"
    problems = [best_match(Draft7Validator({**SCHEMA, "anyOf": [{"$ref": f"#/definitions/{name}"}]}).iter_errors(data))
                for name in names]  # fmt: skip
    assert None in problems, [problem.message for problem in problems if problem]
    definition = names[problems.index(None)]
    without_words = sorted(set(unknown_keys(data, SCHEMA["definitions"][definition])))
    assert without_words == [], f"{definition}: keys without words in tyrefem/schemas"
