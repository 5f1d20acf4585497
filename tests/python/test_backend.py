"""The wheel that `pip install .` makes: what is installed stands where each finds the helpers."""

import base64
import email
import hashlib
import importlib.util
import zipfile

import pytest
from conftest import SOURCES

import hookeye as he

FILES = {
    "bin/hookeye": ("hookeye-{}.data/scripts/hookeye", True),
    "libexec/hookeye/tetgen": ("hookeye-{}.data/data/libexec/hookeye/tetgen", True),
    "lib/python3/dist-packages/hookeye/__init__.py": ("hookeye/__init__.py", False),
    "share/man/man1/hookeye.1": ("hookeye-{}.data/data/share/man/man1/hookeye.1", False),
}


@pytest.fixture(scope="module")
def backend():
    spec = importlib.util.spec_from_file_location("hookeye_build", SOURCES / "python/backend/hookeye_build.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_version_is_the_program_s(backend):
    assert backend.version() == he.__version__
    told = email.message_from_string(backend.metadata())
    assert told["Name"] == "hookeye" and told["Version"] == he.__version__
    assert "numpy" in told.get_all("Requires-Dist")


def test_a_wheel_holds_what_was_installed(backend, tmp_path):
    for name in [*FILES, "share/doc/hookeye/README.md"]:
        (tmp_path / "prefix" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "prefix" / name).write_text(name)
    backend.pack(tmp_path / "prefix", tmp_path / "a.whl")
    backend.pack(tmp_path / "prefix", tmp_path / "b.whl")
    assert (tmp_path / "a.whl").read_bytes() == (tmp_path / "b.whl").read_bytes()
    version = backend.version()
    with zipfile.ZipFile(tmp_path / "a.whl") as wheel:
        for name, (place, program) in FILES.items():
            entry = wheel.getinfo(place.format(version))
            assert wheel.read(entry).decode() == name
            assert bool(entry.external_attr >> 16 & 0o111) == program, name
        info = f"hookeye-{version}.dist-info"
        recorded = dict(line.split(",", 1) for line in wheel.read(f"{info}/RECORD").decode().splitlines())
        assert set(recorded) == set(wheel.namelist())
        for name, told in recorded.items():
            if name.endswith("/RECORD"):
                continue
            content = wheel.read(name)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            assert told == f"sha256={digest},{len(content)}", name
        assert not any("README" in name for name in wheel.namelist())
        assert f"Tag: {backend.tag()}" in wheel.read(f"{info}/WHEEL").decode()


def test_a_failed_build_says_what_failed(backend, tmp_path):
    with pytest.raises(SystemExit, match="cmake ended with 1"):
        backend.run("cmake", "-S", tmp_path / "nowhere", "-B", tmp_path / "out")
    with pytest.raises(SystemExit, match="no program surely-not-there"):
        backend.run("surely-not-there")
