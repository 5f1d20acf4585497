"""What a capture hides, in the forms that CalculiX and Blender have.

HIDDEN[name](case, values) appends to `case.physics` (functions of problem, example, order) or to `case.optics` (of
photo, example, order, camera), and returns what the truth file tells. `values` has places in the part's frame and
`strength`, which make.py sets so that the pictures move by what was drawn. EFFECTS: the right names of hookeye's catalogue.
"""

import numpy as np

from body import rotation, unit

HIDDEN = {}
EFFECTS = {}
LINEAR = {"gravity", "swelling", "soft_clamp", "direction", "camera", "ball", "halves"}  # can be sized by a linear solve


def hides(name, *effects):
    def register(function):
        HIDDEN[name] = function
        EFFECTS[name] = list(effects)
        return function
    return register


@hides("nothing")
def nothing(case, values):
    return {}


def stiffer(case, inside, values):
    factor = 1 + values["strength"]

    def change(problem, example, order):
        problem.stiffness = np.where(inside, factor, 1.0)
    case.physics.append(change)
    return {**values, "factor": factor, "elements": int(inside.sum()), "of": len(inside)}


@hides("ball", "stiffness_field")
def ball(case, values):
    """In a sheet two discs."""
    inside = np.zeros(len(case.body.tets), bool)
    for centre in values["centres"]:
        inside |= np.linalg.norm(case.body.centres() - case.place(centre), axis=1) < values["radius"]
    return {**stiffer(case, inside, values), "centres_in_world": [case.place(c) for c in values["centres"]]}


@hides("halves", "stiffness_field")
def halves(case, values):
    along = case.direction(unit(values["along"]))
    place = case.body.centres() @ along
    return stiffer(case, place > place.min() + values["at"] * np.ptp(place), values)


@hides("gravity", "gravity")
def gravity(case, values):
    """At its true size: make.py makes the body softer or stiffer."""
    g = 9810 * unit(values["toward"])

    def change(problem, example, order):
        problem.forces = problem.forces + 1.07e-9 * case.body.volumes()[:, None] * g
    case.physics.append(change)
    return {"g": g, "density": 1.07e-9}


@hides("swelling", "swelling")
def swelling(case, values):
    def change(problem, example, order):
        problem.growth = np.full(len(case.body.nodes), values["strength"])
    case.physics.append(change)
    return {"strain": values["strength"]}


@hides("soft_clamp", "soft_clamp")
def soft_clamp(case, values):
    """Springs alike in all directions instead of what is held."""
    shares = case.body.areas(case.regions["base"][2])
    stiffness = 1 / values["strength"]

    def change(problem, example, order):
        for node in np.unique(case.regions["base"][2]):
            problem.fixed.pop(node, None)
            if shares[node] > 0:
                problem.springs[node] = (stiffness * shares[node],) * 2
    case.physics.append(change)
    return {"mm_per_MPa": values["strength"]}


@hides("direction", "load_direction")
def direction(case, values):
    name = values["example"]
    force = np.array(case.examples[name]["forces"]["end"])
    axis = unit(np.cross(force, values["toward"]))
    turn = rotation(axis, values["strength"])

    def change(problem, example, order):
        if example == name:
            problem.forces = problem.forces @ turn.T
    case.physics.append(change)
    return {"example": name, "axis": axis, "degrees": values["strength"]}


def law(case, text, name, axes=None):
    def change(problem, example, order):
        problem.material, problem.name, problem.axes = text, name, axes
    case.physics.append(change)


@hides("fibre", "anisotropy")
def fibre(case, values):
    """ELASTIC_FIBER of CalculiX: k1/(2 k2) (exp(k2 (I4bar - 1)^2) - 1), only where the fibre is longer."""
    a, k1, k2 = case.direction(unit(values["along"])), values["strength"], 2.0
    a = a if a[2] >= 0 else -a  # CalculiX takes the third component as positive

    def text(mu, kappa):
        return (f"*USER MATERIAL,CONSTANTS=6\n{mu / 2:.10g},{2 / kappa:.10g},{a[0]:.10g},{a[1]:.10g},"
                f"{k1 * mu:.10g},{k2}\n*DEPVAR\n1\n")
    law(case, text, "ELASTIC_FIBER")
    return {"direction": a, "k1_over_mu": k1, "k2": k2}


@hides("orthotropic", "anisotropy")
def orthotropic(case, values):
    """ENGINEERING CONSTANTS, linear between second Piola-Kirchhoff stress and Green strain."""
    stiffer_by = 1 + values["strength"]
    factor = np.array([stiffer_by, stiffer_by ** -0.5, stiffer_by ** -0.5])
    first = case.direction(unit(values["along"]))
    second = unit(np.cross(first, [0.3, 0.8, 0.52]))

    def text(mu, kappa):
        nu = (3 * kappa - 2 * mu) / (6 * kappa + 2 * mu)
        e = 2 * mu * (1 + nu) * factor
        cross = [nu * np.sqrt(e[i] / e[j]) for i, j in ((0, 1), (0, 2), (1, 2))]
        return ("*ELASTIC,TYPE=ENGINEERING CONSTANTS\n" + ",".join(f"{x:.9g}" for x in [*e, *cross, mu, mu])
                + f"\n{mu:.9g}\n")
    law(case, text, "RUBBER", np.array([first, second]))
    return {"direction": first, "youngs_moduli_over_mean": factor}


@hides("camera", "camera_pose")
def camera(case, values):
    """Knocked before an example."""
    order = list(case.examples)
    first, which = order.index(values["from"]), values["camera"]
    turn = rotation(values["axis"], 0.06 * values["strength"])
    move = 0.4 * values["strength"] * unit(values["move"])

    def change(photo, example, order, camera):
        if camera == which and order >= first:
            photo["R"], photo["t"] = turn @ np.array(photo["R"]), turn @ np.array(photo["t"]) + move
    case.optics.append(change)
    return {"camera": which, "from": values["from"], "rotation": turn, "translation": move}
