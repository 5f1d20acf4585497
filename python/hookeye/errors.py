"""What goes wrong, and where."""

from __future__ import annotations


class InputError(ValueError):
    """Bad input: a file with line and column (0: the whole file), or an argument (file "")."""

    def __init__(self, message: str, file: str = "", line: int = 0, column: int = 0,
                 wrong: str = "", right: str = "") -> None:
        super().__init__(message)
        self.file, self.line, self.column = file, line, column
        self.wrong, self.right = wrong or message, right

    def __reduce__(self):
        return (type(self), (str(self), self.file, self.line, self.column, self.wrong, self.right))


class UnknownName(InputError, KeyError):
    """A name that there is not, of a camera, a photo, a field: `right` says which there are."""

    __str__ = Exception.__str__  # not KeyError's, which quotes the message


class NumericalError(ArithmeticError):
    """The numbers failed: no equilibrium, no convergence."""

    def __init__(self, message: str, example: str = "", load_fraction: float = 1.0,
                 reason: str = "") -> None:
        super().__init__(message)
        self.example, self.load_fraction, self.reason = example, load_fraction, reason or message

    def __reduce__(self):
        return (type(self), (str(self), self.example, self.load_fraction, self.reason))


class Cancelled(Exception):
    """`cancel` was set. (Ctrl-C is KeyboardInterrupt.)"""


class EffectError(RuntimeError):
    """An effect written in Python went wrong: `effect`, and the `method` of it. What that threw is
    the cause (`__cause__`)."""

    def __init__(self, message: str, effect: str = "", method: str = "") -> None:
        super().__init__(message)
        self.effect, self.method = effect, method

    def __reduce__(self):
        return (type(self), (str(self), self.effect, self.method))


class SensorError(RuntimeError):
    """A sensor written in Python went wrong: `sensor`, and the `method` of it. What that threw is the
    cause (`__cause__`)."""

    def __init__(self, message: str, sensor: str = "", method: str = "") -> None:
        super().__init__(message)
        self.sensor, self.method = sensor, method

    def __reduce__(self):
        return (type(self), (str(self), self.sensor, self.method))
