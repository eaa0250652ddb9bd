"""What was scaled, kept and dropped, in sentences for the file and the screen."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass, field

#: Longest line of a comment.
WIDTH = 118


@dataclass
class Notes:
    """Sentences in order; each begins with its word.

    >>> notes = Notes()
    >>> notes.drop("published ranges of the first tyre")
    >>> notes.lines
    ['# dropped: published ranges of the first tyre']
    """

    sentences: list[str] = field(default_factory=list)

    def scale(self, words: str) -> None:
        """Something was scaled."""
        self.sentences.append(f"scaled: {words}")

    def keep(self, words: str) -> None:
        """Something stays as it was."""
        self.sentences.append(f"kept: {words}")

    def drop(self, words: str) -> None:
        """Something belonged to the first tyre."""
        self.sentences.append(f"dropped: {words}")

    @property
    def lines(self) -> list[str]:
        """The sentences as comments of a file."""
        rows = []
        for sentence in self.sentences:
            first, *rest = textwrap.wrap(sentence, WIDTH) or [""]
            rows += [f"# {first}", *(f"#   {row}" for row in rest)]
        return rows
