"""Cuts recipes down to a second of computing: shrink.py RECIPE...

Small pictures, coarse linear tetrahedra, few rays. Bodies, loads and hidden effects stay.
"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "schema"))
import yaml  # noqa: E402
import yaml12  # noqa: E402

SMALLER = 3.2


def shrink(recipe):
    cameras, body = recipe["cameras"], recipe["body"]
    cameras["size"] = [max(64, round(n / SMALLER)) for n in cameras.get("size", [480, 360])]
    cameras["focal"] /= SMALLER
    body["mesh"] = {"edge": 1.5 * body["mesh"]["edge"], "order": 1}
    if "facet" in body:
        body["facet"] = 1.5 * body["facet"]
    for length in ("texel", "speckle"):
        if length in body.get("texture", {}):
            body["texture"][length] *= 2.0
    recipe["truth"] = {"edge_factor": 0.9, "order": 1, "rays_per_axis": 2, "visibility_rays": 32}
    return recipe


for file in map(Path, sys.argv[1:]):
    file.write_text(yaml.safe_dump(shrink(yaml12.read(file.read_text())), sort_keys=False))
