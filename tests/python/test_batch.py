"""Many captures from Python: the folder of the command, its engine and its keys."""

import csv
import shutil
import signal
import threading

import pytest
from conftest import PROGRAM, hookeye

import hookeye as he

QUICK = {"iterations": 40}


@pytest.fixture(scope="module")
def captures(folder, tmp_path_factory):
    """Two that are good and one without a photo."""
    made = tmp_path_factory.mktemp("batch")
    for name in ("one", "two", "broken"):
        shutil.copytree(folder / "capture", made / "all" / name)
    for name, mu in (("one", "0.018"), ("two", "0.02")):
        yaml = made / "all" / name / "capture.yaml"
        yaml.write_text(yaml.read_text() + f"# {mu}\n")  # other content, another key
    next((made / "all/broken/photos").iterdir()).unlink()
    return made


@pytest.fixture(scope="module")
def fitted_batch(captures):
    told = []
    out = he.batch(captures / "all", "fit", captures / "out", options=QUICK, jobs=2, threads=1,
                   memory="8G", on_step=told.append)
    assert told[-1].work == "batch" and (told[-1].done, told[-1].of) == (3, 3)
    return out


def test_a_failure_stops_no_other_and_rows_say_what_came(fitted_batch, captures):
    assert [row["label"] for row in fitted_batch] == ["broken", "one", "two"]
    assert [row["state"] for row in fitted_batch] == ["failed", "done", "done"]
    assert fitted_batch["broken"]["exit"] == 2 and "photos" in fitted_batch["broken"]["error"]
    assert fitted_batch.failed == [fitted_batch["broken"]] and len(fitted_batch) == 3
    table = fitted_batch.table
    with open(captures / "out/index.csv", newline="") as file:
        index = list(csv.DictReader(file))
    for row, line in zip(fitted_batch.rows[1:], index[1:]):
        assert list(table["mu"])[fitted_batch.rows.index(row)] == float(line["mu"])
    assert "one" in list(table["label"]) and "3 captures, 2 done, 1 failed" in repr(fitted_batch)
    assert fitted_batch.page.exists() and "<td>one</td>" in fitted_batch._repr_html_()
    run = fitted_batch.run("one")
    assert run.timeline["steps"][0]["parameters"][0]["value"] == fitted_batch["one"]["parameters"][0]["value"]
    with pytest.raises(he.InputError, match="broken"):
        fitted_batch.run("broken")
    with pytest.raises(KeyError):
        fitted_batch["three"]


def test_the_same_call_and_the_command_do_nothing_twice(fitted_batch, captures):
    written = {f: f.stat().st_mtime_ns for f in (captures / "out/results").iterdir()}
    again = he.batch([captures / "all"], "fit", captures / "out", options=QUICK)
    assert again.rows == fitted_batch.rows
    by_command = hookeye_status("batch", "all", "-o", "out", "--verb", "fit", "--json", "--",
                                "--iterations", 40, cwd=captures)
    assert by_command["captures"] == fitted_batch.rows
    assert written == {f: f.stat().st_mtime_ns for f in (captures / "out/results").iterdir()}
    with pytest.raises(he.InputError, match="another batch"):
        he.batch(captures / "all", "fit", captures / "out")
    # What has failed is tried again, once it is mended.
    tried = he.batch(captures / "all", "fit", captures / "out", options=QUICK, retry=True)
    assert tried["broken"]["state"] == "failed"
    assert {f.name for f in (captures / "out/results").iterdir()} != {f.name for f in written} or \
        tried["broken"]["seconds"] != fitted_batch["broken"]["seconds"]


def hookeye_status(*words, cwd):
    """As hookeye(), of a command that says by its status that something failed."""
    import json
    import subprocess

    done = subprocess.run([PROGRAM, *map(str, words[:words.index("--json")]), "--json",
                           *map(str, words[words.index("--json") + 1:])], cwd=cwd,
                          capture_output=True, text=True)
    assert done.returncode == 3, done.stderr
    return json.loads(done.stdout)


def test_names_tables_and_captures(captures, tmp_path):
    named = he.batch({"first": captures / "all/one", "second": he.Capture(captures / "all/two")},
                     "check", tmp_path / "named", jobs=2)
    assert [row["label"] for row in named] == ["first", "second"] and not named.failed
    own = he.Capture(captures / "all/two", options={"fit.pixels": 0})
    fitted = he.batch([own], "fit", tmp_path / "own", reports=False)
    assert fitted["two"]["options"] == ["--set", "fit.pixels=0"] and not fitted["two"]["report"]
    assert fitted.run("two").timeline["options"] == {"fit.pixels": 0}
    with pytest.raises(he.InputError, match="no option of `hookeye check`"):
        he.batch([own], "check", tmp_path / "never")
    (captures / "list.csv").write_text("capture,name,quick\nall/one,fast,yes\nall/two,slow,no\n")
    listed = he.batch(captures / "list.csv", "check", tmp_path / "listed")
    assert [(row["label"], row["options"]) for row in listed] == [("fast", ["--quick"]), ("slow", [])]
    assert he.batch(str(captures / "all/t*"), "check", tmp_path / "glob").rows[0]["label"] == "two"


@pytest.mark.parametrize("told, says", [
    ({"verb": "explore"}, "no verb 'explore'"),
    ({"options": {"colour": 1}}, "no option of `hookeye check`"),
    ({"options": {"quick": 3}}, "takes no value"),
    ({"memory": "much"}, "memory"),
    ({"jobs": -1}, "jobs"),
    ({"program": "/bin/true"}, "no Hookeye"),
    ({"program": "/nowhere/hookeye"}, "no program"),
])
def test_what_is_wrong_is_told_before_anything_begins(captures, tmp_path, told, says):
    with pytest.raises(he.InputError, match=says):
        he.batch(captures / "all/one", **{"verb": "check", "out": tmp_path / "out", **told})
    assert not (tmp_path / "out").exists()


def test_a_list_has_its_place(captures, tmp_path):
    (captures / "bad.csv").write_text("capture,name\nall/one,a\nnowhere,b\n")
    with pytest.raises(he.InputError) as raised:
        he.batch(captures / "bad.csv", "check", tmp_path / "out")
    assert raised.value.file.endswith("bad.csv") and raised.value.line == 3
    with pytest.raises(he.InputError, match="no captures"):
        he.batch([], "check", tmp_path / "out")


def test_a_stop_leaves_a_batch_that_goes_on(captures, tmp_path):
    cancel = threading.Event()
    cancel.set()
    with pytest.raises(he.Cancelled):
        he.batch(captures / "all", "fit", tmp_path / "out", options=QUICK, cancel=cancel)

    stopped = threading.Timer(0.5, signal.raise_signal, [signal.SIGINT])
    stopped.start()
    with pytest.raises(KeyboardInterrupt):
        he.batch([captures / "all/one", captures / "all/two"], "discover", tmp_path / "out", jobs=2)
    stopped.join()
    assert not list((tmp_path / "out/leased").iterdir())
    assert len(list((tmp_path / "out/todo").iterdir())) == 2
    status = hookeye("batch", "--resume", tmp_path / "out", "--status", cwd=tmp_path)
    assert status["counts"]["todo"] == 2
