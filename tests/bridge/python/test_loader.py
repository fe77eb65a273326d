"""The library is found in the documented places, and the wrong one is refused."""

import ctypes
import ctypes.util
import json
import os
import pathlib
import shutil
import subprocess
import sys

import pytest

import supercircle as sc
from supercircle import _api, _loader

SOURCE = pathlib.Path(__file__).resolve().parents[3]
PACKAGE = SOURCE / "bridge/python/src"
LIBRARIES = pathlib.Path(sc.library_path()).parent


def python(code, package=PACKAGE, folder=None, **environment):
    """What a fresh interpreter prints."""
    variables = {k: v for k, v in os.environ.items() if k not in ("SUPERCIRCLE_LIBRARY", "PYTHONPATH")}
    done = subprocess.run([sys.executable, "-c", code], env={**variables, "PYTHONPATH": str(package), **environment},
                          capture_output=True, text=True, cwd=folder)
    return done.stdout + done.stderr


def copied(folder):
    """The package outside of any checkout."""
    shutil.copytree(PACKAGE / "supercircle", folder / "supercircle", ignore=shutil.ignore_patterns("__pycache__"))
    return folder


def compiled(folder, code):
    (folder / "fake.c").write_text(code)
    fake = folder / "libsupercircle_c.so.0"
    subprocess.run(["cc", "-shared", "-fPIC", "-o", fake, folder / "fake.c"], check=True)
    return fake


SHOW = "import supercircle as sc; print(sc.library_path())"


def test_the_variable_names_the_library_or_its_folder(tmp_path):
    package = copied(tmp_path)
    library = LIBRARIES / "libsupercircle_c.so.0"
    assert python(SHOW, package, SUPERCIRCLE_LIBRARY=str(library)).strip() == str(library)
    assert python(SHOW, package, SUPERCIRCLE_LIBRARY=str(LIBRARIES)).strip() == str(library)
    # the laboratory's library is looked for in the same folder
    lab = "from supercircle import _loader; print(_loader.laboratory()._name)"
    assert python(lab, package, SUPERCIRCLE_LIBRARY=str(library)).strip() == str(LIBRARIES / "libsupercircle_lab_c.so.0")


def test_beside_the_package_by_the_loader_and_in_the_checkout_it_came_from(tmp_path):
    package = copied(tmp_path)
    assert python(SHOW, package, LD_LIBRARY_PATH=str(LIBRARIES)).strip() == "libsupercircle_c.so.0"
    (package / "supercircle/_checkout.txt").write_text(str(SOURCE))
    if (SOURCE / "build/libsupercircle_c.so.0").exists():
        assert python(SHOW, package).strip() == str(SOURCE / "build/libsupercircle_c.so.0")
    beside = package / "supercircle/libsupercircle_c.so.0"
    beside.symlink_to(LIBRARIES / "libsupercircle_c.so.0")
    assert python(SHOW, package).strip() == str(beside)


@pytest.mark.skipif(bool(ctypes.util.find_library("supercircle_c")), reason="the system has the library")
def test_a_missing_library_is_reported_with_all_places_and_the_remedy(tmp_path):
    printed = python(SHOW, copied(tmp_path))
    for words in ("LibraryError", "$SUPERCIRCLE_LIBRARY: not set", "beside the package", "system's loader", "checkout", "build.sh"):
        assert words in printed


def test_another_version_is_refused_with_both_numbers(tmp_path):
    fake = compiled(tmp_path, "int sc_api_version(void){return 77;} const char* sc_error(void){return \"\";}")
    printed = python(SHOW, SUPERCIRCLE_LIBRARY=str(fake))
    assert "VersionError" in printed and "version 77" in printed and f"version {_api.SC_API_VERSION}" in printed


def test_a_library_without_a_call_or_of_something_else_is_refused(tmp_path):
    fake = compiled(tmp_path, "int sc_api_version(void){return %d;} const char* sc_error(void){return \"\";}" % _api.SC_API_VERSION)
    assert "has no call sc_" in python(SHOW, SUPERCIRCLE_LIBRARY=str(fake))
    fake = compiled(tmp_path, "int other(void){return 0;}")
    assert "is no library of Supercircle" in python(SHOW, SUPERCIRCLE_LIBRARY=str(fake))


def test_structures_lie_in_memory_as_in_the_library():
    layout = json.loads(_loader.core().sc_layout())
    assert {name: (s["size"], s["members"]) for name, s in layout.items()} == _api.LAYOUT
    for name, (size, members) in _api.LAYOUT.items():
        struct = getattr(_api, name)
        assert ctypes.sizeof(struct) == size
        assert {m: getattr(struct, m).offset for m in members} == members


def test_every_call_is_used_by_the_package():
    text = "".join(p.read_text() for p in (PACKAGE / "supercircle").glob("*.py") if p.name != "_api.py")
    parts = {"shell", "hold", "joint", "mouse_joint", "force", "body", "zone", "world", "scene"}
    left_out = {"sc_alloc", "sc_free", "sc_layout", "sc_world_valid"}  # memory is Python's; a closed World says so itself
    for name in _api.CALLS.keys() - left_out:
        owner = next((p for p in sorted(parts, key=len, reverse=True) if name.startswith(f"sc_{p}_")), "")
        short = name.removeprefix(f"sc_{owner}_")
        assert name in text or f'_call("{short}"' in text, f"{name} is not used: add it to the package"


def test_the_reference_names_everything():
    sys.path.insert(0, str(SOURCE / "bridge/python"))
    import generate

    public = {n for n, v in vars(sc).items() if not n.startswith("_") and not isinstance(v, type(sys))}
    assert public == {n for names in generate.SECTIONS.values() for n in names}
    assert all(getattr(sc, n).__doc__ for n in public)


def test_a_python_without_numpy_is_told_what_to_do(tmp_path):
    (tmp_path / "numpy.py").write_text("raise ImportError('none')")
    assert "install python3-numpy" in python("import sys; sys.path.insert(0, " + repr(str(tmp_path)) + "); import supercircle")


def test_versions_agree():
    assert sc.version() == sc.__version__
