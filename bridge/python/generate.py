#!/usr/bin/env python3
"""Makes the ctypes structures, prototypes and record classes of the Python package from bridge/c/api.json, and its
reference from the docstrings.

    generate.py           writes src/supercircle/_api.py, src/supercircle/records.py and docs/reference/python.md
    generate.py --check   fails if they are not what would be written
"""
import inspect
import json
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
PACKAGE = HERE / "src/supercircle"
SCALARS = {"double": "c_double", "int32_t": "c_int32", "uint32_t": "c_uint32", "uint64_t": "c_uint64", "sc_status": "c_int32"}
# Arrays of numbers come from NumPy, by address.
ADDRESSES = {"double", "float", "sc_point", "uint8_t", "void", "sc_shell", "sc_body"}
# Structs that users get as dataclasses, and the members of them that are yes or no.
RECORDS = {"sc_frame": "Frame", "sc_energy": "Energy", "sc_sleep": "Sleep", "sc_recovery": "Recovery", "sc_shell_state": "ShellState",
           "sc_section": "Section", "sc_filter": "Filter", "sc_target": "Target", "sc_reaction": "Reaction",
           "sc_event_settings": "EventSettings", "sc_body_state": "BodyState"}
ABOUT = {"Frame": "What a step did.", "Energy": "Energy balance of a world since it was made.", "Sleep": "When shells at rest fall asleep.",
         "Recovery": "What becomes of quarantined shells.", "ShellState": "A shell as a whole.", "Section": "One place of a shell.",
         "Filter": "Collision filter, as in Box2D.", "Target": "Where a hold or the end of a tether goes.",
         "Reaction": "Force and torque of a hold or joint.", "EventSettings": "What counts as an event.", "BodyState": "A rigid body."}
FLAGS = {("sc_frame", "budget_exhausted"), ("sc_frame", "left_out"), ("sc_sleep", "automatic"), ("sc_recovery", "release"),
         ("sc_shell_state", "quarantined"), ("sc_shell_state", "asleep"), ("sc_body_state", "awake")}
HEAD = '"""Made by bridge/python/generate.py from bridge/c/api.json: do not edit."""\n'


def ctype(text, callbacks):
    if text == "void":
        return "None"
    if text in callbacks:
        return text
    if text == "const char*":
        return "c_char_p"
    if text.endswith("*"):
        target = text.removeprefix("const ")[:-1]
        return "c_void_p" if target in ADDRESSES or target in SCALARS else f"POINTER({target})"
    return SCALARS.get(text, text)


def structures(api):
    lines = []
    for struct in api["structs"]:
        lines += ["", "", f"class {struct['name']}(Structure):"]
        for m in struct["members"]:
            python = "float" if m["type"] == "double" else "int" if m["type"] in SCALARS else m["type"]
            lines.append(f"    {m['name']}: {python}")
        fields = ", ".join(f"(\"{m['name']}\", {ctype(m['type'], ())})" for m in struct["members"])
        lines.append(f"    _fields_ = [{fields}]")
    return lines


def prototypes(api, header, callbacks):
    lines = []
    for call in api["calls"]:
        if call["header"] == header:
            arguments = "".join(ctype(p["type"], callbacks) + ", " for p in call["parameters"])
            returns = "STATUS" if call["returns"] == "sc_status" else ctype(call["returns"], callbacks)
            if returns == "c_char_p" and any(p["type"] == "int32_t*" for p in call["parameters"]):
                returns = "c_void_p"  # a text with zeros inside
            lines.append(f"    \"{call['name']}\": ({returns}, ({arguments})),")
    return lines


def low_level(api):
    callbacks = {c["name"] for c in api["callbacks"]}
    lines = [HEAD, "from __future__ import annotations", "",
             "from ctypes import CFUNCTYPE, POINTER, Structure, c_char_p, c_double, c_int32, c_uint32, c_uint64, c_void_p",
             "from typing import Any", ""]
    lines += [f"{c['name']} = {c['value']}" for c in api["constants"]]
    lines += structures(api)
    lines += ["", "", "class STATUS(c_int32):"]
    lines += ["    \"\"\"An sc_status: other than 0 the call was refused.\"\"\"", "", ""]
    for c in api["callbacks"]:
        result, arguments = c["type"].split("(*)")
        kinds = [ctype(a.strip().rpartition("*")[0] + "*" if "*" in a else a.split()[0], ()) for a in arguments.strip("()").split(",")]
        lines.append(f"{c['name']} = CFUNCTYPE({', '.join([ctype(result, ())] + kinds)})")
    lines += ["", "Prototypes = dict[str, tuple[Any, tuple[Any, ...]]]", "# name: (result, parameters)", "CALLS: Prototypes = {"]
    lines += prototypes(api, "supercircle.h", callbacks) + ["}", "LAB_CALLS: Prototypes = {"]
    lines += prototypes(api, "supercircle_lab.h", callbacks) + ["}", "# name: (bytes, offset of each member)", "LAYOUT: dict[str, tuple[int, dict[str, int]]] = {"]
    for struct in api["structs"]:
        offsets = ", ".join(f"\"{m['name']}\": {m['offset']}" for m in struct["members"])
        lines.append(f"    \"{struct['name']}\": ({struct['size']}, {{{offsets}}}),")
    return "\n".join(lines + ["}"]) + "\n"


def records(api):
    lines = [HEAD, "from __future__ import annotations", "", "from dataclasses import dataclass", "", "import numpy as np", "from numpy.typing import NDArray"]
    for struct in api["structs"]:
        name = RECORDS.get(struct["name"])
        if name is None:
            continue
        members = [m for m in struct["members"] if m["name"] != "reserved"]
        lines += ["", "", "@dataclass(frozen=True, eq=False)", f"class {name}:", f"    \"\"\"{ABOUT[name]}", ""]
        for m in members:
            shape = "x and y, shape (2,)" if m["type"] == "sc_point" else ""
            about = m["about"]
            if (struct["name"], m["name"]) in FLAGS:
                about = about.removeprefix("1: ")
            lines.append(f"    {m['name']}: {', '.join(t for t in (about, shape) if t) or 'whether it is'}")
        lines += ["    \"\"\"", ""]
        for m in members:
            python = "bool" if (struct["name"], m["name"]) in FLAGS else "float" if m["type"] == "double" else \
                "NDArray[np.float64]" if m["type"] == "sc_point" else "int"
            lines.append(f"    {m['name']}: {python}")
    return "\n".join(lines) + "\n"


# Section of the reference: its names, in their order. A test compares them with the package.
SECTIONS = {
    "Laboratory": ["run", "sweep", "check", "import_recording", "replay", "diagnose", "scenes", "effects", "check_scene"],
    "Results": ["Result", "Series", "Sweep", "Check", "Problem", "Imported", "Replay", "Curve", "Diagnosis", "Nominal", "Effect", "Estimate"],
    "Worlds": ["World", "Scene", "Shell", "Hold", "Joint", "MouseJoint", "Force", "Body", "Zone", "Hit", "Event", "DrawList", "scaled_shell", "wav"],
    "Records": list(RECORDS.values()),
    "Exceptions": ["Error", "BadInputError", "StaleError", "BusyError", "RefusedError", "FailedError", "OutOfMemoryError", "VersionError",
                   "LibraryError"],
    "Library": ["version", "library_path"],
}


def cell(text):
    """A docstring in a cell of a table: one line for each of its lines that is not continued."""
    lines = []
    for line in inspect.cleandoc(text or "").replace("|", "\\|").replace("<", "&lt;").split("\n"):
        if line.startswith(" ") and lines:
            lines[-1] += " " + line.strip()
        elif line.strip():
            lines.append(line.strip())
        elif lines:
            lines[-1] += "<br>"
    named = [f"`{line.partition(':')[0]}`:{line.partition(':')[2]}" if ": " in line and " " not in line.partition(":")[0].replace(", ", "") else line
             for line in lines]
    return "<br>".join(named).replace("<br><br>", "<br>")


def signature(name, thing):
    text = str(inspect.signature(thing)).partition(" ->")[0]
    text = re.sub(r": '([^']*)'", r": \1", text).replace(str(1 / 60), "1/60").replace("'", '"')
    text = text.replace("self, ", "").replace("self", "")
    return f"`{name}{text}`".replace("|", "\\|")


def reference():
    sys.path.insert(0, str(PACKAGE.parent))
    import supercircle as sc
    out = ["# Python", "", "Made by `bridge/python/generate.py` from the docstrings; [From Python](../how-to/from_python.md) shows how to begin.",
           "Units are SI, angles in rad. Arrays are NumPy copies.", ""]
    for section, names in SECTIONS.items():
        out += [f"## {section}", "", "| name | meaning |", "|---|---|"]
        for name in names:
            thing = getattr(sc, name)
            plain = inspect.isfunction(thing) or name in ("World",)
            out.append(f"| {signature(name, thing) if plain else f'`{name}`'} | {cell(thing.__doc__)} |")
            members = [(n, m) for n, m in vars(thing).items() if not n.startswith("_")] if inspect.isclass(thing) else []
            for n, m in members:
                if isinstance(m, property) and m.__doc__:
                    out.append(f"| `{name}.{n}` | {cell(m.__doc__)} |")
                elif inspect.isfunction(m) or isinstance(m, classmethod):
                    out.append(f"| {signature(f'{name}.{n}', getattr(thing, n))} | {cell(m.__doc__)} |")
        out.append("")
    return "\n".join(out)


def main():
    api = json.loads((HERE.parent / "c/api.json").read_text())
    files = {PACKAGE / "_api.py": low_level(api), PACKAGE / "records.py": records(api)}
    for path, text in files.items():
        if "--check" not in sys.argv[1:] and (not path.exists() or path.read_text() != text):
            path.write_text(text)
            print(f"wrote {path.name}")
    files[HERE.parent.parent / "docs/reference/python.md"] = reference()
    stale = [path for path, text in files.items() if not path.exists() or path.read_text() != text]
    if "--check" in sys.argv[1:]:
        for path in stale:
            print(f"{path.name} is not up to date: run bridge/python/generate.py", file=sys.stderr)
        return 1 if stale else 0
    for path in stale:
        path.write_text(files[path])
        print(f"wrote {path.name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
