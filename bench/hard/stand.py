"""Cameras, lamps and paint around the body."""

import numpy as np

from body import unit


def look_at(target, azimuth, elevation, distance, focal, size):
    """OpenCV's axes, z of the world up. Angles in degrees; the camera stands at `azimuth` from +x."""
    a, e = np.radians([azimuth, elevation])
    back = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = unit(np.cross(-back, [0, 0, 1]))
    turn = np.array([right, np.cross(-back, right), -back])
    place = np.asarray(target) + distance * back
    return {"size": list(size), "fx": focal, "fy": focal, "cx": (size[0] - 1) / 2, "cy": (size[1] - 1) / 2,
            "R": turn.round(9).tolist(), "t": (-turn @ place).round(6).tolist()}


def speckle(dot, rng, uneven=0.0):
    """Two layers of dots of about `dot` mm across."""
    layers = []
    for size in (1.0, 1.45):
        cell = 1.5 * dot * size
        layers.append({"cell": cell, "radius": 0.33, "soft": 0.1, "uneven": uneven, "wander": 12 * dot,
                       "shift": rng.uniform(-500, 500, 3).round(3).tolist()})
    return {"layers": layers, "dots": [0.12] * 3, "ground": [0.72] * 3, "specular": 0.0, "roughness": 1.0,
            "subsurface": 0.0, "depth": 0.0}


def area_lamp(toward, about, strength, away=450, size=120):
    return {"kind": "area", "toward": unit(toward).tolist(), "about": list(about), "strength": strength,
            "away": away, "size": size}


def sun(toward, about, strength):
    return {"kind": "sun", "toward": unit(toward).tolist(), "about": list(about), "strength": strength, "angle": 0.01}
