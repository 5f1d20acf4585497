"""Sensors in Python: a class derived from Sensor predicts what a capture has measured."""

from __future__ import annotations

from typing import Any, Sequence, Union


class Sensor:
    """Base of sensors in Python. What a class may say:

    `name` (default: the class's, in small letters), which a capture names by
    `measured: - {sensor: NAME, value, sigma}`; `unit` of its numbers; and where it looks, one of

    - `region`: a region's nodes; `regions`: those of several,
    - `points`: places on the body as it was given, (n, 3).

    And what it sees:

    - predict(x, u): a number, or several in an array, of the positions x (n, 3) and the displacements
      u (n, 3) of its points, in the frame that cameras stand in. Of `regions` both are dicts by name.
      It may take `example`, the load case's name, too. The same points always give the same numbers.
    - derivative(x, u, dx, du): how predict() changes where x and u change by dx and du, to first
      order; may be left out. Then it is worked out by a complex step: predict() is called with complex
      arrays, so write no abs, no float and no branch on a value. `differences = True` takes central
      differences instead, for what cannot be written so.
    """

    name: str = ""
    unit: str = ""
    region: str = ""
    regions: Sequence[str] = ()
    points: Any = ()
    differences: bool = False

    def predict(self, x: Any, u: Any) -> Any:
        raise NotImplementedError("predict(x, u)")


SensorLike = Union[str, type, Sensor]
