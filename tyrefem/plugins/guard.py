"""Errors inside a plugin's methods name the plugin: file, class, method and line, instead of a traceback."""

from __future__ import annotations

import functools
import inspect
import math
import traceback
from collections.abc import Callable
from typing import Any

import numpy as np

from tyrefem.cache import read_only
from tyrefem.errors import InputError
from tyrefem.plugins.origin import Origin
from tyrefem.plugins.signature import contract_methods

_MARK = "_names_its_plugin"
#: Return annotations of this package's methods that give a number; with True None is allowed too.
_NUMBERS = {"float": False, "float | None": True}


class WrongValueError(InputError):
    """A method gives no finite number where this package's gives one. ``value``: what it gives."""

    value: Any = None


def guard(cls: type, origin: Origin) -> None:
    """Let the methods of a user's class that this package calls name themselves where they fail."""
    for part, name, attribute, base in list(contract_methods(cls)):
        place = f"class {part.__name__}, {name}"
        numbers = getattr(base.fget if isinstance(base, property) else base, "__annotations__", {}).get("return")
        if isinstance(attribute, classmethod) and not hasattr(attribute.__func__, _MARK):
            setattr(part, name, classmethod(guarded(attribute.__func__, place, origin)))
        elif isinstance(attribute, staticmethod) and not hasattr(attribute.__func__, _MARK):
            setattr(part, name, staticmethod(guarded(attribute.__func__, place, origin)))
        elif isinstance(attribute, property) and attribute.fget and not hasattr(attribute.fget, _MARK):
            checked = _with_number(attribute.fget, numbers, place, origin)
            setattr(part, name, property(guarded(checked, place, origin), doc=attribute.__doc__))
        elif inspect.isfunction(attribute) and not hasattr(attribute, _MARK):
            setattr(part, name, guarded(_with_number(attribute, numbers, place, origin), place, origin))


def guarded(function: Callable[..., Any], place: str, origin: Origin, file: str = "") -> Callable[..., Any]:
    """A function whose errors become an `InputError` with the plugin's file, the place, and the line.

    Arrays that it is given are read-only: they belong to the solver, and other effects are given the same ones.

    ``file``: the Python file whose line is named; default: that of the function.

    >>> def film(speed): return 1 / speed
    >>> guarded(film, "class Gust, film", Origin(entry="x", package="winds"))(0)
    Traceback (most recent call last):
    ...
    tyrefem.errors.InputError: package winds (x): class Gust, film: ZeroDivisionError: division by zero (line ...)
    """

    @functools.wraps(function)
    def call(*args: Any, **named: Any) -> Any:
        try:
            return function(*(read_only(each) if isinstance(each, np.ndarray) else each for each in args), **named)
        except (InputError, MemoryError):
            raise
        except (Exception, SystemExit) as error:
            words = failure_words(error, file or _file_of(function))
            raise plugin_error(origin, place, words) from error

    setattr(call, _MARK, True)
    return call


def _file_of(function: Callable[..., Any]) -> str:
    """The file with the lines of a function, also of one that a decorator of another file wraps."""
    return str(getattr(inspect.unwrap(function), "__code__", function.__code__).co_filename)


def _with_number(function: Callable[..., Any], numbers: str | None, place: str, origin: Origin) -> Callable[..., Any]:
    """A function that must give a finite number, where ``numbers``, an annotation, says so; else as it is."""
    if numbers not in _NUMBERS:
        return function
    allows_none = _NUMBERS[numbers]

    @functools.wraps(function)
    def checked(*args: Any, **named: Any) -> Any:
        value = function(*args, **named)
        if isinstance(value, float) and math.isfinite(value):
            return value
        if value is None and allows_none:
            return value
        if np.ndim(value) == 0 and np.asarray(value).dtype.kind in "fiub" and np.isfinite(value):
            return value
        error = plugin_error(origin, place, f"must give a finite number, not {value!r:.60}")
        wrong = WrongValueError(error.message, file=error.file)
        wrong.value = value
        raise wrong

    return checked


def failure_words(error: BaseException, file: str) -> str:
    """An exception in a line: its class and message, and the last line of ``file`` that it passed."""
    if isinstance(error, SyntaxError) and error.lineno:
        other = "" if error.filename == file else f" of {error.filename}"  # of a module that it imports
        return f"line {error.lineno}{other}: {type(error).__name__}: {error.msg}"
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == file]
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text}" + (f" (line {lines[-1]})" if lines else "")


def plugin_error(origin: Origin, place: str, words: str) -> InputError:
    """An error of a plugin: its file or package, the class, and what is wrong."""
    text = ": ".join(filter(None, (place, words)))
    if origin.file is not None:
        return InputError(text, file=origin.file)
    return InputError(f"{origin.words}: {text}")
