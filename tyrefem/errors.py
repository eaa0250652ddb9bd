"""Errors that a user can correct: one sentence with the file, the field and the allowed values."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from tyrefem.interruption import Interrupted as Interrupted


class ResultWarning(UserWarning):
    """A result that may be in doubt; the message says where."""


class PluginWarning(UserWarning):
    """A file, package or class of a user that cannot be used, and is left out; the message says where and why."""


class InputError(ValueError):
    """Bad input from a person: a file, a field, a unit, a number outside its range.

    Parameters
    ----------
    message : what is wrong and what is allowed; line breaks, as of a table in it, become spaces.
    field : dotted name of the field, e.g. ``drive.speed``.
    file : the file with the input.

    >>> print(InputError("must be positive", field="drive.speed", file="study.toml"))
    study.toml: drive.speed: must be positive
    >>> print(InputError("must be a number, not [[1 2]\\n [3 4]]", field="slip"))
    slip: must be a number, not [[1 2] [3 4]]
    >>> MissingLibraryError("needs gmsh").within(field="mesh.mesher")
    MissingLibraryError('mesh.mesher: needs gmsh')
    """

    def __init__(self, message: str, *, field: str | None = None, file: str | Path | None = None) -> None:
        self.message, self.field, self.file = _in_one_line(message), field, file
        super().__init__(": ".join(str(part) for part in (file, field, self.message) if part))

    def within(self, *, field: str | None = None, file: str | Path | None = None) -> InputError:
        """The same error, of the same type, with the names of an enclosing field and file."""
        joined = ".".join(part for part in (field, self.field) if part)
        return self._at(joined or None, self.file or file)

    def without_file(self, file: str | Path) -> InputError:
        """The same error, of the same type, without this file; an error of another file stays as it is."""
        return self._at(self.field, None) if self.file is not None and Path(self.file) == Path(file) else self

    def _at(self, field: str | None, file: str | Path | None) -> InputError:
        placed = type(self).__new__(type(self))
        placed.__setstate__(vars(self))
        InputError.__init__(placed, self.message, field=field, file=file)
        return placed


def _in_one_line(text: str) -> str:
    return " ".join(text.split()) if "\n" in text else text


class OutputError(InputError):
    """A file that cannot be written, as on a full disk: no fault of a study, whatever was tried with it."""


@dataclass(frozen=True)
class InputWarning:
    """Input that is allowed, but is probably a mistake. ``field`` and ``file`` as in `InputError`.

    >>> print(InputWarning("is unlikely", "density.value").within(field="materials.tread", file="study.toml"))
    study.toml: materials.tread.density.value: is unlikely
    """

    message: str
    field: str | None = None
    file: str | Path | None = None

    def within(self, *, field: str | None = None, file: str | Path | None = None) -> InputWarning:
        """The same warning, with the names of an enclosing field and file."""
        joined = ".".join(part for part in (field, self.field) if part)
        return replace(self, field=joined or None, file=self.file or file)

    def __str__(self) -> str:
        return ": ".join(str(part) for part in (self.file, self.field, self.message) if part)


class MissingLibraryError(InputError):
    """A feature needs a library that is not installed or cannot be loaded."""


def quoted(words: Iterable[str], allowed: Iterable[str]) -> str:
    """Unknown words in quotes, each with the closest allowed word.

    >>> quoted(["crwn", "x9"], ["crown", "bead"])
    "'crwn' (did you mean 'crown'?), 'x9'"
    """
    names = sorted(map(str, allowed))
    close = {word: _closest(word, names) for word in words}
    return ", ".join(f"'{word}'" + (f" (did you mean '{match}'?)" if match else "") for word, match in close.items())


def nearest(word: str, allowed: Iterable[str]) -> str:
    """`"; did you mean 'x'?"` for the closest allowed word, or the list of allowed words.

    >>> nearest("carcas", ["carcass", "tread"])
    "; did you mean 'carcass'? Allowed: carcass, tread"
    """
    names = sorted(map(str, allowed))
    close = _closest(str(word), names)
    hint = f"; did you mean '{close}'?" if close else ";"
    listing = ", ".join(names[:20]) + (", ..." if len(names) > 20 else "")
    return f"{hint} Allowed: {listing}" if close else f"; allowed: {listing}"


def _closest(word: str, names: Sequence[str]) -> str | None:
    """The closest of the names, if any is close; capital letters count only among several."""
    as_written = difflib.get_close_matches(word, names, n=1, cutoff=0.5)
    small = {name.casefold(): name for name in reversed(names)}
    in_small = difflib.get_close_matches(word.casefold(), small, n=1, cutoff=0.5)
    return as_written[0] if as_written else small[in_small[0]] if in_small else None
