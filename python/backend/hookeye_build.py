"""Builds the wheel of Hookeye by CMake, for pip (PEP 517). Only the standard library is needed.

Settings (pip install . --config-settings=NAME=VALUE):
  build-dir   folder of the build (default: build/pip); one that is configured is used as it is
  jobs        compilers at once (default: the cores, a compiler for 1.5 GB of free memory)
  cmake       further words for CMake's configuration, such as -DHOOKEYE_WITH_GMSH=OFF
"""

import base64
import hashlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def version():
    """CMakeLists.txt is the one place of it."""
    told = re.search(r"^project\(hookeye VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.M)
    if told is None:
        raise RuntimeError("CMakeLists.txt tells no version of the project hookeye")
    return told.group(1)


def metadata():
    return "\n".join([
        "Metadata-Version: 2.1", "Name: hookeye", f"Version: {version()}",
        "Summary: The elastic model of a soft object from photos under known loads",
        "License: AGPL-3.0-or-later", "Requires-Python: >=3.9", "Requires-Dist: numpy",
        'Requires-Dist: pandas; extra == "tables"', 'Requires-Dist: matplotlib; extra == "plots"',
        "Provides-Extra: tables", "Provides-Extra: plots", "Description-Content-Type: text/markdown", "",
        (ROOT / "README.md").read_text(encoding="utf-8")])


def tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"


def wheel_text():
    return f"Wheel-Version: 1.0\nGenerator: hookeye_build\nRoot-Is-Purelib: false\nTag: {tag()}\n"


def jobs():
    cores = len(os.sched_getaffinity(0))
    try:
        free = int(re.search(r"MemAvailable: +(\d+)", pathlib.Path("/proc/meminfo").read_text()).group(1))
    except (OSError, AttributeError):
        return cores
    return max(1, min(cores, free // 1572864))


def run(*words):
    words = [str(word) for word in words]
    print("+", shlex.join(words), flush=True)
    try:
        subprocess.run(words, check=True)
    except FileNotFoundError:
        raise SystemExit(f"error: there is no program {words[0]}: install the packages of packages.txt") from None
    except subprocess.CalledProcessError as failed:
        raise SystemExit(f"error: {words[0]} ended with {failed.returncode} (see above)") from None


def build(settings):
    """Returns the folder of a build with the module for this Python."""
    folder = pathlib.Path(settings.get("build-dir", ROOT / "build" / "pip")).resolve()
    ninja = ["-G", "Ninja"] if shutil.which("ninja") and not (folder / "CMakeCache.txt").exists() else []
    tests = [] if (folder / "CMakeCache.txt").exists() else ["-DHOOKEYE_TESTS=OFF", "-DHOOKEYE_UNITY=ON"]
    further = settings.get("cmake", [])
    further = shlex.split(further) if isinstance(further, str) else list(further)
    run("cmake", "-S", ROOT, "-B", folder, *ninja, *tests, "-DHOOKEYE_PYTHON=ON",
        f"-DHOOKEYE_PYTHON_PROGRAM={sys.executable}", "-DHOOKEYE_PYTHON_FOLDER=lib/python3/dist-packages",
        *further)
    run("cmake", "--build", folder, "-j", settings.get("jobs", jobs()), "--target", "hookeye",
        "hookeye_python", "helpers", "manual")
    return folder


class Wheel:
    """Files with their sums, in an order that does not depend on the disk's."""

    def __init__(self, file):
        self.zip = zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED)
        self.record = []

    def add(self, name, content, program=False):
        entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
        entry.compress_type = zipfile.ZIP_DEFLATED
        entry.external_attr = (0o100755 if program else 0o100644) << 16
        self.zip.writestr(entry, content)
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        self.record.append(f"{name},sha256={digest},{len(content)}")

    def close(self, info):
        self.record.append(f"{info}/RECORD,,")
        self.zip.writestr(zipfile.ZipInfo(f"{info}/RECORD", (1980, 1, 1, 0, 0, 0)), "\n".join(self.record) + "\n")
        self.zip.close()


def pack(installed, file):
    """`installed`: a prefix. The module goes among the packages; program, helpers, man pages and completions go
    where they stand below the environment, so that each finds the helpers."""
    name = f"hookeye-{version()}"
    wheel = Wheel(file)
    packages = installed / "lib/python3/dist-packages"
    for path in sorted(p for p in installed.rglob("*") if p.is_file()):
        inner = path.relative_to(installed)
        if packages in path.parents:
            place = str(path.relative_to(packages))
        elif inner.parts[0] == "bin":
            place = f"{name}.data/scripts/{inner.relative_to('bin')}"
        elif inner.parts[:2] != ("share", "doc"):
            place = f"{name}.data/data/{inner}"
        else:
            continue
        wheel.add(place, path.read_bytes(), program=inner.parts[0] in ("bin", "libexec"))
    info = f"{name}.dist-info"
    wheel.add(f"{info}/METADATA", metadata().encode())
    wheel.add(f"{info}/WHEEL", wheel_text().encode())
    wheel.add(f"{info}/LICENSE", (ROOT / "LICENSE").read_bytes())
    wheel.close(info)


# What pip calls.

def get_requires_for_build_wheel(config_settings=None):
    return []


get_requires_for_build_sdist = get_requires_for_build_wheel


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    info = pathlib.Path(metadata_directory) / f"hookeye-{version()}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(metadata(), encoding="utf-8")
    (info / "WHEEL").write_text(wheel_text())
    return info.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    folder = build(config_settings or {})
    file = f"hookeye-{version()}-{tag()}.whl"
    with tempfile.TemporaryDirectory(prefix="hookeye-wheel-") as installed:
        run("cmake", "--install", folder, "--prefix", installed, "--strip")
        pack(pathlib.Path(installed), pathlib.Path(wheel_directory) / file)
    return file


def build_sdist(sdist_directory, config_settings=None):
    """The sources as they stand. ./release makes the archive that carries the built page."""
    name = f"hookeye-{version()}"
    out = ("build", ".git", "node_modules", "__pycache__")
    with tarfile.open(pathlib.Path(sdist_directory) / f"{name}.tar.gz", "w:gz") as archive:
        archive.add(ROOT, name, filter=lambda one: None if one.name.split("/")[-1] in out and one.isdir() else one)
        with tempfile.NamedTemporaryFile("w", encoding="utf-8", suffix="-PKG-INFO") as told:
            told.write(metadata())
            told.flush()
            archive.add(told.name, f"{name}/PKG-INFO")
    return f"{name}.tar.gz"
