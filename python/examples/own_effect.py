"""Two effects in Python, tested beside those of the catalogue: springs on the surface, and a skin.

python3 own_effect.py CAPTURE RUN
"""

import sys

import numpy as np

import hookeye as he


class Spring(he.Effect):
    """The surface stands in a bed of springs, which pull it back to where it rests: a foam around the
    body, a membrane. Easily taken for a stiffer material."""

    title = "a bed of springs"

    def parameters(self, setup):
        size = 0.01 * setup.shear_modulus / setup.size
        return {"k": {"unit": f"{setup.stress}/{setup.length}", "typical": size, "low": 0.0,
                      "words": "stiffness of the springs by rest area"}}

    def traction(self, X, x, k):
        return k * (X - x)

    def sentence(self, k):
        return f"the surface stands in a bed of springs of {k:.3g}"


class StiffSkin(he.Effect):
    """The outer layer stiffens with strain more than the core: a skin that was cast first, or dried.
    Easily taken for strain stiffening of the whole body."""

    title = "a skin that stiffens"

    def parameters(self, setup):
        return {"c": {"unit": setup.stress, "typical": 0.5 * setup.shear_modulus, "low": 0.0,
                      "words": "modulus of (I1bar - 3)^2 in the skin"}}

    def energy_of_invariants(self, I1, I2, J, c):
        return c * (I1 - 3) ** 2

    def where(self, X, setup):
        return np.linalg.norm(X - setup.centre, axis=1) > 0.25 * setup.size


capture = he.Capture(sys.argv[1])
for effect in Spring, StiffSkin:
    print(he.check_effect(effect, capture).to_string(index=False))

run = he.fit(capture, out=sys.argv[2])
diagnosis = run.diagnose(effects=[Spring, StiffSkin])
print(diagnosis.table[["effect", "evidence", "explains", "named"]].to_string(index=False))
print(diagnosis.verdict)

step = run.add(Spring)
print(step, step.parameters)
