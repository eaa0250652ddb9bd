"""Random damage to a text file, as typing errors and broken exports do it: nothing may end in a traceback."""

from __future__ import annotations

import re

from hypothesis import strategies as st

#: What may stand where a value, a word or a number was.
JUNK = (
    "", "0", "-1", "1e308", "1e-308", "-1e999", "nan", "inf", "true", "[]", "[1, 2]", "{}", "{ base = 3 }",
    '""', '"nan"', '"1e400 m"', '"0 m"', '"-5 mm"', '"1e9 m"', '"5 furlong"', '"20 %"', '"12 degC"', '"1 K"',
    '"0 s"', '"-300 degC"', '"../../nothing"', '"~nobody/x.toml"', '"a\\u0000b"', '"nasa-tread"', "1979-05-27",
    "07:32:00", "0x10", "'''", '"""', "1_000", "99999999999999999999999", '"' + "m" * 300 + '"', "é", "\x00",
    "\ufeff", "#", "=", "[[", "]]", ".", ",", ";",
)  # fmt: skip
_VALUE = re.compile(r"(?<==)[^\n#]+")
_NUMBER = re.compile(r"\d+(?:\.\d+)?")
_WORD = re.compile(r"[A-Za-z_][\w-]*")
_CELL = re.compile(r"[^,\n]+")


def _replace_one(draw: st.DrawFn, text: str, pattern: re.Pattern[str]) -> str:
    places = list(pattern.finditer(text))
    if not places:
        return text
    place = draw(st.sampled_from(places))
    return text[: place.start()] + draw(st.sampled_from(JUNK)) + text[place.end() :]


def _lines(draw: st.DrawFn, text: str) -> str:
    lines = text.split("\n")
    i, j = (draw(st.integers(0, len(lines) - 1)) for _ in range(2))
    match draw(st.sampled_from(("drop", "double", "swap", "move"))):
        case "drop":
            lines.pop(i)
        case "double":
            lines.insert(j, lines[i])
        case "swap":
            lines[i], lines[j] = lines[j], lines[i]
        case "move":
            lines.insert(j, lines.pop(i))
    return "\n".join(lines)


@st.composite
def damaged(draw: st.DrawFn, text: str) -> str:
    """The text with one to three injuries."""
    for _ in range(draw(st.integers(1, 3))):
        match draw(st.sampled_from(("value", "value", "number", "word", "cell", "line", "cut", "character"))):
            case "value":
                text = _replace_one(draw, text, _VALUE)
            case "number":
                text = _replace_one(draw, text, _NUMBER)
            case "word":
                text = _replace_one(draw, text, _WORD)
            case "cell":
                text = _replace_one(draw, text, _CELL)
            case "line":
                text = _lines(draw, text)
            case "cut":
                text = text[: draw(st.integers(0, len(text)))]
            case "character":
                place = draw(st.integers(0, len(text)))
                text = text[:place] + draw(st.characters(codec="utf-8")) + text[place:]
    return text
