"""Makes the page: one HTML file with script, scenes and the deflated module inside, and beside it what one tab loads.

    build.py --package FOLDER --out FILE     FOLDER: where bridge/web/build.sh puts supercircle.js and supercircle.wasm
"""

import argparse
import base64
import json
import pathlib
import re
import subprocess
import zlib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
SCRIPTS = ["scenes.js", "engine.js", "pad.js", "curve.js", "goals.js", "share.js", "editor.js", "sound.js",
           "state.js", "loading.js", "hands.js", "frames.js", "recording.js", "page.js"]
TEMPLATES = {"shell": ("A shell on a cylinder", "examples/import/specimen.json", None),
             "ring": ("A ring between plates", "examples/real/ring.json", None),
             "bow": ("A strung bow", "examples/real/bow.json", None),
             "pendulum": ("A pendulum, let go", "examples/real/pendulum.json", "pendulum")}


def deflated(data: bytes) -> str:
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    return base64.b64encode(packer.compress(data) + packer.flush()).decode()


def inside_script(text: str) -> str:
    """A text that may stand in a script element."""
    return text.replace("</script", "<\\/script").replace("<!--", "<\\!--")


def recording_module(package: pathlib.Path) -> str:
    """The script that the tab "Recording" loads: second module, descriptions to begin with, and an example."""
    templates = {key: {"title": title, "specimen": (ROOT / specimen).read_text(),
                       "scene": scene and {"name": scene, "text": (ROOT / f"scenes/{scene}.json").read_text()}}
                 for key, (title, specimen, scene) in TEMPLATES.items()}
    example = {"name": "shell_on_cylinder.csv", "template": "shell",
               "base64": base64.b64encode((ROOT / "examples/import/shell_on_cylinder.csv").read_bytes()).decode()}
    content = {"templates": templates, "example": example, "wasm": deflated((package / "supercircle_lab.wasm").read_bytes())}
    return f"globalThis.recordingModule = {json.dumps(content)};\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--package", type=pathlib.Path, required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    if not (arguments.package / "supercircle.wasm").exists():
        print(f"skipped: {arguments.package} has no supercircle.wasm; bridge/web/build.sh makes it")
        raise SystemExit(77)
    order = re.findall(r"^  (\w+): \{", (HERE / "scenes.js").read_text().split("const scenes = {")[1], re.M)
    texts = {name: (ROOT / f"scenes/play/{name}.json").read_text() for name in order}
    library = (arguments.package / "supercircle.js").read_text()
    pictures = subprocess.run(["node", str(HERE / "pictures.mjs"), str(arguments.package), *order], check=True, capture_output=True,
                              text=True).stdout
    draw = (ROOT / "plugin/graphics/picture/canvas.js").read_text()
    page = "\n".join([f"const pictures = {pictures.strip()};", draw] + [(HERE / name).read_text() for name in SCRIPTS])
    parts = {
        "page.css": (HERE / "page.css").read_text(),
        "scenes": inside_script(json.dumps(texts)),
        "library": inside_script(library),
        "worker": inside_script((HERE / "worker.js").read_text()),
        "recording_worker": inside_script((HERE / "recording_worker.js").read_text()),
        "module": deflated((arguments.package / "supercircle.wasm").read_bytes()),
        "page": inside_script(page),
    }
    html = (HERE / "index.template.html").read_text()
    html = re.sub(r"\{\{([\w.]+)\}\}", lambda m: parts[m.group(1)], html)
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text(html)
    second = arguments.out.parent / "recording_module.js"
    second.write_text(recording_module(arguments.package))
    print(f"{arguments.out}: {len(html) / 1000:.0f} kB; {second.name}: {second.stat().st_size / 1000:.0f} kB, when it is used")


main()
