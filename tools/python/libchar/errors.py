"""What the library refuses: one sentence with a code (docs/errors.md), its place, and what to do."""
from __future__ import annotations

from typing import Any

from . import _libchar


class Error(Exception):
    """What went wrong, as a sentence; `code` ("E0312"), `where` (a file with line and column, or an option), `hint`."""

    def __init__(self, message: str, code: str = "", where: str = "", hint: str = "") -> None:
        super().__init__(message)
        self.code = code
        self.where = where
        self.hint = hint

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.args[0], self.code, self.where, self.hint)


class UsageError(Error, ValueError):
    """An argument asks for something that is not possible."""


class InputError(Error, OSError):
    """An input is missing, malformed or over a limit, or an output cannot be written."""


class NumericError(Error, ArithmeticError):
    """The numbers do not allow a result."""


class CopyWarning(UserWarning):
    """An array was copied, because it is not contiguous or not of float64."""


_libchar.set_errors(UsageError, InputError, NumericError)
