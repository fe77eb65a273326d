"""pip install into a virtual environment, without a network; Debian's Python refuses to be installed into."""

import os
import pathlib
import subprocess
import sys

import pytest

SOURCE = pathlib.Path(__file__).resolve().parents[3]
PROJECT = SOURCE / "bridge/python"
CODE = "import supercircle as sc; print(sc.version(), sc.__file__); sc.World().step()"


def run(*command, **more):
    # without the variable the library is found in the build folder of the checkout that the wheel notes
    left_out = {"PYTHONPATH"} | ({"SUPERCIRCLE_LIBRARY"} if (SOURCE / "build/libsupercircle_c.so.0").exists() else set())
    environment = {k: v for k, v in os.environ.items() if k not in left_out}
    environment.update(PIP_NO_INDEX="1", PIP_DISABLE_PIP_VERSION_CHECK="1", PIP_NO_INPUT="1")
    return subprocess.run([str(c) for c in command], env=environment, capture_output=True, text=True, **more)


def test_pip_installs_into_a_virtual_environment_without_a_network(tmp_path):
    before = sorted(p.name for p in PROJECT.iterdir())
    made = run(sys.executable, "-m", "venv", "--system-site-packages", tmp_path / ".venv")
    assert made.returncode == 0, made.stdout + made.stderr
    python = tmp_path / ".venv/bin/python"
    installed = run(tmp_path / ".venv/bin/pip", "install", PROJECT)
    assert installed.returncode == 0, installed.stdout + installed.stderr
    found = run(python, "-c", CODE, cwd=tmp_path)
    assert found.returncode == 0 and str(tmp_path) in found.stdout, found.stdout + found.stderr
    # editable: the sources themselves
    assert run(tmp_path / ".venv/bin/pip", "install", "--editable", PROJECT).returncode == 0
    assert str(PROJECT / "src") in run(python, "-c", CODE, cwd=tmp_path).stdout
    assert sorted(p.name for p in PROJECT.iterdir()) == before  # nothing is left in the tree


@pytest.mark.skipif(not list(pathlib.Path("/usr/lib").glob("python3.*/EXTERNALLY-MANAGED")), reason="not Debian's Python")
def test_debian_refuses_pip_without_a_virtual_environment():
    refused = run("/usr/bin/python3", "-m", "pip", "install", "--dry-run", PROJECT)
    assert refused.returncode != 0 and ("externally-managed" in refused.stderr or "No module named pip" in refused.stderr)
