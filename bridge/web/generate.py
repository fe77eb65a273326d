#!/usr/bin/env python3
"""Makes the JavaScript package from bridge/c/api.json and the sources beside this script.

    generate.py --exports FILE                                the exports of the module, one a line, for the linker
    generate.py --package FOLDER --wasm FILE... --version X.Y.Z  supercircle.mjs, supercircle.js (classic script),
                                                              supercircle.d.ts, the modules, package.json, README.md,
                                                              LICENSE, THIRD_PARTY.txt

A new call of the C interface gets into `calls`, its types and the exports by running this script.
"""
import argparse
import json
import pathlib
import re
import shutil

HERE = pathlib.Path(__file__).resolve().parent
HEADER = "supercircle.h"
# In this order: a source uses those above it.
PUBLIC = ["load", "loadLab", "drawPicture", "SupercircleError"]
SOURCES = ["../../plugin/graphics/picture/canvas.js", "loader/loader.js", "loader/calls.js", "package/parts.js", "package/world.js", "package/library.js",
           "package/laboratory.js"]
NUMBERS = {"double": ("d", "number"), "int32_t": ("i", "number"), "uint32_t": ("w", "number"), "uint64_t": ("u", "bigint")}
ARRAYS = {"double": "Float64Array", "float": "Float32Array", "int32_t": "Int32Array", "uint8_t": "Uint8Array", "sc_point": "Float64Array"}
# Numbers in a struct that say yes or no, and 64-bit members that are more than a count.
GIVEN = {"uint8_t": "Uint8Array", "sc_point": "Points"}  # arrays that are given
FLAG = re.compile(r"^1: ")
FLAGS = {"quarantined", "asleep", "awake"}
WIDE = {"id", "user_data"}


def camel(name):
    head, *rest = name.split("_")
    return head + "".join(part.capitalize() for part in rest)


def record(struct):
    """Name of a struct in JavaScript: sc_shell_def is ShellDef."""
    return "".join(part.capitalize() for part in struct.removeprefix("sc_").split("_"))


class Api:
    def __init__(self):
        everything = json.loads((HERE.parent / "c/api.json").read_text())
        self.constants = everything["constants"]
        self.handles = set(everything["handles"])
        self.calls = [c for c in everything["calls"] if c["header"] == HEADER]
        self.structs = {s["name"]: s for s in everything["structs"]}

    def member(self, struct, m):
        """(letter, TypeScript type) of a member: d number, i integer, w whole number, f yes or no, n counter, u 64 bits, h handle, a struct."""
        kind = m["type"]
        if kind in self.handles:
            return "h", "Handle"
        if kind in self.structs:
            return kind, "Point" if kind == "sc_point" else record(kind)
        if kind in ("int32_t", "uint32_t") and (FLAG.match(m["about"]) or (struct["name"].endswith("_state") and m["name"] in FLAGS)):
            return "f", "boolean"
        if kind == "uint64_t":
            return ("u", "bigint") if m["name"] in WIDE else ("n", "number")
        return NUMBERS[kind]

    def members(self, struct):
        return [m for m in struct["members"] if m["name"] not in ("reserved", "size")]

    def value(self, kind):
        """TypeScript type of a C value that is read."""
        return "bigint" if kind in self.handles or kind == "uint64_t" else "Point" if kind == "sc_point" else \
            record(kind) if kind in self.structs else NUMBERS[kind][1]

    def parameters(self, call):
        """(name, token, TypeScript type of what is given or None, of what comes back or None) of each argument of a call."""
        out, rest = [], list(call["parameters"])
        init = call["name"].endswith("_init")
        while rest:
            p = rest.pop(0)
            kind, name = p["type"], camel(p["name"])
            follows = rest[0]["name"] if rest and rest[0]["type"] == "int32_t" else ""
            target = kind.removeprefix("const ").removesuffix("*")
            constant = kind.startswith("const ")
            if kind in self.handles:
                out.append((name, "u", "Handle", None))
            elif kind == "sc_point":
                out.append((name, "p", "PointLike", None))
            elif kind in NUMBERS:
                out.append((name, NUMBERS[kind][0], "number | bigint" if kind == "uint64_t" else "number", None))
            elif kind == "const char*" and follows == "bytes":
                rest.pop(0)
                out.append((name, "T", "string", None))
            elif kind == "const char*":
                out.append((name, "t", "string | null", None))
            elif constant and re.search(r"(^|_)count$", follows):
                rest.pop(0)
                out.append((name, "]" + target, GIVEN.get(target, "Numbers"), None))
            elif constant:
                out.append((name, "<" + target, f"Partial<{record(target)}> | null", None))
            elif follows == "capacity":
                rest.pop(0)
                back = ARRAYS.get(target) or ("bigint[]" if target in self.handles else record(target) + "[]")
                out.append((name, "[" + target, None, back))
            elif target == "int32_t" and call["returns"].endswith("*"):
                out.append((name, "c", None, None))
            elif target == "void":
                out.append((name, "i", "number", None))
            elif target in self.structs and self.structs[target]["members"][0]["name"] == "size" and not init:
                out.append((name, "=" + target, f"Partial<{record(target)}>", record(target)))
            else:
                out.append((name, ">" + target, None, self.value(target)))
        return out

    def answer(self, call, parts):
        """(letter, TypeScript type or None) of what a call returns by itself."""
        kind = call["returns"]
        if kind == "sc_status":
            return "s", None
        if kind == "void":
            return "v", None
        if kind == "const char*":
            return ("b", "string") if any(p[1] == "c" for p in parts) else ("t", "string")
        if kind == "void*":
            return "i", "number"
        if kind.endswith("*"):
            target = kind.removeprefix("const ").removesuffix("*")
            return "*" + target, ARRAYS[target]
        if any(p[1].startswith("[") for p in parts):
            return "n", None
        return NUMBERS[kind][0], NUMBERS[kind][1]


def table(api):
    """Constants, layouts and calls as the loader reads them (loader/calls.js)."""
    constants = ", ".join(f"{c['name']}: {c['value']}" for c in api.constants if not c["name"].startswith("SC_LAB"))
    lines = ["// Made by bridge/web/generate.py from bridge/c/api.json.", f"const CONSTANTS = {{ {constants} }};",
             "// struct: bytes (+: it begins with its size), then name:kind:offset of its members", "const STRUCTS = {"]
    for struct in api.structs.values():
        members = [f"{camel(m['name'])}:{api.member(struct, m)[0]}:{m['offset']}" for m in api.members(struct)]
        lines.append(f"  {struct['name']}: \"{' '.join([str(struct['size']) + ('+' if struct['members'][0]['name'] == 'size' else '')] + members)}\",")
    lines += ["};", "// call: what it returns, then name:kind of its arguments", "const CALLS = {"]
    for call in api.calls:
        parts = api.parameters(call)
        lines.append(f"  {call['name']}: \"{' '.join([api.answer(call, parts)[0]] + [f'{p[0]}:{p[1]}' for p in parts])}\",")
    return "\n".join(lines + ["};", ""])


def about(text, indent):
    return [f"{indent}/** {text} */"] if text else []


def types(api):
    """TypeScript declarations of records and calls."""
    lines = []
    for struct in api.structs.values():
        if struct["name"] in api.handles or struct["name"] == "sc_point":
            continue
        lines += ["", f"/** {struct['name']} */", f"export interface {record(struct['name'])} {{"]
        for m in api.members(struct):
            lines += about(FLAG.sub("", m["about"]), "  ") + [f"  {camel(m['name'])}: {api.member(struct, m)[1]};"]
        lines.append("}")
    lines += ["", "/** The C interface, call by call: buffers and results come back, refusals are thrown. */", "export interface Calls {"]
    for call in api.calls:
        parts = api.parameters(call)
        given = ", ".join(f"{p[0]}: {p[2]}" for p in parts if p[2])
        back = [(p[0], p[3]) for p in parts if p[3]]
        own = api.answer(call, parts)[1]
        if len(back) > 1:
            result = "{ " + "; ".join(f"{name}: {kind}" for name, kind in back) + " }"
        else:
            result = back[0][1] if back else own or "void"
        lines += about(call["about"], "  ") + [f"  {call['name']}({given}): {result};"]
    lines += ["}", "", "export interface Constants {"]
    lines += [f"  readonly {c['name']}: {c['value']};" for c in api.constants if not c["name"].startswith("SC_LAB")]
    return "\n".join(lines + ["}", ""])


def bundle(api, version, module):
    """All sources in one: an ES module, or a classic script that defines `supercircle`."""
    beside = 'new URL("./supercircle.wasm", import.meta.url)' if module else "null"
    code = [f"const BESIDE = {beside};", table(api)]
    for name in SOURCES:
        text = re.sub(r"^import [^;]*;\n", "", (HERE / name).read_text(), flags=re.M)
        code.append(re.sub(r"^export ", "", text, flags=re.M))
    # Comments are for readers of the sources; a comment begins its line.
    body = re.sub(r"^ */\*\*[^*]*(?:\*(?!/)[^*]*)*\*/\n|^ *//.*\n|^\n", "", "\n".join(code), flags=re.M)
    notice = f"// supercircle {version}: flexible open shells for 2D physics. MIT licence.\n"
    if module:
        return f"{notice}{body}\nexport {{ {', '.join(PUBLIC)} }};\n"
    return f"{notice}globalThis.supercircle = (() => {{\n\"use strict\";\n{body}\nreturn {{ {', '.join(PUBLIC)} }};\n}})();\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--exports", type=pathlib.Path)
    parser.add_argument("--package", type=pathlib.Path)
    parser.add_argument("--wasm", type=pathlib.Path, nargs="*", default=[])
    parser.add_argument("--version")
    parser.add_argument("--licences", type=pathlib.Path, nargs="*", default=[], help="of what the module contains")
    arguments = parser.parse_args()
    api = Api()
    if arguments.exports:
        text = "".join(f"_{c['name']}\n" for c in api.calls)
        if not arguments.exports.exists() or arguments.exports.read_text() != text:
            arguments.exports.write_text(text)
    if arguments.package:
        folder = arguments.package
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "supercircle.mjs").write_text(bundle(api, arguments.version, True))
        (folder / "supercircle.js").write_text(bundle(api, arguments.version, False))
        (folder / "supercircle.d.ts").write_text((HERE / "package/supercircle.d.ts").read_text() + types(api))
        (folder / "package.json").write_text((HERE / "package/package.json.in").read_text().replace("@VERSION@", arguments.version))
        shutil.copy(HERE / "package/README.md", folder)
        shutil.copy(HERE.parent.parent / "LICENSE", folder)
        for module in arguments.wasm:
            shutil.copy(module, folder)
        parts = [f"==== {path.parent.name}\n\n{path.read_text(errors='replace')}" for path in arguments.licences if path.exists()]
        (folder / "THIRD_PARTY.txt").write_text("\n\n".join(parts))


if __name__ == "__main__":
    main()
