import copy
import json
import logging
import os
import re
import shutil
import signal
import threading

import numpy as np
import pytest
from conftest import hookeye

import hookeye as he


def undated(file):
    """OpenEXR's header tells the second in which it was written."""
    return re.sub(rb"\d{4}:\d\d:\d\d \d\d:\d\d:\d\d", b"", file.read_bytes())


def test_a_fit_is_the_command_s_in_every_bit(folder, fitted, by_command):
    python, command = (copy.deepcopy(t["steps"]) for t in (fitted.timeline, by_command))
    assert len(python) == len(command) == 1
    for step, verb in ((python[0], "hookeye.fit("), (command[0], "hookeye fit ")):
        assert step.pop("command").startswith(verb) and step.pop("made_in")
    assert python == command
    assert fitted.timeline["floor"] == by_command["floor"]
    assert fitted.answer == by_command["answer"]
    own, other = fitted.steps[0].folder, folder / "command-run/steps/00-base"
    names = {p.relative_to(own) for p in own.rglob("*") if p.is_file()}
    assert names == {p.relative_to(other) for p in other.rglob("*") if p.is_file()}
    for name in names:
        assert undated(own / name) == undated(other / name), name


def test_parameters_and_covariance(fitted, by_command):
    told = by_command["steps"][0]["parameters"]
    assert list(fitted.parameters["value"]) == [one["value"] for one in told]
    model = fitted.model()
    for one in told:
        assert model[one["name"]].value == one["value"]
        assert model[one["name"]].interval == (one["low"], one["high"])
    model["mu"].value *= 1.01
    assert model["mu"].interval is None
    # The interval of the run is 1.96 standard deviations, in the logarithm.
    deviation = np.sqrt(np.diag(np.asarray(fitted.covariance)))
    for one, s in zip(told, deviation):
        assert np.isclose(np.log(one["high"] / one["value"]), 1.959964 * s / one["value"], rtol=1e-5)


def test_samples_are_those_of_the_covariance(fitted):
    draws = np.column_stack([fitted.samples(20000, seed=1)[n] for n in ("mu", "kappa")])
    values = np.array(list(fitted.parameters["value"]))
    covariance = np.asarray(fitted.covariance)
    logs = np.log(draws)
    assert np.allclose(logs.mean(0), np.log(values), atol=0.05 * logs.std(0).max())
    assert np.allclose(np.cov(logs.T), covariance / np.outer(values, values), rtol=0.1,
                       atol=0.02 * np.abs(np.cov(logs.T)).max())
    assert np.array_equal(fitted.samples(5, seed=1), fitted.samples(5, seed=1))
    with pytest.raises(he.InputError, match="samples: 0"):
        fitted.samples(0)


def test_any_run_opens(folder, fitted, by_command):
    run = he.Run(folder / "command-run")
    assert run.timeline["steps"] == by_command["steps"]
    assert run.capture.file == folder / "capture/capture.yaml"
    assert np.allclose(run.covariance, fitted.covariance, rtol=1e-6)
    mine, other = run.residuals(), fitted.residuals()
    assert set(mine) == set(other) == {
        (example, "cam0") for example in ("rest", "pull", "side", "poke")}
    for shot in mine:
        assert np.allclose(mine[shot], other[shot], atol=1e-3, equal_nan=True)
    assert run.verdict is None and "neo-hookean" in repr(run) and "<table" in run._repr_html_()
    field = run.field()
    assert field.values.shape == field.points.shape and field.magnitude.max() > 0.1
    assert len(run.field("von_mises", "pull").values) == len(field.elements)
    with pytest.raises(he.InputError, match="no field"):
        run.field("colour")


def test_a_folder_that_is_no_run_and_a_damaged_one(tmp_path, folder, by_command):
    with pytest.raises(he.InputError):
        he.Run(tmp_path)
    shutil.copytree(folder / "command-run", tmp_path / "run")
    file = tmp_path / "run/run.json"
    file.write_text(file.read_text().replace('"steps": [', '"steps": [['))
    with pytest.raises(he.InputError) as caught:
        he.Run(tmp_path / "run")
    assert caught.value.file == str(file)


def test_the_diagnosis_names_gravity_and_logs_why(folder, capture):
    told = []
    run = he.fit(capture)
    diagnosis = run.diagnose(on_step=told.append)
    by_command = hookeye("fit", "capture", "-o", "to-diagnose", cwd=folder)
    by_command = hookeye("diagnose", "to-diagnose", cwd=folder)
    assert diagnosis.ties[0] == by_command["leaders"][0] == "gravity"
    # The command works out anew where the fit had ended: the last digits may differ.
    assert np.isclose(diagnosis.gate, by_command["gate"], rtol=1e-3)
    mine = {one["effect"]: one.get("evidence") for one in diagnosis.told["effects"]}
    for one in by_command["effects"]:
        if "evidence" in one:
            assert np.isclose(mine[one["effect"]], one["evidence"], rtol=1e-3, atol=1e-2)
    assert "gravity" in diagnosis.verdict and diagnosis.table["named"][0]
    why = run.why("gravity")
    assert list(why["asked"]) == ["named"] and list(why["accepted"]) == [True]
    assert why["value"][0] > why["limit"][0]
    with pytest.raises(he.InputError, match="no effect"):
        run.why("gravty")
    assert told[-1].work == "diagnose" and told[-1].done == told[-1].of > 0
    page = run.folder.parent / "r.html"
    try:
        report = run.report(page)
        assert report["bytes"] == page.stat().st_size > 100_000
        assert report._repr_html_().startswith("<iframe")
    except he.InputError as error:  # a build without Node.js has no page
        assert "Node.js" in str(error) and not page.exists()
    step = run.add("gravity")
    assert step.added == "gravity" and step.chi < 1.3 * diagnosis.floor
    assert [s.name for s in run.steps] == ["base", "gravity"]
    assert run.model()["gravity.z"].value == pytest.approx(-9650, rel=0.05)


def test_what_is_fixed_stays_fixed_in_the_run(capture, tmp_path):
    model = capture.model()
    model["kappa"].value = 0.7
    model.fix("kappa")
    run = he.fit(capture, model, out=tmp_path / "run")
    assert list(run.parameters["name"]) == ["mu"]
    again = he.Run(tmp_path / "run").model()
    assert again["kappa"].fixed and again["kappa"].value == 0.7
    assert again["mu"].value == run.parameters["value"][0]
    assert hookeye("compare", "run", cwd=tmp_path)  # the commands read it too


class Broken(Exception):
    pass


@pytest.mark.parametrize("at", [0, 3, -1])
def test_an_exception_in_a_callback_comes_out_and_leaves_nothing(capture, tmp_path, at):
    calls = []
    he.fit(capture, on_step=calls.append)
    stop = at if at >= 0 else len(calls) - 1
    count = 0

    def callback(progress):
        nonlocal count
        if count == stop:
            raise Broken(progress.stage)
        count += 1

    with pytest.raises(Broken):
        he.fit(capture, out=tmp_path / "run", on_step=callback)
    assert count == stop
    assert not (tmp_path / "run").exists()


def test_a_cancelled_fit_says_so_and_leaves_nothing(capture, tmp_path):
    cancel = threading.Event()
    with pytest.raises(he.Cancelled):
        he.fit(capture, out=tmp_path / "run", on_step=lambda _: cancel.set(), cancel=cancel)
    assert not (tmp_path / "run").exists()
    with pytest.raises(he.Cancelled):
        capture.model().evaluate(cancel=cancel)
    with pytest.raises(TypeError, match="is_set"):
        he.fit(capture, cancel=1)
    with pytest.raises(TypeError, match="hookeye.Capture"):
        he.fit("capture")
    with pytest.raises(TypeError, match="on_step"):
        he.fit(capture, on_step=1)


def test_ctrl_c_is_a_keyboard_interrupt(capture, tmp_path):
    timer = []

    def callback(_):
        if not timer:
            timer.append(threading.Timer(0.01, os.kill, (os.getpid(), signal.SIGINT)))
            timer[0].start()

    with pytest.raises(KeyboardInterrupt):
        for i in range(50):
            he.fit(capture, out=tmp_path / f"{i}", on_step=callback)
    for run in tmp_path.iterdir():  # it may have come when all was written
        assert he.Run(run).steps
    assert he.fit(capture, out=tmp_path / "again").converged  # and all goes on


def test_callbacks_run_on_the_calling_thread(capture):
    threads = set()
    he.fit(capture, on_step=lambda _: threads.add(threading.get_ident()))
    assert threads == {threading.get_ident()}


def test_a_callback_may_ask_all_but_the_run_that_works(capture, fitted):
    run = he.fit(capture, on_step=lambda _: capture.model().evaluate(jac=False))
    with pytest.raises(he.InputError, match="at work"):
        run.diagnose(on_step=lambda _: run.covariance)
    seen = []
    run.diagnose(on_step=lambda _: seen.append(fitted.covariance.shape))
    assert set(seen) == {(2, 2)}


def test_log_lines_come_through_logging(capture, caplog):
    with caplog.at_level(logging.DEBUG, "hookeye"):
        run = he.fit(capture, iterations=1)
    assert not run.converged
    told = [(r.levelno, r.getMessage()) for r in caplog.records if r.name == "hookeye"]
    assert any(level == logging.WARNING and "not converged" in text for level, text in told)
    assert any(level == logging.DEBUG for level, _ in told)


def test_a_run_is_not_written_twice(capture, folder, fitted, tmp_path):
    with pytest.raises(he.InputError, match="fitted already"):
        he.fit(capture, out=fitted.folder)
    (tmp_path / "other.txt").write_text("mine")
    with pytest.raises(he.InputError):
        he.fit(capture, out=tmp_path)
    assert os.listdir(tmp_path) == ["other.txt"]
    with pytest.raises(he.InputError, match="another capture"):
        he.fit(capture, he.Capture(folder / "capture").model())


def test_a_folder_without_a_page_goes_with_its_run(capture):
    run = he.fit(capture)
    folder = run.folder
    assert json.loads((folder / "run.json").read_text())["steps"]
    del run
    assert not folder.exists()


def test_without_pandas_tables_are_plain(fitted, monkeypatch):
    monkeypatch.setattr("hookeye.tables.pandas_if_there", lambda: None)
    table = fitted.parameters
    assert isinstance(table, he.Table) and table["name"] == ["mu", "kappa"]
    assert len(table) == 2 and "mu" in repr(table) and "<td>mu</td>" in table._repr_html_()
    assert len(fitted.samples(7)["mu"]) == 7 and fitted.covariance.shape == (2, 2)
    with pytest.raises(KeyError):
        table["colour"]


def test_with_pandas_a_table_prints_each_name_once_and_hides_no_value(fitted):
    pandas = pytest.importorskip("pandas")
    table = fitted.parameters
    assert isinstance(table, pandas.DataFrame)
    for width in (80, 40):  # of a terminal
        with pandas.option_context("display.width", width, "display.max_columns", 0):
            said = repr(table)
        assert "..." not in said and max(map(len, said.splitlines())) <= width
        for one in ("name", "value", "low", "high", "unit", "words", "mu", "kappa"):
            assert len(re.findall(rf"\b{one}\b", said)) == 1, said
        for value in table["value"]:
            assert f"{value:.6g}" in said
    assert table.loc["mu", "value"] == table["value"].iloc[0] and list(table["name"]) == ["mu", "kappa"]
    html = table._repr_html_()
    assert html.count(">mu<") == 1 and html.count(">name<") == 1
    assert type(table[["low", "high"]]) is pandas.DataFrame


def test_a_progress_bar_is_an_on_step(capture, caplog):
    bar = he.ProgressBar()
    bar._tqdm = None  # whether it is installed or not
    with caplog.at_level(logging.INFO, "hookeye"):
        he.fit(capture, on_step=bar)
    assert any(r.getMessage() == "fit motion" for r in caplog.records)


def test_a_search_is_the_command_s_and_is_taken_up(folder, capture, tmp_path):
    told, cancel = [], threading.Event()

    def stop_after_the_base(now):
        told.append(now)
        if now.work == "step":
            cancel.set()

    with pytest.raises(he.Cancelled):
        he.discover(capture, tmp_path / "run", on_step=stop_after_the_base, cancel=cancel)
    assert {now.work for now in told} >= {"fit", "diagnose", "step"}
    stopped = he.Run(tmp_path / "run")
    assert [step.name for step in stopped.steps] == ["base"] and stopped.verdict is None
    assert (stopped.steps[0].folder / "metrics.json").exists()
    run = he.discover(capture, tmp_path / "run")
    by_command = hookeye("discover", "capture", "-o", "searched", cwd=folder)
    assert run.verdict == by_command["verdict"] == "explained"
    assert run.timeline["missing"] == by_command["missing"] == ["gravity"]
    assert run.timeline["sentence"] == by_command["sentence"]
    for mine, other in zip(run.timeline["steps"], by_command["steps"]):
        assert [p["value"] for p in mine["parameters"]] == pytest.approx(
            [p["value"] for p in other["parameters"]], rel=1e-6)
    assert list(run.why("gravity")["asked"])[:2] == ["named", "screened"]
    assert "explained" in repr(run)
    with pytest.raises(he.InputError, match="gravity"):
        he.discover(capture, without=["gravty"])


def test_what_was_decided_is_printed_whole(capture, monkeypatch):
    run = he.fit(capture)
    run.diagnose()
    pandas = pytest.importorskip("pandas")
    why = run.why("gravity")
    for frame in (why, run.decisions):
        for width in (80, 40):
            with pandas.option_context("display.width", width):
                said = "".join(repr(frame).split())  # lines may break between any two words
            for text in (*frame["why"], *frame["where"]):
                assert "".join(text.split()) in said, text
        html = frame._repr_html_()
        assert all(text.split()[-1] in html for text in frame["why"] if text)
        assert html.count("<tr") == len(frame) + 1
    monkeypatch.setattr("hookeye.tables.pandas_if_there", lambda: None)
    assert all(text in repr(run.why("gravity")) for text in why["why"])
