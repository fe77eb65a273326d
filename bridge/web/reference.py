#!/usr/bin/env python3
"""Makes the reference of the JavaScript package, docs/reference/javascript.md, from package/supercircle.d.ts and
bridge/c/api.json. A declaration or member without a comment is an error: the comments are the reference.

    reference.py           writes it
    reference.py --check   fails if it is not what would be written
"""
import pathlib
import re
import sys

import generate

HERE = pathlib.Path(__file__).resolve().parent
PAGE = HERE.parent.parent / "docs/reference/javascript.md"
# Sections with the declarations of each, in their order; every exported one has a place.
SECTIONS = {
    "Load": ["load", "loadLab", "drawPicture"],
    "Library": ["Supercircle"],
    "Worlds": ["World", "WorldOptions", "ShellDefinition", "BodyDefinition", "ViewOptions"],
    "Scenes": ["Scene"],
    "Parts of a world": ["Part", "Shell", "JoinOptions", "Hold", "Joint", "MouseJoint", "Force", "Body", "Zone"],
    "Events, queries, messages": ["WorldEvent", "HitPoint", "Problem", "EffectInfo", "Picture", "SupercircleError"],
    "Laboratory": ["Lab", "LabRequest", "ReplayedCurve"],
}
TYPES = ["Point", "PointLike", "Points", "Numbers", "Handle", "SceneSource", "Quality", "Source", "Content"]
# Records of the C interface that come back or are given.
RECORDS = {"Frame": "What a step did.", "Energy": "Energy balance of the shells since the world was made.",
           "ShellState": "A shell as a whole.", "Section": "One place of a shell.", "Material": "What `Shell.setMaterial` changes.",
           "Filter": "Collision filter, as in Box2D.", "Target": "Where a hold or the end of a tether goes.",
           "Reaction": "Force and torque of a hold or joint.", "BodyState": "A rigid body.", "Sleep": "When shells at rest fall asleep.",
           "Recovery": "What becomes of quarantined shells.", "EventSettings": "What counts as an event."}
# Members whose name says it in C.
PLAIN = {"userData": "a number of yours, 64 bits", "arcB": "arc fraction on b", "quarantined": "whether it is", "asleep": "whether it is",
         "awake": "whether it is"}


def statements(text):
    """(comment, statement) one after the other; a statement ends at its `;`, or with the braces of an interface or class."""
    found, comment, at = [], "", 0
    while True:
        at = re.compile(r"(?:\s|//[^\n]*\n)*").match(text, at).end()
        if at >= len(text):
            return found
        if text.startswith("/**", at):
            end = text.index("*/", at)
            comment = " ".join(re.sub(r"^ *\* ?", "", line).strip() for line in text[at + 3:end].split("\n")).strip()
            at = end + 2
            continue
        depth, end = 0, at
        while text[end] != ";" or depth > 0:
            depth += {"(": 1, "{": 1, "[": 1, ")": -1, "}": -1, "]": -1}.get(text[end], 0)
            end += 1
            if text[end - 1] == "}" and depth == 0 and re.match(r"export (interface|class) ", text[at:end]):
                break
            if end == len(text):
                break
        found.append((comment, text[at:end].strip()))
        comment, at = "", end + (text[end:end + 1] == ";")


def body(text):
    """What stands between the first brace and its partner, which is the last one."""
    return text[text.index("{") + 1:text.rindex("}")]


class Declaration:
    def __init__(self, comment, text):
        self.about = comment
        self.kind, self.name = re.match(r"(?:export )?(?:declare )?(type|interface|class|function) (\w+)", text).groups()
        self.text = re.sub(r"^export ", "", text)
        self.base = (re.match(r"\w+ \w+ extends (\w+)", self.text) or [None, None])[1]
        self.alias = self.text.partition("=")[2].strip() if self.kind == "type" else ""
        own = self.kind in ("interface", "class") or self.alias.startswith("Omit<")
        self.members = members(body(self.alias or self.text)) if own and "{" in self.text else []


class Member:
    def __init__(self, name, signature, kind, about):
        self.name, self.signature, self.kind, self.about = name, signature, kind, about


def tidy(text):
    """A type or signature on one line, without comments; the remarks of an object in it, by member."""
    remarks = [(name, about) for about, name in re.findall(r"/\*\* (.*?) \*/ (\w+)", text, re.S)]
    text = " ".join(re.sub(r"/\*\*.*?\*/", "", text, flags=re.S).split())
    return text, "".join(f"<br>`{name}`: {about}" for name, about in remarks)


def members(text):
    found = []
    for comment, line in statements(text):
        line, remarks = tidy(line)
        comment = comment + remarks
        accessor = re.match(r"(get|set) (\w+)\((?:\w+: .*)?\)(?:: (.*))?$", line)
        call = re.match(r"(new |\w+)\s*\((.*)\): (.*)$", line)
        if accessor and accessor[1] == "set":
            found[-1].about = found[-1].about.rstrip(".") + (". " if found[-1].about else "") + "May be set."
            continue
        if accessor:
            found.append(Member(accessor[2], accessor[2], accessor[3], comment))
        elif call and not line.startswith("readonly"):
            found.append(Member(call[1].strip(), f"{call[1].strip()}({call[2]})", call[3], comment))
        elif re.match(r"\[key", line):
            continue
        else:
            name, kind = re.match(r"(?:readonly )?(\w+\??): (.*)$", line).groups()
            if kind.startswith("{ new "):
                for m in members(body(kind_with_comments(text, name))):
                    own = m.signature.replace("new(", f"new {name}(") if m.name == "new" else f"{name}.{m.signature}"
                    found.append(Member(f"{name}.{m.name}", own, m.kind, m.about))
            elif kind.startswith("abstract new"):
                found.append(Member(name, name, "class", comment))
            else:
                found.append(Member(name.rstrip("?"), name, kind, comment))
    return found


def kind_with_comments(text, name):
    """The object type of a member as it stands, with the comments inside."""
    begin = re.search(rf"readonly {name}: ", text).end()
    depth = 0
    for end in range(begin, len(text)):
        depth += {"{": 1, "}": -1}.get(text[end], 0)
        if text[end] == "}" and depth == 0:
            return text[begin:end + 1]
    raise ValueError(name)


class Package:
    def __init__(self):
        self.all = {}
        api = generate.Api()
        for text in ((HERE / "package/supercircle.d.ts").read_text(), generate.types(api)):
            for comment, statement in statements(text):
                d = Declaration(comment, statement)
                self.all[d.name] = d
        self.undescribed = []

    def members(self, name):
        """Those of a declaration; of `Omit<Partial<Record>, names> & { ... }` the record's, with its own in front."""
        d = self.all[name]
        inner = re.match(r"Omit<(?:Partial<)?(\w+)>?, ([^>]*)>", d.alias)
        if not inner:
            return d.members
        left_out = set(re.findall(r'"(\w+)"', inner[2])) | {m.name for m in d.members}
        optional = "?" if "Partial<" in d.alias else ""
        rest = [Member(m.name, m.name + optional, m.kind, m.about) for m in self.all[inner[1]].members if m.name not in left_out]
        return d.members + rest

    def row(self, owner, m):
        about = m.about or PLAIN.get(m.name, "")
        if not about:
            self.undescribed.append(f"{owner}.{m.name}")
        return f"| {code(m.signature)} | {code(m.kind)} | {cell(about)} |"


def code(text):
    text = re.sub(r'Global<"(\w+)">', r"\1", text).replace("Compilable", "ArrayBuffer | ArrayBufferView | Response | WebAssembly.Module", 1)
    return f"`{text.replace('Compilable', '...')}`".replace("|", "\\|")


def cell(text):
    """A comment in a cell; documents that it names become links."""
    text = text.replace("|", "\\|").replace("<br>", "\0").replace("<", "&lt;").replace("\0", "<br>")
    return re.sub(r"docs/reference/(\w+)\.md", lambda m: f"[{m[1].replace('_', ' ')}]({m[1]}.md)", text)


def table(package, name):
    listed = package.members(name)
    classes = [m for m in listed if m.kind == "class"]
    gives = "gives" if any("(" in m.signature for m in listed) else "type"
    rows = ["", f"| member | {gives} | meaning |", "|---|---|---|"]
    rows += [package.row(name, m) for m in listed if m.kind != "class"]
    if classes:
        rows.append(f"| {', '.join(code(m.name) for m in classes)} | classes | For `instanceof`. |")
    return rows


def page():
    package = Package()
    program = re.search(r"```js\n.*?```", (HERE / "package/README.md").read_text(), re.S).group()
    out = ["# JavaScript", "", "Made by `bridge/web/reference.py` from the types of the package. [From JavaScript](../how-to/from_javascript.md) shows how to begin.", "",
           program, "", "Units are SI, angles in rad. A `?` marks what may be left out. Arrays are copies; a list of points has x and y in turn.",
           "A refused call throws a `SupercircleError` and changes nothing.", ""]
    for section, names in SECTIONS.items():
        out += [f"## {section}", ""]
        functions = [package.all[n] for n in names if package.all[n].kind == "function"]
        if functions:
            out += ["| function | gives | meaning |", "|---|---|---|"]
            for f in functions:
                signature, kind = re.match(r"function (.*?\)): ((?:Promise|void).*)$", tidy(f.text)[0]).groups()
                about = re.sub(r" ?@param (\w+)", r"<br>`\1`:", f.about)
                out.append(f"| {code(signature)} | {code(kind)} | {cell(about)} |")
                package.undescribed += [] if f.about else [f.name]
            out.append("")
        for name in names:
            d = package.all[name]
            if d.kind == "function":
                continue
            package.undescribed += [] if d.about else [name]
            base = f" It is a [{d.base}](#{d.base.lower()}), too." if d.base in package.all else ""
            out += [f"### {name}", "", cell(d.about) + base] + table(package, name) + [""]
    out += ["## Records", "", "Plain objects, as the [C interface](c.md) has them, in camel case.", ""]
    for name, about in RECORDS.items():
        out += [f"### {name}", "", about] + table(package, name) + [""]
    out += ["## Types", "", "| type | is | meaning |", "|---|---|---|"]
    for name in TYPES:
        package.undescribed += [] if package.all[name].about else [name]
        out.append(f"| {code(name)} | {code(tidy(package.all[name].alias)[0])} | {cell(package.all[name].about)} |")
    out += ["", "`ShellDef`, `BodyDef` and `View` are a `ShellDefinition`, a `BodyDefinition` and `ViewOptions` with every number given.", "",
            "## The C interface", "", f"`sc.calls` has the {len(generate.Api().calls)} calls of [supercircle.h](c.md) by their names, and `sc.constants` its constants.",
            "The arguments are those of C without buffers and results: these come back, several of them as an object.",
            "Structs are objects with members in camel case. Handles have 64 bits: a `bigint`, or an object with an `id`.", ""]
    placed = {n for names in SECTIONS.values() for n in names} | set(TYPES) | {"Calls", "Constants"}
    own = {d.name for c, s in statements((HERE / "package/supercircle.d.ts").read_text()) if s.startswith("export") for d in [Declaration(c, s)]}
    return "\n".join(out), sorted(package.undescribed) + sorted(f"{n}: in no section" for n in own - placed)


def main():
    text, faults = page()
    for fault in faults:
        print(f"supercircle.d.ts: {fault}: no comment" if "section" not in fault else f"reference.py: {fault}", file=sys.stderr)
    if faults:
        return 1
    if PAGE.exists() and PAGE.read_text() == text:
        return 0
    if "--check" in sys.argv[1:]:
        print(f"{PAGE.name} is not up to date: run bridge/web/reference.py", file=sys.stderr)
        return 1
    PAGE.write_text(text)
    print(f"wrote {PAGE.name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
