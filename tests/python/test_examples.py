"""The scripts of python/examples run as they stand there."""

import os
import re
import subprocess
import sys

import numpy as np
import pytest
from conftest import SOURCES

import hookeye as he


def run(script, *words, cwd):
    done = subprocess.run([sys.executable, SOURCES / "python/examples" / script, *map(str, words)],
                          cwd=cwd, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_fit_and_plot(folder, tmp_path):
    pytest.importorskip("matplotlib")
    said = run("fit_and_plot.py", folder / "capture", tmp_path / "fit.png", cwd=tmp_path)
    assert "neo-hookean" in said and "motion 0/20" in said
    assert (tmp_path / "fit.png").stat().st_size > 20_000


def test_own_optimiser(folder, tmp_path, fitted):
    pytest.importorskip("scipy")
    said = run("own_optimiser.py", folder / "capture", cwd=tmp_path).splitlines()
    chi = float(said[-1].split()[1])
    mine = dict(line.split()[:2] for line in said[:-1])
    # Hookeye's own fit is robust: it may leave a little more of the squares.
    assert chi <= fitted.steps[0].chi * 1.001
    for name, value, low, high in zip(*(fitted.parameters[k] for k in
                                        ("name", "value", "low", "high"))):
        assert abs(float(mine[name]) - value) < 2 * (high - low), name


def test_diagnose(folder, tmp_path):
    pytest.importorskip("pandas")
    said = run("diagnose.py", folder / "capture", "run", cwd=tmp_path)
    assert "cannot be told apart: gravity" in said and "named: yes" in said


def test_own_sampler(folder, tmp_path):
    said = run("own_sampler.py", folder / "capture", 150, cwd=tmp_path)
    accepted = float(re.search(r"accepted: (\d+) %;", said).group(1))
    assert 5 < accepted < 95
    for name in ("mu", "kappa"):
        ends = {what: (float(low), float(high)) for what, low, high in re.findall(
            rf"{name} ([\w ]+): (\S+) to (\S+)", said)}
        assert set(ends) == {"every pixel", "Laplace", "sampled"}
        widths = {what: high - low for what, (low, high) in ends.items()}
        assert 0.4 < widths["sampled"] / widths["Laplace"] < 2.5, name
        assert widths["every pixel"] < widths["Laplace"], name


def test_residual_arrays(folder, tmp_path, fitted):
    said = run("residual_arrays.py", folder / "capture", "r.npz", cwd=tmp_path)
    kept = np.load(tmp_path / "r.npz")
    assert set(kept) == {f"{example}_{camera}" for example, camera in fitted.residuals()}
    for (example, camera), r in fitted.residuals().items():
        chi = float(re.search(rf"{example}, {camera}: chi (\S+),", said).group(1))
        assert chi == pytest.approx(np.sqrt(np.nanmean(r.astype(float) ** 2)), abs=2e-3)


def test_own_effect(folder, tmp_path):
    pytest.importorskip("pandas")
    said = run("own_effect.py", folder / "capture", "run", cwd=tmp_path)
    assert said.count("null changes nothing") == 2
    assert re.search(r"^ *spring ", said, re.M) and re.search(r"^ *stiff_skin ", said, re.M)
    assert "spring.k" in said


def test_the_page_s_lines_run(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    os.symlink(folder / "capture", tmp_path / "block")
    blocks = re.findall(r"```python\n(.*?)```", (SOURCES / "docs/python.md").read_text(), re.S)
    assert len(blocks) == 5
    names = {}
    for block in blocks:
        exec(block, names)
    assert "stiff_skin" in list(names["diagnosis"].table["effect"])
    he.unregister("stiff_skin")
    he.unregister("opening")
    assert names["model"]["mu"].fixed and (tmp_path / "run/run.json").exists()
