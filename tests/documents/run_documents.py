#!/usr/bin/env python3
"""Compiles and runs what README.md, docs/tutorials/*.md, docs/how-to/from_c.md and from_python.md show, and compares the
printed numbers.

    run_documents.py --build DIR --source DIR [--compiler CXX] [--flags FLAGS] [--keep DIR] [FILES...]

An HTML comment before a fenced block says what the block is:

    <!-- test: program NAME -->               C++, or C99 in a block of that language: compiled and linked as NAME
    <!-- test: python NAME -->                Python, run with the package of the source tree; its output is called NAME
    <!-- test: file PATH -->                  written to PATH in the working folder
    <!-- test: run NAME -->                   sh: executed by bash; its output is called NAME
    <!-- test: path PROGRAM -->               sh: puts PROGRAM on the search path, on which it was not
    <!-- test: output NAME [tolerance T] -->  text: what NAME prints (a program without a run block is started)

The working folder is empty but for links to the source tree; blocks of one document run in their order.
Expected lines match printed lines one by one; a line `...` stands for any number of lines. Blanks do not matter.
Text must be equal. A number x agrees with a printed y if |x - y| <= T |x| + half a unit of the last digit of x.
Unmarked sh blocks are only parsed (bash -n). Exit code 0: all agree, 1: some do not, 2: wrong usage.
"""
import argparse
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

TIME_LIMIT_S = 120
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w])")
MARK = re.compile(r"<!--\s*test:\s*(program|python|file|run|path|output)\s+(\S+)(?:\s+tolerance\s+(\S+))?\s*-->")


class Block:
    """A fenced block: `line` is that of its first line; kind "" means unmarked."""

    def __init__(self, kind, name, tolerance, language, line, text):
        self.kind, self.name, self.tolerance = kind, name, tolerance
        self.language, self.line, self.text = language, line, text


def blocksOf(text):
    """All fenced blocks in their order; raises ValueError for a mark that no block follows or that is misspelt."""
    blocks, mark, markLine = [], None, 0
    lines = text.split("\n")
    i = 0
    while i < len(lines):
        stripped = lines[i].strip()
        fence = re.match(r"(```+|~~~+)\s*(\S*)", stripped)
        if re.match(r"<!--\s*test:", stripped):
            match = MARK.fullmatch(stripped)
            if not match:
                raise ValueError(f"{i + 1}: not a mark: {stripped}")
            if mark:
                raise ValueError(f"{markLine}: no fenced block follows this mark")
            mark, markLine = match, i + 1
        elif fence:
            first = i + 1
            indent = len(lines[i]) - len(lines[i].lstrip())
            i += 1
            while i < len(lines) and not lines[i].strip().startswith(fence.group(1)):
                i += 1
            body = "\n".join(line[indent:] if not line[:indent].strip() else line for line in lines[first:i]) + "\n"
            kind, name, tolerance = mark.groups() if mark else ("", "", None)
            blocks.append(Block(kind, name, float(tolerance or 0.0), fence.group(2), first + 1, body))
            mark = None
        elif stripped and mark:
            raise ValueError(f"{markLine}: no fenced block follows this mark")
        i += 1
    if mark:
        raise ValueError(f"{markLine}: no fenced block follows this mark")
    return blocks


# ---------------------------------------------------------------- comparison

def halfUnit(number):
    """Half a unit of the last digit of a decimal number; 0 for an integer."""
    mantissa, _, exponent = number.lower().partition("e")
    _, point, fraction = mantissa.partition(".")
    if not point and not exponent:
        return 0.0
    return 0.5 * 10.0 ** (int(exponent or 0) - len(fraction))


def agree(expected, printed, tolerance):
    """"" or what differs between two lines."""
    texts = [" ".join(NUMBER.sub("#", line).split()) for line in (expected, printed)]
    if texts[0] != texts[1]:
        return f"text differs from \"{printed.strip()}\""
    for x, y in zip(NUMBER.findall(expected), NUMBER.findall(printed)):
        bound = tolerance * abs(float(x)) + halfUnit(x) * (1.0 + 1e-9)
        if not abs(float(x) - float(y)) <= bound:
            return f"{x} is documented, {y} is printed (allowed difference {bound:.3g})"
    return ""


def compare(expected, printed, tolerance):
    """(index of an expected line, what is wrong) or None."""
    wanted = expected.rstrip("\n").split("\n")
    got = [line for line in printed.split("\n")]
    while got and not got[-1].strip():
        got.pop()
    at, skipping = 0, False
    for index, line in enumerate(wanted):
        if line.strip() == "...":
            skipping = True
            continue
        if not skipping:
            why = agree(line, got[at], tolerance) if at < len(got) else "nothing more is printed"
            if why:
                return index, why
            at += 1
            continue
        reasons = [agree(line, other, tolerance) for other in got[at:]]
        if "" not in reasons:
            numeric = [r for r in reasons if not r.startswith("text")]
            return index, numeric[0] if numeric else "no printed line has this text"
        at += reasons.index("") + 1
        skipping = False
    if not skipping and at < len(got):
        return len(wanted) - 1, f"more is printed: \"{got[at].strip()}\""
    return None


# ---------------------------------------------------------------- execution

class Bench:
    """A working folder, the compiler and the environment of one document."""

    def __init__(self, options, folder):
        self.options, self.folder, self.outputs = options, folder, {}
        for name in ("scenes", "examples", "docs", "tests"):
            if (options.source / name).exists():
                (folder / name).symlink_to(options.source / name)
        (folder / "build").symlink_to(options.build)
        program = find(options.build, "supercircle")
        self.libraries = [find(options.build, f"lib{name}.so") for name in ("supercircle_box2d", "supercircle")]
        self.environment = dict(os.environ)
        self.environment["PATH"] = os.pathsep.join([str(program.parent), str(folder), os.environ.get("PATH", "")])

    def execute(self, command):
        """Standard output and "" or what went wrong. Progress goes to stderr: how much of it depends on the machine."""
        try:
            done = subprocess.run(command, cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=TIME_LIMIT_S)
        except subprocess.TimeoutExpired:
            return "", f"not done after {TIME_LIMIT_S} s"
        except OSError as error:
            return "", str(error)
        said = (done.stdout + done.stderr).rstrip()
        return done.stdout, "" if done.returncode == 0 else f"exit code {done.returncode}:\n{said}"

    def compileC(self, block):
        source = self.folder / f"{block.name}.c"
        source.write_text(block.text, encoding="utf-8")
        library = find(self.options.build, "libsupercircle_c.so")
        command = [self.options.c_compiler, "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror",
                   f"-I{self.options.source}/bridge/c/include", str(source), "-o", str(self.folder / block.name),
                   str(library), f"-Wl,-rpath,{library.parent}"]
        return self.execute(command)[1]

    def compile(self, block):
        if block.language == "c":
            return self.compileC(block)
        source = self.folder / f"{block.name}.cpp"
        source.write_text(block.text, encoding="utf-8")
        folders = [".", "plugin/api/include", "bridge/box2d/include"]
        command = [self.options.compiler, "-std=c++20", "-O1", "-Wall", "-Wextra", *shlex.split(self.options.flags)]
        command += [f"-I{self.options.source / folder}" for folder in folders]
        command += [str(source), "-o", str(self.folder / block.name), *map(str, self.libraries), "-lbox2d"]
        command += [f"-Wl,-rpath,{library.parent}" for library in self.libraries]
        return self.execute(command)[1]

    def output(self, block):
        if block.name not in self.outputs and (self.folder / block.name).is_file():
            text, why = self.execute([str(self.folder / block.name)])
            if why:
                return None, why
            self.outputs[block.name] = text
        if block.name not in self.outputs:
            return None, f"no block before this one runs \"{block.name}\""
        return self.outputs[block.name], ""

    def handle(self, block):
        """(line, what is wrong) or None."""
        if block.kind == "program":
            why = self.compile(block)
        elif block.kind == "file":
            target = self.folder / block.name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(block.text, encoding="utf-8")
            why = ""
        elif block.kind == "python":
            (self.folder / f"{block.name}.py").write_text(block.text, encoding="utf-8")
            self.environment["PYTHONPATH"] = str(self.options.source / "bridge/python/src")
            self.environment["PYTHONDONTWRITEBYTECODE"] = "1"
            self.environment["SUPERCIRCLE_LIBRARY"] = str(find(self.options.build, "libsupercircle_c.so").parent)
            # the system's Python has the system's NumPy
            self.outputs[block.name], why = self.execute(["/usr/bin/python3", f"{block.name}.py"])
        elif block.kind == "run":
            self.outputs[block.name], why = self.execute(["bash", "-e", "-o", "pipefail", "-c", block.text])
        elif block.kind == "path":
            script = f"PATH=/usr/bin:/bin\n{block.text}\ncommand -v {block.name} > /dev/null"
            why = "" if self.execute(["bash", "-e", "-c", script])[1] == "" else f"{block.name} is not found after this"
        elif block.kind == "output":
            text, why = self.output(block)
            if not why:
                found = compare(block.text, text, block.tolerance)
                return (block.line + found[0], found[1]) if found else None
        else:
            isShell = block.language in ("sh", "bash", "shell")
            why = self.execute(["bash", "-n", "-c", block.text])[1] if isShell else ""
        return (block.line, why) if why else None


def find(folder, name):
    """The file of that name under `folder`, the least deep one."""
    hits = [p for p in folder.rglob(name) if p.is_file()]
    if not hits:
        raise FileNotFoundError(f"{folder}: there is no {name}; build it first")
    return min(hits, key=lambda p: (len(p.parts), str(p))).resolve().parent / name


def runDocument(path, options):
    """Offences of one document, as lines, and how many marked blocks it has."""
    try:
        blocks = blocksOf(path.read_text(encoding="utf-8"))
    except ValueError as error:
        return [f"{path}:{error}"], 0
    offences = []
    with tempfile.TemporaryDirectory(prefix="documents_") as temporary:
        folder = pathlib.Path(temporary)
        if options.keep:
            folder = options.keep / path.stem
            folder.mkdir(parents=True)
        bench = Bench(options, folder)
        for block in blocks:
            found = bench.handle(block)
            if found:
                offences.append(f"{path}:{found[0]}: {found[1]}")
    return offences, sum(1 for block in blocks if block.kind)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, required=True, help="build tree")
    parser.add_argument("--source", type=pathlib.Path, required=True, help="source tree")
    parser.add_argument("--compiler", default=os.environ.get("CXX", "c++"))
    parser.add_argument("--c-compiler", default=os.environ.get("CC", "cc"))
    parser.add_argument("--flags", default="", help="more flags of the compiler, in one string")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the working folders, which then stay")
    parser.add_argument("files", nargs="*", type=pathlib.Path)
    options = parser.parse_args()
    options.build, options.source = options.build.resolve(), options.source.resolve()
    if options.keep:
        options.keep = options.keep.resolve()
    files = options.files or [options.source / "README.md", *sorted((options.source / "docs/tutorials").glob("*.md")),
                              options.source / "docs/how-to/from_c.md", options.source / "docs/how-to/from_python.md"]
    failed = False
    for path in files:
        try:
            offences, marked = runDocument(path, options)
        except OSError as error:
            print(f"run_documents: {error}", file=sys.stderr)
            return 2
        print("\n".join(offences) if offences else f"{path}: {marked} marked blocks agree")
        failed = failed or bool(offences)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
