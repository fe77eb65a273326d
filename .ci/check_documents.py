#!/usr/bin/env python3
"""Checks how the documents and the sources are written (docs/contributing.md, docs/glossary.csv).

    check_documents.py [--table] [FILES...]   documents: sentences, paragraphs, links, diary words, glossary, places that
                                              the tables of docs/contributing.md and docs/architecture.md name
    check_documents.py --code [FILES...]      sources: glossary words in names and comments, dates and seeds in comments,
                                              long comments at the top of a file

Each offence is one line `file:line: what`. Exit code 0: none, 1: at least one, 2: wrong usage.
Counting rule: code blocks, tables, headings, images and HTML are left out; inline code and inline formulas count as
one word; a sentence ends at `. ! ?`, at a blank line, at a list item.
"""
import argparse
import csv
import fnmatch
import functools
import pathlib
import re
import sys
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent
MAX_SENTENCE = 40
MAX_MEDIAN = 20
MIN_SENTENCES_FOR_MEDIAN = 5
MAX_PARAGRAPH = 120
MAX_PARENTHESIS = 6
MAX_TOTAL = 40000
MAX_LINES_A_VERSION = 30
MAX_HEADER_COMMENT = 12

CODE_FOLDERS = ["plugin", "supercircle", "bridge", "examples", "scenes", "tests", ".ci"]
CODE_SUFFIXES = {".cpp", ".h", ".hpp", ".json", ".cmake", ".sh", ".py"}
NO_GLOSSARY = {"docs/glossary.md", "docs/reference/renamed.md", "docs/reference/javascript.md",  # camel case is JavaScript's
               "CHANGELOG.md"}

MONTHS = "January|February|March|April|May|June|July|August|September|October|November|December"
TRACES = [  # traces of one occasion: neither in documents nor in comments
    (r"\b20\d\d-\d\d-\d\d\b", "date"),
    (rf"\b(?:\d{{1,2}} )?(?:{MONTHS}) (?:\d{{1,2}}, )?20\d\d\b", "date"),
    (r"\b[Ss]eeds? 20\d\d\b", "seed"),
    (r"\b[Cc]ases? \d\d\d?\b(?! (?:%|percent|of ))", "case number"),
    (r"\b(?=[0-9a-f]*[a-f])(?=[0-9a-f]*\d)(?!\d+e\d+\b)[0-9a-f]{7,40}\b", "commit hash"),
]
DIARY = [  # words that tell a history
    (r"\b[Tt]oday(?:'s)?\b", "diary"),
    (r"\b[Yy]esterday\b", "diary"),
    (r"\b[Nn]ow\b", "diary"),
    (r"\b[Nn]o longer\b", "diary"),
    (r"\b[Uu]sed to be\b", "diary"),
    (r"\b[Uu]ntil (?:now|recently)\b", "diary"),
    (r"\b(?:was|were|been|is|are) mended\b", "diary"),
    (r"\b[Ss]o far\b(?! (?:as|that|from|apart|above|below|away)\b)", "diary"),
    (r"\b[Ll]ast (?:week|month|night)\b", "diary"),
]


# ---------------------------------------------------------------- Markdown

def isTableRule(line):
    return re.fullmatch(r"\s*\|?\s*:?-+:?\s*(\|\s*:?-+:?\s*)+\|?\s*", line) is not None


class Document:
    """Lines of a Markdown file sorted into prose blocks, headings, tables and code."""

    def __init__(self, text):
        self.lines = text.split("\n")
        self.blocks = []      # prose: (first line number, text with the line breaks kept)
        self.headings = []    # (line number, text)
        self.code = set()     # line numbers of code blocks
        self.tables = []      # (line number, text)
        self._split(self._withoutComments(text).split("\n"))

    @staticmethod
    def _withoutComments(text):
        return re.sub(r"<!--.*?-->", lambda m: "\n" * m.group().count("\n"), text, flags=re.S)

    def _split(self, lines):
        block, start = [], 0
        fence = None          # the closing mark of a code block or of a displayed formula
        blank, html = True, False
        listIndent = 0        # where the text of the present list item begins; 0 outside lists

        def flush():
            nonlocal block
            if block:
                self.blocks.append((start, "\n".join(block)))
            block = []

        if lines and lines[0] == "---":   # front matter
            end = next((i for i in range(1, len(lines)) if lines[i] == "---"), 0)
            lines = [""] * (end + 1) + lines[end + 1:]
        i = 0
        while i < len(lines):
            line, number = lines[i], i + 1
            stripped = line.strip()
            indent = len(line) - len(line.lstrip(" "))
            i += 1
            if fence:
                self.code.add(number)
                if stripped.startswith(fence) or (fence == "$$" and stripped.endswith("$$")):
                    fence = None
                continue
            opening = re.match(r"(```+|~~~+|\$\$)", stripped)
            if opening:
                flush()
                self.code.add(number)
                mark = opening.group(1)
                if not (mark == "$$" and len(stripped) > 2 and stripped.endswith("$$")):
                    fence = mark
                blank, html = False, False
                continue
            if not stripped:
                flush()
                blank, html = True, False
                continue
            if indent >= listIndent + 4 and not block and (blank or number - 1 in self.code):
                self.code.add(number)
                continue
            if html:
                continue
            if re.match(r"</?[a-zA-Z]", stripped) and not re.match(r"<(https?:|mailto:)", stripped) and not block:
                html = True
                continue
            if blank and indent < 2:
                listIndent = 0
            blank = False
            if re.match(r"#{1,6}\s", stripped):
                flush()
                self.headings.append((number, stripped.lstrip("#").strip()))
                listIndent = 0
                continue
            if stripped.startswith("|") or isTableRule(line):
                if isTableRule(line) and not stripped.startswith("|") and block:
                    self.tables.append((number - 1, block.pop()))
                flush()
                while i <= len(lines) and lines[i - 1].strip() and "|" in lines[i - 1]:
                    self.tables.append((i, lines[i - 1]))
                    i += 1
                i -= 1
                i += 1 if i < number else 0
                continue
            if re.fullmatch(r"=+|-{2,}", stripped) and len(block) == 1:
                self.headings.append((number - 1, block.pop()))
                continue
            if re.fullmatch(r"([-*_]\s*){3,}", stripped):
                flush()
                continue
            if re.match(r"\[[^\]]+\]:\s", stripped):
                flush()
                continue
            line = re.sub(r"^\s*(>\s?)+", "", line)
            item = re.match(r"(\s*)([-*+]|\d{1,3}[.)])(\s+)(\S.*)", line)
            if item:
                flush()
                listIndent = len(item.group(1)) + len(item.group(2)) + min(len(item.group(3)), 4)
                line = item.group(4)
            if not block:
                start = number
            block.append(line)
        flush()


def keepBreaks(replacement):
    return lambda m: replacement + "\n" * m.group().count("\n")


def plain(text):
    """The words that count: no images, link targets, tags; inline code and formulas as one word."""
    text = re.sub(r"(`+)(?!`).+?(?<!`)\1(?!`)", keepBreaks("CODE"), text, flags=re.S)
    text = re.sub(r"!\[[^\]]*\]\([^)]*\)", keepBreaks(" "), text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", lambda m: m.group(1) + "\n" * (m.group().count("\n") - m.group(1).count("\n")), text)
    text = re.sub(r"\[([^\]]*)\]\[[^\]]*\]", r"\1", text)
    text = re.sub(r"<(https?:|mailto:)[^>]*>", "LINK", text)
    text = re.sub(r"https?://\S+?(?=[.,;:)]*(\s|$))", "LINK", text)
    text = re.sub(r"(?<![\\\w$])\$(?=\S)[^$\n]*?\S?\$(?![\w$])", "FORMULA", text)
    text = re.sub(r"</?[a-zA-Z][^>]*>", keepBreaks(" "), text)
    return text


def isWord(token):
    return any(c.isalnum() for c in token)


def sentencesOf(document):
    """(line, words) of each sentence."""
    found = []
    for start, block in document.blocks:
        text = plain(block)
        at = 0
        for end in [m.end() for m in re.finditer(r"[.!?]+[\"')\]*_]*(?=\s|$)", text)] + [len(text)]:
            piece = text[at:end]
            words = [w for w in piece.split() if isWord(w)]
            if words:
                lead = len(piece) - len(piece.lstrip())
                found.append((start + text[:at + lead].count("\n"), words))
            at = end
    return found


def slug(heading):
    heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "")
    heading = re.sub(r"[^\w\- ]", "", heading.strip().lower())
    return heading.replace(" ", "-")


def anchorsOf(path):
    text = path.read_text(encoding="utf-8")
    document = Document(text)
    seen, anchors = {}, set()
    for _, heading in document.headings:
        name = slug(heading)
        count = seen.get(name, 0)
        seen[name] = count + 1
        anchors.add(name if count == 0 else f"{name}-{count}")
    anchors.update(re.findall(r"<a\s+(?:id|name)=\"([^\"]+)\"", text))
    return anchors


# ---------------------------------------------------------------- glossary

class Glossary:
    def __init__(self, path):
        self.rows = []  # (compiled pattern, old, new, set of kinds)
        with open(path, newline="", encoding="utf-8") as file:
            for number, row in enumerate(csv.DictReader(file), start=2):
                if None in row or row["pattern"] is None:
                    raise SystemExit(f"{path}:{number}: a row needs the four columns old,new,kind,pattern")
                if not row["pattern"]:
                    continue
                kinds = set(row["kind"].split("+"))
                try:
                    exact = re.compile(row["pattern"])
                    anyCase = re.compile(row["pattern"], re.IGNORECASE) if "prose" in kinds else exact
                    self.rows.append((exact, anyCase, row["old"], row["new"], kinds))
                except re.error as error:
                    raise SystemExit(f"{path}:{number}: pattern: {error}")

    def find(self, text, accept, prose=False):
        """What of the accepted kinds stands in the text; words in prose are found in upper and lower case."""
        for exact, anyCase, old, new, kinds in self.rows:
            if accept(kinds):
                match = (anyCase if prose else exact).search(text)
                if match:
                    yield f"\"{match.group()}\" -> \"{new}\" (glossary)"


# ---------------------------------------------------------------- documents

def documentFiles():
    files = sorted(ROOT.glob("*.md")) + sorted((ROOT / "docs").rglob("*.md"))
    return [f for f in files if "node_modules" not in f.parts]


def relative(path):
    try:
        return path.resolve().relative_to(ROOT).as_posix()
    except ValueError:
        return str(path)


def percentile(sorted_, share):
    return sorted_[min(len(sorted_) - 1, int(share * len(sorted_)))]


def median(sorted_):
    half = len(sorted_) // 2
    return sorted_[half] if len(sorted_) % 2 else (sorted_[half - 1] + sorted_[half]) / 2


def checkLengths(document, sentences):
    for line, words in sentences:
        if len(words) > MAX_SENTENCE:
            yield line, f"sentence of {len(words)} words (limit {MAX_SENTENCE}): {' '.join(words[:8])} ..."
    for start, block in document.blocks:
        text = plain(block)
        count = sum(isWord(w) for w in text.split())
        if count > MAX_PARAGRAPH:
            yield start, f"paragraph of {count} words (limit {MAX_PARAGRAPH})"
        for match in re.finditer(r"\(([^()]*)\)", text):
            count = sum(isWord(w) for w in match.group(1).split())
            if count > MAX_PARENTHESIS:
                line = start + text[:match.start()].count("\n")
                yield line, f"parenthesis of {count} words (limit {MAX_PARENTHESIS}): ({match.group(1)[:40]} ..."
    lengths = sorted(len(words) for _, words in sentences)
    if len(lengths) >= MIN_SENTENCES_FOR_MEDIAN and median(lengths) > MAX_MEDIAN:
        yield 1, f"median sentence of {median(lengths):g} words (limit {MAX_MEDIAN})"


def checkLinks(path, document):
    for number, line in enumerate(document.lines, start=1):
        if number in document.code:
            continue
        line = re.sub(r"`[^`]*`", "", line)
        targets = re.findall(r"\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)", line)
        targets += re.findall(r"^\[[^\]]+\]:\s+(\S+)", line)
        targets += re.findall(r"<(?:img|a)\s[^>]*(?:src|href)=\"([^\"]+)\"", line)
        for target in targets:
            if re.match(r"[a-z][a-z+.-]*:", target):
                continue
            name, _, anchor = target.partition("#")
            goal = (path.parent / urllib.parse.unquote(name)).resolve() if name else path.resolve()
            if not goal.exists():
                yield number, f"broken link: {target}"
            elif anchor and goal.suffix == ".md" and anchor not in anchorsOf(goal):
                yield number, f"broken link: no heading \"#{anchor}\" in {relative(goal)}"


@functools.lru_cache(maxsize=None)
def places():
    """Files and folders of the project, from its root; folders end in "/"."""
    found = [p for folder in CODE_FOLDERS + ["docs"] for p in (ROOT / folder).rglob("*")] + list(ROOT.iterdir())
    return [relative(p) + ("/" if p.is_dir() else "") for p in found]


def isPlace(name, under=""):
    """Whether a path, a file's name or a folder with "/" at its end exists; `*` stands for any characters."""
    exact = "/" in name.rstrip("/") and not name.startswith("<") and not under
    name = name.strip("<>")
    return any(fnmatch.fnmatchcase(place.rstrip("/") if exact else "/" + place, name.rstrip("/") if exact else "*/" + name)
               for place in places() if place.startswith(under))


def checkPlaces(name, document):
    """What a table answers to "where is ...?" exists."""
    under = ""
    for number, row in document.tables:
        heading = re.match(r"\|\s*\*\*(\w+/)\*\*", row)
        under = heading.group(1) if heading else under
        for code in re.findall(r"`([^`\s]+)[^`]*`", row):
            if name == "docs/contributing.md":
                asked = re.fullmatch(r"<?[\w./*-]+>?", code) and ("/" in code or pathlib.PurePath(code).suffix in CODE_SUFFIXES)
                if asked and not isPlace(code.removeprefix("./")):
                    yield number, f"there is no {code}"
            elif name == "docs/architecture.md" and under and code.endswith("/") and not isPlace(code, under):
                yield number, f"there is no {code} in {under}"


def checkWords(name, document, glossary):
    log = name == "CHANGELOG.md"
    prose = [(start + i, line) for start, block in document.blocks for i, line in enumerate(plain(block).split("\n"))]
    tables = [(n, plain(t)) for n, t in document.tables]
    headings = [] if log else [(n, plain(t)) for n, t in document.headings]
    for number, line in prose + tables + headings:
        for pattern, what in TRACES + DIARY:
            match = re.search(pattern, line)
            if match:
                yield number, f"{what}: \"{match.group()}\""
    for number, line in prose:
        match = re.search(r"(?<![\w.\])])\.\d+", line)
        if match:
            yield number, f"number without leading zero: {match.group()}"
    if name in NO_GLOSSARY:
        return
    for number, line in prose + tables + [(n, plain(t)) for n, t in document.headings]:
        for what in glossary.find(line, lambda kinds: "prose" in kinds, prose=True):
            yield number, what
    for number, line in enumerate(document.lines, start=1):
        for what in glossary.find(line, lambda kinds: "prose" not in kinds):
            yield number, what
        if number in document.code or "`" in line:
            inline = line if number in document.code else " ".join(re.findall(r"`([^`]*)`", line))
            for what in glossary.find(inline, lambda kinds: "prose" in kinds and kinds != {"prose"}):
                yield number, what


def checkVersions(document):
    """At most 30 lines a version in CHANGELOG.md."""
    text = "\n".join(document.lines)
    starts = [i for i, line in enumerate(document.lines) if line.startswith("## ")] + [len(document.lines)]
    for begin, end in zip(starts, starts[1:]):
        count = sum(1 for line in document.lines[begin:end] if line.strip())
        if count > MAX_LINES_A_VERSION:
            yield begin + 1, f"{count} lines for a version (limit {MAX_LINES_A_VERSION})"


def checkDocuments(paths, glossary, table, whole):
    offences, rows, total = [], [], 0
    for path in paths:
        name = relative(path)
        document = Document(path.read_text(encoding="utf-8"))
        found = list(checkLinks(path, document)) + list(checkPlaces(name, document))
        if not name.startswith("docs/decisions/"):
            sentences = sentencesOf(document)
            lengths = sorted(len(words) for _, words in sentences)
            total += sum(lengths)
            rows.append((name, sum(lengths), lengths))
            found += checkLengths(document, sentences)
            found += checkWords(name, document, glossary)
            if name == "CHANGELOG.md":
                found += checkVersions(document)
        offences += [f"{name}:{line}: {what}" for line, what in sorted(set(found))]
    if whole and total > MAX_TOTAL:
        offences.append(f"docs:1: {total} words in all documents together (limit {MAX_TOTAL})")
    if table:
        print(f"{'document':48} {'words':>6} {'sentences':>9} {'median':>6} {'p90':>4} {'longest':>7}")
        for name, words, lengths in rows:
            if lengths:
                print(f"{name:48} {words:6} {len(lengths):9} {median(lengths):6g} {percentile(lengths, 0.9):4} {lengths[-1]:7}")
            else:
                print(f"{name:48} {words:6} {0:9} {'-':>6} {'-':>4} {'-':>7}")
        print(f"{'together':48} {total:6}")
    return offences


# ---------------------------------------------------------------- sources

def codeFiles():
    for folder in CODE_FOLDERS:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.is_file() and (path.suffix in CODE_SUFFIXES or path.name == "CMakeLists.txt"):
                yield path
    if (ROOT / "CMakeLists.txt").exists():
        yield ROOT / "CMakeLists.txt"


# Files that accept names of version 0.1 or test that they are accepted, and formats whose keys do not change.
KEEPS_OLD_NAMES = {
    "bridge/box2d/include/supercircle/box2d.hpp", "bridge/box2d3/include/supercircle/box2d3.hpp",
    "plugin/api/include/supercircle/shells.hpp", "plugin/cli/programs/identify.cpp", "plugin/cli/programs/lab.cpp",
    "plugin/recording/experiment/experiment.schema.json", "plugin/recording/experiment/load.cpp",
    "plugin/scene/loader/read_protocol.cpp", "plugin/scene/loader/read_shells.cpp", "plugin/scene/scene.schema.json",
    "scenes/stack30.json", "tests/golden/canonical.py", "tests/golden/golden.py", "tests/plugin/api/test_deprecated.cpp",
    "tests/plugin/cli/test_calibrate.cpp", "tests/plugin/cli/test_slurm.cpp",
    "tests/plugin/scene/loader/test_renamed.cpp", "tests/plugin/scene/loader/test_schema.cpp",
}


def isExemptSource(name):
    return (name.rsplit("/", 1)[-1].startswith("deprecated") or name.startswith("tests/data/") or name == "tests/golden/renamed.csv"
            or name == ".ci/check_documents.py" or name in KEEPS_OLD_NAMES)


def commentsOf(text, suffix):
    """The source with everything but its comments blanked, line by line."""
    if suffix == ".json":
        return [""] * (text.count("\n") + 1)
    if suffix in {".cpp", ".h", ".hpp"}:
        token = r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])'|R\"(\w*)\(.*?\)\1\""
    else:
        token = r"(?:(?<=\s)|^)#[^\n]*|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'"
    out, at = [], 0
    for match in re.finditer(token, text, flags=re.S | re.M):
        out.append("\n" * text.count("\n", at, match.start()))
        piece = match.group()
        out.append(piece if piece.startswith(("//", "/*", "#")) else "\n" * piece.count("\n"))
        at = match.end()
    out.append("\n" * text.count("\n", at))
    return "".join(out).split("\n")


def headerComment(text):
    """The number of `//` lines with which a C++ file explains itself."""
    lines = text.split("\n")
    first = 1 if lines[0] == "#pragma once" else 0
    return next(i for i, line in enumerate(lines[first:] + [""]) if not line.startswith("//"))


def checkCode(paths, glossary):
    offences = []
    for path in paths:
        name = relative(path)
        if isExemptSource(name):
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        offences += [f"{name}:1: file name: {what}" for what in glossary.find(name, lambda kinds: "file" in kinds)]
        if path.suffix in {".cpp", ".h", ".hpp"} and headerComment(text) > MAX_HEADER_COMMENT:
            offences.append(f"{name}:1: comment of {headerComment(text)} lines at the top, at most {MAX_HEADER_COMMENT}: "
                            "the rest belongs to docs/theory or docs/decisions")
        comments = commentsOf(text, path.suffix)
        for number, line in enumerate(text.split("\n"), start=1):
            comment = comments[number - 1] if number <= len(comments) else ""
            found = list(glossary.find(line, lambda kinds: kinds != {"prose"}))
            found += [w for w in glossary.find(comment, lambda kinds: "prose" in kinds, prose=True) if w not in found]
            found += [f"{what} in a comment: \"{m.group()}\"" for p, what in TRACES for m in [re.search(p, comment)] if m]
            offences += [f"{name}:{number}: {what}" for what in found]
    return offences


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--table", action="store_true", help="print words, median, 90th percentile and longest sentence")
    parser.add_argument("--code", action="store_true", help="check sources instead of documents")
    parser.add_argument("--glossary", default=ROOT / "docs" / "glossary.csv", help="another glossary.csv")
    parser.add_argument("files", nargs="*", type=pathlib.Path)
    options = parser.parse_args()
    for path in options.files:
        if not path.is_file():
            print(f"check_documents: no file {path}", file=sys.stderr)
            return 2
    glossary = Glossary(options.glossary)
    if options.code:
        offences = checkCode(options.files or list(codeFiles()), glossary)
    else:
        offences = checkDocuments(options.files or documentFiles(), glossary, options.table, not options.files)
    for offence in offences:
        print(offence)
    return 1 if offences else 0


if __name__ == "__main__":
    sys.exit(main())
