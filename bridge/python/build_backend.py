"""Build backend (PEP 517, PEP 660) without dependencies: a wheel is a zip file of src/supercircle and four texts."""

import base64
import hashlib
import pathlib
import re
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
PACKAGE = HERE / "src/supercircle"
VERSION = re.search(r'__version__ = "(.*)"', (PACKAGE / "__init__.py").read_text())[1]
METADATA = f"""Metadata-Version: 2.1
Name: supercircle
Version: {VERSION}
Summary: Flexible open shells in 2D: worlds, laboratory, diagnosis of recordings
License: MIT
Requires-Python: >=3.11
Requires-Dist: numpy
"""


def wheel(directory, files):
    info = f"supercircle-{VERSION}.dist-info"
    name = f"supercircle-{VERSION}-py3-none-any.whl"
    files = {**files, f"{info}/METADATA": METADATA.encode(),
             f"{info}/WHEEL": b"Wheel-Version: 1.0\nGenerator: supercircle\nRoot-Is-Purelib: true\nTag: py3-none-any\n"}
    record = []
    with zipfile.ZipFile(pathlib.Path(directory) / name, "w", zipfile.ZIP_DEFLATED) as out:
        for path, content in files.items():
            out.writestr(path, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f"{path},sha256={digest},{len(content)}")
        out.writestr(f"{info}/RECORD", "\n".join(record + [f"{info}/RECORD,,"]) + "\n")
    return name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    files = {f"supercircle/{p.name}": p.read_bytes() for p in sorted(PACKAGE.iterdir()) if p.is_file()}
    files["supercircle/_checkout.txt"] = str(HERE.parent.parent).encode()  # its build folder has the library
    return wheel(wheel_directory, files)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    return wheel(wheel_directory, {"supercircle.pth": f"{PACKAGE.parent}\n".encode()})
