"""What a key of a card means, from the docstring of its class and the comments above its fields."""

from __future__ import annotations

import functools
import inspect
import itertools
import re
from collections.abc import Iterator

from tyrefem.cards import Card

#: "``a``, ``b``: words" or "``a`` is ...", at the start of a sentence.
_NAMED = re.compile(r"(?:^|(?<=[.;:] ))((?:``\w+``(?:, | and |, and )?)+)(?=[:, ]|$)")
#: "a : words. b, c : words." of a section Parameters.
_LISTED = re.compile(r"(?:^|(?<=\. ))(\w+(?:, \w+)*) : ")
_PARTS = ("Parameters", "Attributes", "Raises", "Returns", "Notes")


@functools.lru_cache(maxsize=512)
def field_words(card: type[Card]) -> dict[str, str]:
    """Field -> what it means; fields of which nothing is written are missing.

    >>> from tyrefem.inputs.study_card import Sensor
    >>> field_words(Sensor)["lag"]
    'First-order time constant.'
    """
    words: dict[str, str] = {}
    for base in reversed(card.__mro__):
        if issubclass(base, Card) and base is not Card:
            words |= _in_docstring(base.__doc__ or "") | _above_fields(base)
    return {name: text for name, text in words.items() if name in card.model_fields}


def summary(card: type[Card]) -> str:
    """The paragraphs of a class's docstring, without parameters and examples."""
    kept = []
    for paragraph in inspect.cleandoc(card.__doc__ or "").split("\n\n"):
        if paragraph.startswith((">>>", *(f"{part}\n---" for part in _PARTS))):
            break
        kept.append(_plain(" ".join(paragraph.split())))
    return "\n\n".join(kept)


def _plain(text: str) -> str:
    return text.replace("``", "`")


def _in_docstring(docstring: str) -> dict[str, str]:
    words: dict[str, str] = {}
    listed = False
    for paragraph in inspect.cleandoc(docstring).split("\n\n"):
        lines = paragraph.splitlines()
        if len(lines) > 1 and set(lines[1].strip()) == {"-"}:
            listed = lines[0].strip() in ("Parameters", "Attributes")
            text = " ".join(" ".join(lines[2:]).split())
        else:
            text = " ".join(paragraph.split())
        if text.startswith(">>>"):
            break
        words |= _listed(text) if listed else _mentioned(text)
    return words


def _listed(text: str) -> dict[str, str]:
    places = [*_LISTED.finditer(text)]
    words = {}
    for place, after in _stretches(places, text):
        for name in place[1].split(", "):
            words[name] = _sentence(text[place.end() : after])
    return words


def _mentioned(text: str) -> dict[str, str]:
    places = [*_NAMED.finditer(text)]
    words: dict[str, str] = {}
    for place, after in _stretches(places, text):
        # Without the beginning of a list that names the next ones: "Standard deviations:".
        rest = re.sub(r"(?<=\.) [A-Z][^.]*:$", "", text[place.end() : after].rstrip())
        named = rest[1:] if rest.startswith(":") else f"{place[1]}{rest}"
        for name in re.findall(r"``(\w+)``", place[1]):
            words.setdefault(name, _sentence(named))
    for sentence in re.split(r"(?<=\.) ", text):
        for name in re.findall(r"``(\w+)``", sentence):
            words.setdefault(name, _sentence(sentence))
    return words


def _stretches(places: list[re.Match[str]], text: str) -> Iterator[tuple[re.Match[str], int]]:
    """Every match, with the start of the next."""
    for place, following in itertools.zip_longest(places, places[1:]):
        yield place, following.start() if following else len(text)


@functools.lru_cache(maxsize=512)
def _above_fields(card: type[Card]) -> dict[str, str]:
    """Comments ``#: words`` above fields."""
    try:
        lines = inspect.getsource(card).splitlines()
    except OSError:
        return {}
    words, comment = {}, ""
    for line in lines:
        text = line.strip()
        if text.startswith("#:"):
            comment = f"{comment} {text[2:].strip()}".strip()
            continue
        field = re.match(r"(\w+): ", text)
        if field and comment:
            words[field[1]] = _sentence(comment)
        comment = ""
    return words


def _sentence(text: str) -> str:
    text = _plain(text.strip().rstrip(";, "))
    text = text[:1].upper() + text[1:]
    return text if text.endswith((".", "?", "!")) else f"{text}."
