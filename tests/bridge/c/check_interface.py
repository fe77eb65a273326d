#!/usr/bin/env python3
"""Whether the C interface is complete and described: check_interface.py --source DIR --library LIB [--lab LIB]

- api.json, layout.inc and docs/reference/c.md are those that bridge/c/describe.py makes from headers and library.
- The libraries export the calls of the headers and nothing else (nm -D).
- Every public C++ call is called in bridge/c or has a line with a reason in bridge/c/left_out.txt; each line is needed.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys

HEADERS = ["plugin/api/include/supercircle/*.hpp", "bridge/box2d/include/supercircle/*.hpp"]
WHOLE = {"DebugDraw", "DrawAdapter", "ShellProxies"}  # classes left out as a whole
KEYWORDS = {"operator", "if", "for", "return", "using", "friend", "static_assert", "explicit", "switch", "alignas"}


def publicCalls(text):
    """(class or "", name) of the calls that a formatted header declares, without constructors and operators."""
    found, owner, public = set(), "", True
    for line in text.splitlines():
        line = line.partition("//")[0].rstrip()
        begun = re.match(r"(class|struct) (?:\[\[.*?\]\] )?(\w+)[^;]*$", line)
        if begun:
            owner, public = begun[2], begun[1] == "struct"
        elif re.match(r"\};?$", line):
            owner, public = "", True
        elif re.match(r"(public|private|protected):", line):
            public = line.startswith("public")
        indent = len(line) - len(line.lstrip())
        if begun or not public or indent != (4 if owner else 0) or "deprecated" in line or line.startswith("#"):
            continue
        code = re.sub(r"\[\[.*?\]\]", "", line)
        while re.search(r"<[^<>]*>", code):
            code = re.sub(r"<[^<>]*>", "", code)
        name = re.search(r"(~?\w+)\(", code)
        words = set(re.findall(r"\w+", code[:name.start()])) if name else set()
        if name and name[1] not in KEYWORDS | {owner, "~" + owner} and not words & KEYWORDS and "=" not in code[:name.start()]:
            found.add((owner, name[1]))
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--source", type=pathlib.Path, required=True)
    parser.add_argument("--library", type=pathlib.Path, required=True)
    parser.add_argument("--lab", type=pathlib.Path)
    a = parser.parse_args()
    problems = []
    describe = subprocess.run([sys.executable, a.source / "bridge/c/describe.py", "--library", a.library, "--check"],
                              capture_output=True, text=True)
    if describe.returncode != 0:
        problems.append(describe.stderr.strip())

    api = json.loads((a.source / "bridge/c/api.json").read_text())
    for library, mine in ((a.library, lambda h: h != "supercircle_lab.h"), (a.lab, lambda h: h == "supercircle_lab.h")):
        if library is None:
            continue
        lines = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True).stdout
        exported = {line.split()[-1] for line in lines.splitlines()}
        declared = {c["name"] for c in api["calls"] if mine(c["header"])}
        for name in sorted(exported ^ declared):
            problems.append(f"{library.name}: {name} is {'exported but in no header' if name in exported else 'declared but not exported'}")

    reasons = {}
    for line in (a.source / "bridge/c/left_out.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            key, _, reason = line.partition(": ")
            reasons[key] = reason
            if len(reason.split()) < 3:
                problems.append(f"left_out.txt: {key} has no reason")
    ours = "\n".join(p.read_text() for p in (a.source / "bridge/c").glob("*.cpp"))
    needed = set()
    calls = set()
    for pattern in HEADERS:
        for header in sorted(a.source.glob(pattern)):
            if header.name != "deprecated.hpp":
                calls |= publicCalls(header.read_text())
    if len(calls) < 100:
        problems.append(f"only {len(calls)} public calls were found: this check reads the headers wrongly")
    for owner, name in sorted(calls):
        key = f"{owner}::{name}" if owner else name
        if owner in WHOLE:
            key = owner
        if key in reasons:
            needed.add(key)
        elif not re.search(rf"\b{name}\(", ours):
            problems.append(f"{key} has no C call: write one, or a line with the reason into bridge/c/left_out.txt")
    for key in sorted(set(reasons) - needed):
        problems.append(f"left_out.txt: there is no public call {key}")
    print("\n".join(problems) or f"{len(calls)} public C++ calls, {len(api['calls'])} C calls")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
