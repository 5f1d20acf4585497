"""Hidden effects in the forms that CalculiX and Blender have.

An effect is a function of the case, a random generator and its size (1: as usual). It appends to
`case.physics`, functions of (problem, example, order), or to `case.optics`, functions of (photo, example, order,
camera), or alters the case; it returns what the truth file tells. NAME:FORM chooses between forms.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from body import unit

EFFECTS = {}


def effect(name):
    def register(function):
        EFFECTS[name] = function
        return function
    return register


def from_on(case, rng):
    """The number of the example where a change begins: neither the first nor the last that is fitted."""
    return int(rng.integers(1, max(2, sum(map(case.fitted, case.order)) - 1)))


def material(case, law, name="RUBBER", axes=None):
    def change(problem, example, order):
        problem.material, problem.name, problem.axes = law, name, axes
    case.physics.append(change)


@effect("none")
def none(case, rng, size):
    return {}


@effect("anisotropy:fibre")
def fibre(case, rng, size):
    """ELASTIC_FIBER of CalculiX: k1/(2 k2) (exp(k2 (I4bar - 1)^2) - 1), only where the fibre is longer."""
    a = unit([rng.normal(), rng.normal(), abs(rng.normal()) + 0.5])
    k1, k2 = 0.25 * size, 2.0

    def law(mu, kappa):
        return (f"*USER MATERIAL,CONSTANTS=6\n{mu / 2:.10g},{2 / kappa:.10g},{a[0]:.10g},{a[1]:.10g},"
                f"{k1 * mu:.10g},{k2}\n*DEPVAR\n1\n")
    material(case, law, "ELASTIC_FIBER")
    return {"direction": a, "k1_over_mu": k1, "k2": k2}


@effect("anisotropy:orthotropic")
def orthotropic(case, rng, size):
    """ENGINEERING CONSTANTS, linear between second Piola-Kirchhoff stress and Green strain."""
    stiffer = 1 + 0.35 * size
    factor = np.array([stiffer, stiffer ** -0.5, stiffer ** -0.5])
    turn = Rotation.random(random_state=int(rng.integers(1 << 31))).as_matrix()

    def law(mu, kappa):
        nu = (3 * kappa - 2 * mu) / (6 * kappa + 2 * mu)
        e = 2 * mu * (1 + nu) * factor
        cross = [nu * np.sqrt(e[i] / e[j]) for i, j in ((0, 1), (0, 2), (1, 2))]
        return ("*ELASTIC,TYPE=ENGINEERING CONSTANTS\n" + ",".join(f"{x:.9g}" for x in [*e, *cross, mu, mu])
                + f"\n{mu:.9g}\n")
    material(case, law, axes=turn[:2])
    return {"direction": turn[0], "youngs_moduli_over_mean": factor}


@effect("strain_stiffening:arruda_boyce")
def arruda_boyce(case, rng, size):
    limit = 1.25 if size >= 1 else 1.6
    own = 1 + 3 / (5 * limit**2) + 99 / (175 * limit**4) + 513 / (875 * limit**6) + 42039 / (67375 * limit**8)
    material(case, lambda mu, kappa: f"*HYPERELASTIC,ARRUDA-BOYCE\n{mu / own:.9g},{limit},{2 / kappa:.9g}\n")
    return {"locking_stretch": limit}


@effect("strain_stiffening:ogden")
def ogden(case, rng, size):
    share, alpha = 0.3 * size, 8.0
    material(case, lambda mu, kappa: f"*HYPERELASTIC,OGDEN,N=2\n{(1 - share) * mu:.9g},2.,{share * mu:.9g},{alpha},"
             f"{2 / kappa:.9g},0.\n")
    return {"share": share, "alpha": alpha}


@effect("tension_compression_asymmetry")
def mooney(case, rng, size):
    share = 0.5 * size
    material(case, lambda mu, kappa: f"*HYPERELASTIC,MOONEY-RIVLIN\n{(1 - share) * mu / 2:.9g},{share * mu / 2:.9g},"
             f"{2 / kappa:.9g}\n")
    return {"c01_over_sum": share}


@effect("compressibility")
def compressibility(case, rng, size):
    def change(problem, example, order):
        problem.kappa *= 0.3 / size
    case.physics.append(change)
    return {"kappa_over_told": 0.3 / size}


def stiffer_where(case, inside, factor):
    def change(problem, example, order):
        problem.stiffness = np.where(inside, factor, 1.0)
    case.physics.append(change)


@effect("stiffness_field:inclusion")
def inclusion(case, rng, size):
    centres = case.body.nodes[case.body.tets[:, :4]].mean(1)
    centre = [rng.uniform(-8, 8), rng.uniform(-8, 8), rng.uniform(25, 55)]
    radius, factor = 13.0, 1 + 2 * size
    stiffer_where(case, np.linalg.norm(centres - centre, axis=1) < radius, factor)
    return {"centre": centre, "radius": radius, "factor": factor}


@effect("stiffness_field:half")
def half(case, rng, size):
    centres = case.body.nodes[case.body.tets[:, :4]].mean(1)
    normal, factor = unit([rng.normal(), rng.normal(), 0.3 * rng.normal()]), 1 + 0.3 * size
    stiffer_where(case, (centres - [0, 0, 40]) @ normal > 0, factor)
    return {"normal": normal, "factor": factor}


@effect("gravity")
def gravity(case, rng, size):
    g = 9810 * unit([0.3 * rng.normal(), 0.3 * rng.normal(), -1]) * size

    def change(problem, example, order):
        problem.forces = problem.forces + 1.07e-9 * case.body.volumes()[:, None] * g
    case.physics.append(change)
    return {"g": g, "density": 1.07e-9}


def grown(case, by_node):
    def change(problem, example, order):
        problem.growth = by_node
    case.physics.append(change)


@effect("swelling:uniform")
def uniform(case, rng, size):
    grown(case, np.full(len(case.body.nodes), 0.012 * size))
    return {"strain": 0.012 * size}


@effect("swelling:gradient")
def gradient(case, rng, size):
    axis = unit([rng.normal(), rng.normal(), rng.normal()])
    place = case.body.nodes @ axis
    share = (place - place.min()) / np.ptp(place)
    grown(case, 0.02 * size * share)
    return {"strain": [0, 0.02 * size], "along": axis}


@effect("load_direction")
def load_direction(case, rng, size):
    example = rng.choice([e for e in case.order[1:] if case.held(e) is None and case.fitted(e)])
    axis = unit(np.cross(case.force(example), rng.normal(size=3)))
    turn = Rotation.from_rotvec(np.radians(4 * size) * axis)
    case.turned[example] = turn
    return {"example": example, "degrees": 4 * size, "axis": axis}


@effect("pressure")
def pressure(case, rng, size):
    value = 1.2 * size / case.body.areas("side").sum()

    def change(problem, example, order):
        problem.pressure = (case.body.patch["side"][:, :3], value)
    case.physics.append(change)
    return {"region": "side", "pressure": value}


@effect("placement")
def placement(case, rng, size):
    turn = Rotation.from_rotvec(np.radians(0.25 * size) * unit(rng.normal(size=3)))
    move = 0.5 * size * unit(rng.normal(size=3))
    case.place = (turn, move)
    return {"rotation": turn.as_rotvec(), "translation": move}


@effect("soft_clamp")
def soft_clamp(case, rng, size):
    normal, across = 0.06 / size, 0.023 / size
    shares = case.body.areas("base")

    def change(problem, example, order):
        for node in case.body.nodes_of("base"):
            problem.fixed.pop(node)
            if shares[node] > 0:
                problem.springs[node] = (normal * shares[node], across * shares[node])
    case.physics.append(change)
    return {"normal": normal, "across": across}


@effect("grip_slip")
def grip_slip(case, rng, size):
    example = rng.choice(["twist", "press"])
    case.follows[example] = 1 - 0.1 * size
    return {"example": example, "follows": 1 - 0.1 * size}


@effect("floor_contact")
def wall(case, rng, size):
    """A steep wall beside the top that the sideways load leads into; sometimes oblique."""
    u = case.solve("side", hidden=False)[0]
    push = unit(u[case.body.nodes_of("grip")].mean(0) * [1, 1, 0])
    normal = -unit(push + [0, 0, rng.uniform(-0.3, 0.3)])
    start, end = (x @ -normal for x in (case.body.nodes, case.body.nodes + u))
    place = start.max() + max(1.0, end.max() - start.max() - 1.5 * size)
    wall = (-place * normal, normal, 20 * case.mu)

    def change(problem, example, order):
        problem.wall = wall
    case.physics.append(change)
    return {"point": wall[0], "normal": normal, "stiffness": wall[2]}


def weaker(case, by_order):
    def change(problem, example, order):
        problem.mu, problem.kappa = problem.mu / by_order(order), problem.kappa / by_order(order)
    case.physics.append(change)


@effect("creep:saturating")
def saturating(case, rng, size):
    weaker(case, lambda order: 1 + 0.2 * size * (1 - np.exp(-order / 1.5)))
    return {"compliance": "1 + a (1 - exp(-order / 1.5))", "a": 0.2 * size}


@effect("creep:logarithmic")
def logarithmic(case, rng, size):
    weaker(case, lambda order: 1 + 0.08 * size * np.log1p(order))
    return {"compliance": "1 + a log(1 + order)", "a": 0.08 * size}


@effect("softening")
def softening(case, rng, size):
    first, share = min(from_on(case, rng) + 1, len(case.order) - 1), 0.12 * size
    weaker(case, lambda order: 1 / (1 - share) if order >= first else 1.0)
    return {"from": case.order[first], "share": share}


@effect("camera_pose")
def camera_pose(case, rng, size):
    first, which = from_on(case, rng), rng.choice(case.cameras)
    turn = Rotation.from_rotvec(np.radians(0.06 * size) * unit(rng.normal(size=3))).as_matrix()
    move = 0.5 * size * unit(rng.normal(size=3))

    def change(photo, example, order, camera):
        if camera == which and order >= first:
            photo["R"], photo["t"] = turn @ photo["R"], turn @ photo["t"] + move
    case.optics.append(change)
    return {"camera": which, "from": case.order[first], "rotation": turn, "translation": move}


@effect("focal_length")
def focal_length(case, rng, size):
    which, factor = rng.choice(case.cameras), 1 + 0.007 * size

    def change(photo, example, order, camera):
        if camera == which:
            photo["fx"], photo["fy"] = photo["fx"] * factor, photo["fy"] * factor
    case.optics.append(change)
    return {"camera": which, "factor": factor}


@effect("exposure")
def exposure(case, rng, size):
    first, factor = from_on(case, rng), 1 + 0.05 * size

    def change(photo, example, order, camera):
        photo["gain"] = factor if order >= first else 1.0
    case.optics.append(change)
    return {"from": case.order[first], "factor": factor}


@effect("light_direction")
def light_direction(case, rng, size):
    first, turn = from_on(case, rng), Rotation.from_rotvec(np.radians(7 * size) * unit(rng.normal(size=3)))

    def change(photo, example, order, camera):
        if order >= first:
            photo["sun"] = (1 - 0.08 * size) * turn.apply(photo["sun"])
    case.optics.append(change)
    return {"from": case.order[first], "degrees": 7 * size, "strength": 1 - 0.08 * size}


@effect("defocus")
def defocus(case, rng, size):
    """Depth of field: the lens is focused too near by a share of the distance."""
    first, which = from_on(case, rng), rng.choice(case.cameras)
    near, blur = 0.85, 1.5 * size

    def change(photo, example, order, camera):
        if camera == which and order >= first:
            away = np.linalg.norm(photo["t"])
            disc = 4 * blur  # diameter of a disc of that standard deviation
            photo["lens"] = {"focus": near * away, "aperture": disc * away * near / (1 - near) / photo["fx"]}
    case.optics.append(change)
    return {"camera": which, "from": case.order[first], "blur_px": blur, "focus_over_distance": near}


@effect("specular")
def specular(case, rng, size):
    """Part of the light goes to a GGX lobe instead of the matte one."""
    def change(photo, example, order, camera):
        photo["glossy"] = {"share": 0.04 * size, "roughness": 0.4}
    case.optics.append(change)
    return {"share": 0.04 * size, "roughness": 0.4}


@effect("force_zero")
def force_zero(case, rng, size):
    case.force_offset = 1.5 * size * unit(rng.normal(size=3))
    return {"offset": case.force_offset}
