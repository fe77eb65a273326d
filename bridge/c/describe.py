#!/usr/bin/env python3
"""Describes the C interface for other languages, from its headers and the library's own sc_layout().

    describe.py                       writes bridge/c/layout.inc and tests/bridge/c/calls.inc (needs the headers only)
    describe.py --library LIB         writes bridge/c/api.json and docs/reference/c.md, too
    describe.py --library LIB --check fails if one of the four is not what would be written

api.json has, for each header in the order of the text:
  constants  {"name", "value", "about"}            enumerators and SC_API_VERSION
  callbacks  {"name", "type", "header"}             pointers to functions, such as "int32_t(*)(void* context)"
  handles    ["sc_world", ...]                     structs with the one member `uint64_t id`
  structs    {"name", "size", "members": [{"name", "type", "offset", "about"}]}
  calls      {"name", "returns", "parameters": [{"name", "type"}], "about", "section", "header"}
Types are C's without spaces before `*`: "const sc_point*".
"""
import argparse
import ctypes
import json
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
TOP = HERE.parent.parent
HEADERS = ["supercircle.h", "supercircle_box2d.h", "supercircle_lab.h"]
SECTION = re.compile(r"/\* ---- (.*?) \*/", re.S)
TOKEN = re.compile(r"/\* ---- .*? \*/|///[^\n]*|typedef struct (\w+) \{.*?\} \1;|typedef [^;{]*\(\*\w+\)[^;]*;|enum \{.*?\};|^SC_API [^;]*;", re.S | re.M)


def normalType(text):
    return re.sub(r"\s*\*", "*", " ".join(text.split()))


def parameter(text):
    """"const double* curvature" -> type and name."""
    kind, name = re.match(r"(.*?)(\w+)$", text.strip(), re.S).groups()
    return {"name": name, "type": normalType(kind)}


def functionPointer(text):
    """"int32_t (*progress)(void*, double)" -> type and name."""
    result, name, arguments = re.match(r"\s*(.*)\(\*(\w+)\)\((.*)\)$", text.strip(), re.S).groups()
    return {"name": name, "type": f"{normalType(result)}(*)({normalType(arguments)})"}


def split(text):
    """Splits parameters at the commas outside of parentheses."""
    parts, depth = [""], 0
    for c in text:
        depth += (c == "(") - (c == ")")
        if c == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += c
    return parts


def readStruct(name, body):
    members, about = [], ""
    for line in body.split("\n"):
        code, _, comment = line.partition("///<")
        comment = comment.strip()
        match = re.match(r"\s*([\w ]+?[\s*]+)(\w+);", code)
        if match:
            members.append({"name": match[2], "type": normalType(match[1]), "about": comment})
        elif members and line.strip().startswith("///<"):
            members[-1]["about"] += " " + comment
    return {"name": name, "members": members}


def readEnum(body, constants):
    value = -1
    for item in re.finditer(r"(\w+)(?:\s*=\s*(\d+))?\s*,?\s*(?:///<([^\n]*))?", body):
        value = int(item[2]) if item[2] else value + 1
        constants.append({"name": item[1], "value": value, "about": (item[3] or "").strip()})


def read(header, api):
    text = (HERE / "include" / header).read_text()
    version = re.search(r"#define SC_API_VERSION (\d+)", text)
    if version:
        api["constants"].append({"name": "SC_API_VERSION", "value": int(version[1]), "about": "Version of the binary interface"})
    section, about = "", []
    for match in TOKEN.finditer(text):
        token = match[0]
        if token.startswith("/*"):
            section, about = SECTION.match(token)[1], []
        elif token.startswith("///"):
            if not token.startswith("///<"):
                about.append(token[3:].strip())
            continue
        elif token.startswith("typedef") and "(*" in token:
            pointer = functionPointer(token.removeprefix("typedef").rstrip(";"))
            api["callbacks"].append({"name": pointer["name"], "type": pointer["type"], "header": header})
        elif token.startswith("typedef"):
            struct = readStruct(match[1], token[token.index("{") + 1:token.rindex("}")])
            if [m["name"] for m in struct["members"]] == ["id"]:
                api["handles"].append(struct["name"])
            api["structs"].append(struct)
        elif token.startswith("enum"):
            readEnum(token[token.index("{") + 1:token.rindex("}")], api["constants"])
        else:
            head, arguments = re.match(r"SC_API ([^(]*)\((.*)\);$", token, re.S).groups()
            call = parameter(head)
            parts = [] if arguments.strip() in ("", "void") else split(arguments)
            api["calls"].append({"name": call["name"], "returns": call["type"],
                                 "parameters": [parameter(p) for p in parts],
                                 "about": " ".join(about), "section": section, "header": header})
        about = []


def layoutInc(api):
    lines = ["// Made by bridge/c/describe.py from the headers: structs and members, for layout.cpp.", "// clang-format off"]
    for struct in api["structs"]:
        lines.append(f"STRUCT({struct['name']})")
        lines += [f"MEMBER({struct['name']}, {m['name']})" for m in struct["members"]]
        lines.append("END()")
    return "\n".join(lines) + "\n"


def callsInc(api):
    lines = ["// Made by bridge/c/describe.py: the calls that a test makes with any arguments."]
    lines += [f"CALL({c['name']})" for c in api["calls"] if c["header"] == HEADERS[0] and c["name"] not in ("sc_alloc", "sc_free")]
    return "\n".join(lines) + "\n"


def addLayout(api, library):
    lib = ctypes.CDLL(str(library))
    lib.sc_layout.restype = ctypes.c_char_p
    layout = json.loads(lib.sc_layout())
    for struct in api["structs"]:
        known = layout[struct["name"]]
        struct["size"] = known["size"]
        for member in struct["members"]:
            member["offset"] = known["members"][member["name"]]
    names = {s["name"] for s in api["structs"]}
    if names != set(layout):
        sys.exit(f"describe.py: sc_layout() and the headers have other structs: {sorted(names ^ set(layout))}")


def reference(api):
    cell = lambda text: text.replace("|", "\\|")
    out = ["# The C interface, call by call", "", "Made by `bridge/c/describe.py` from the headers; [From C](../how-to/from_c.md) shows a program.",
           "The head of `supercircle.h` states the rules: statuses, handles, buffers, versions, threads.", ""]
    last = None
    for call in api["calls"]:
        if (call["header"], call["section"]) != last:
            last = (call["header"], call["section"])
            title = call["section"].split(":")[0].split(";")[0] or call["header"]
            out += ["" if len(out) > 6 else None, f"## {call['header'].removesuffix('.h')}: {title}" if call["header"] != HEADERS[0] else f"## {title[0].upper() + title[1:]}", "",
                    "| call | what it does |", "|---|---|"]
        arguments = ", ".join(f"{p['type']} {p['name']}" for p in call["parameters"])
        out.append(f"| `{call['returns']} {call['name']}({arguments})` | {cell(call['about'])} |")
    out += ["", "## Structs", "", "| struct | bytes | members |", "|---|---|---|"]
    for struct in api["structs"]:
        if struct["name"] not in api["handles"]:
            members = "; ".join(f"`{m['name']}`" + (f" {cell(m['about'])}" if m["about"] else "") for m in struct["members"])
            out.append(f"| `{struct['name']}` | {struct['size']} | {members} |")
    out += ["", "## Constants", "", "| constant | value | meaning |", "|---|---|---|"]
    out += [f"| `{c['name']}` | {c['value']} | {cell(c['about'])} |" for c in api["constants"]]
    return "\n".join(line for line in out if line is not None) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--library", type=pathlib.Path)
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    api = {"constants": [], "handles": [], "callbacks": [], "structs": [], "calls": []}
    for header in HEADERS:
        if (HERE / "include" / header).exists():
            read(header, api)
    files = {HERE / "layout.inc": layoutInc(api), TOP / "tests/bridge/c/calls.inc": callsInc(api)}
    if arguments.library:
        addLayout(api, arguments.library)
        files[HERE / "api.json"] = json.dumps(api, indent=1) + "\n"
        files[TOP / "docs/reference/c.md"] = reference(api)
    stale = [path for path, text in files.items() if not path.exists() or path.read_text() != text]
    if arguments.check:
        for path in stale:
            print(f"{path.relative_to(TOP)} is not that of the headers: run bridge/c/describe.py --library LIB", file=sys.stderr)
        return 1 if stale else 0
    for path in stale:
        path.write_text(files[path])
        print(f"wrote {path.relative_to(TOP)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
