"""Effects in Python: a class derived from Effect is tested, fitted and reported as those built in."""

from __future__ import annotations

from typing import Any, Dict, List, Union

import numpy as np


class Setup:
    """The capture that an effect is asked about.

    `points` (n, 3) and `elements` (m, 4 or 10) of the body at rest, its `size` and `centre`;
    `shear_modulus` of the model at rest; names of `length`, `force` and `stress`; names of
    `regions`, `examples` and `cameras`.
    """

    def __init__(self, told: Dict[str, Any]) -> None:
        self.points: np.ndarray = told["points"]
        self.elements: np.ndarray = told["elements"]
        self.size: float = told["size"]
        self.centre: np.ndarray = told["centre"]
        self.shear_modulus: float = told["shear_modulus"]
        self.length: str = told["length"]
        self.force: str = told["force"]
        self.stress: str = told["stress"]
        self.regions: List[str] = told["regions"]
        self.examples: List[str] = told["examples"]
        self.cameras: List[str] = told["cameras"]


class Effect:
    """Base of effects in Python. What a class may say:

    `name` (default: the class's, in small letters), `title`, `group`, the docstring (what it is and
    what it is taken for), `parameters`: {name: {unit, null, typical, low, high, words}}.

    And what it does, by methods that take all parameters by their names:

    - energy(F, k): energy per rest volume (n,) of deformation gradients (n, 3, 3) [stress];
      stress(F, k): its derivative (n, 3, 3); stiffness(F, k): the second, (n, 3, 3, 3, 3). What is
      not given is worked out by complex steps: then F is complex.
    - energy_of_invariants(I1, I2, J, k): the same of I1bar, I2bar and det F. It is faster.
    - where(X, setup): the share in which the energy acts, 0 to 1, at element centres (m, 3).
    - body_force(X, k) or body_force(X, x, k): force per rest volume (n, 3) at points that rest at X
      and are at x; traction(X, k), (X, x, k) or (X, x, N, k): per rest area of `region` (default:
      the whole surface), whose normal is N. share(example, order): of it in a load case.
    - photo(example, camera, order, k): changes of a photo, a dict of rotate, move (camera axes),
      zoom, log_gain, ambient, sun, specular, blur (variance, px^2), background.
    - sentence(k): what it says in words.
    - applies(setup): "" or why it does not apply to a capture.

    `parameters` may be a method parameters(setup), where sizes depend on the capture.
    """

    name: str = ""
    title: str = ""
    group: str = ""
    region: str = ""
    parameters: Any = {}

    def applies(self, setup: Setup) -> str:
        return ""

    def share(self, example: str, order: int) -> float:
        return 1.0


EffectLike = Union[str, type, Effect]
