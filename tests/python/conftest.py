"""A small capture that hides gravity, made by the program, and what the program says of it."""

import json
import os
import pathlib
import subprocess

import pytest

PROGRAM = os.environ["HOOKEYE_PROGRAM"]
SOURCES = pathlib.Path(os.environ["HOOKEYE_SOURCE_DIR"])

RECIPE = """hookeye_recipe: 1
title: small
seed: 5
body:
  shape: block
  size: [20, 16, 34]
  bumps: 0.05
  facet: 7
  mesh: {edge: 11}
  density: 1.07e-9
  texture: {texel: 0.16, speckle: 1.6}
material: {law: neo-hookean, true: {mu: 0.02, kappa: 0.2}, told: {mu: 0.018}, fit: [mu, kappa]}
cameras: {count: 1, size: [150, 190], distance: 6, focal: 700}
examples:
  rest: {}
  pull: {force: [0, 0, 0.3]}
  side: {force: [0.012, 0.006, 0]}
  poke: {use: validate, force: [-0.008, 0.01, 0.12]}
hidden:
  - {effect: gravity, values: {gravity.x: 1500, gravity.z: -9650}}
truth: {edge_factor: 1, rays_per_axis: 4, visibility_rays: 256}
"""


def hookeye(*words, cwd):
    """The document of a command."""
    done = subprocess.run([PROGRAM, *map(str, words), "--json"], cwd=cwd, capture_output=True,
                          text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("small")
    (made / "recipe.yaml").write_text(RECIPE)
    hookeye("synth", "recipe.yaml", "-o", "capture", cwd=made)
    return made


@pytest.fixture(scope="session")
def capture(folder):
    import hookeye as he

    return he.Capture(folder / "capture")


@pytest.fixture(scope="session")
def fitted(folder, capture):
    """A run made from Python; nobody writes into it."""
    import hookeye as he

    return he.fit(capture, out=folder / "python-run")


@pytest.fixture(scope="session")
def by_command(folder):
    return hookeye("fit", "capture", "-o", "command-run", cwd=folder)
