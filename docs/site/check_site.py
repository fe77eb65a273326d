"""Checks a folder of HTML pages: every link leads somewhere inside it, and nothing is loaded from elsewhere.

    check_site.py FOLDER        one line a fault; exit code 1 if there is any
    check_site.py --self-test   pages with every fault are made, and found
"""

import pathlib
import re
import sys
import tempfile
import urllib.parse
from html.parser import HTMLParser

LINKS = {("a", "href"), ("area", "href")}  # somebody has to click; everything else with an address loads it
ADDRESSES = {"href", "src", "srcset", "poster", "data", "xlink:href"}
GENERATED = "reference/cpp"  # Doxygen names headings that it does not make: only its files are looked for
OWN = {"data", "blob", "about", "javascript"}  # schemes that ask no network


def css_addresses(text: str) -> list[str]:
    """What a style sheet loads."""
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    return [a or b for a, b in re.findall(r"url\(\s*[\"']?\s*([^\"')\s]+)|@import\s+[\"']([^\"']+)", text)]


def is_elsewhere(address: str) -> bool:
    parts = urllib.parse.urlsplit(address.strip())
    return parts.netloc != "" or (parts.scheme != "" and parts.scheme not in OWN)


class Page(HTMLParser):
    """Links, loaded addresses and names of headings of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.names: set[str] = set()
        self.in_style = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.in_style = tag == "style"
        for name, value in attrs:
            value = value or ""
            if name == "id" or (tag == "a" and name == "name"):
                self.names.add(value)
            elif (tag, name) in LINKS:
                self.links.append(value)
            elif name == "srcset":
                self.loads += [part.split()[0] for part in value.split(",") if part.strip()]
            elif name in ADDRESSES and not (name == "data" and tag != "object"):
                self.loads.append(value)
            elif name == "style":
                self.loads += css_addresses(value)

    def handle_endtag(self, tag: str) -> None:
        self.in_style = False

    def handle_data(self, data: str) -> None:
        if self.in_style:
            self.loads += css_addresses(data)


def faults(folder: pathlib.Path) -> list[str]:
    found: list[str] = []
    pages = {path: Page(path.read_text(errors="replace")) for path in sorted(folder.rglob("*.html"))}

    def missing(path: pathlib.Path, address: str) -> str:
        """"" or what is wrong with an address inside the folder."""
        parts = urllib.parse.urlsplit(address)
        other = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
        if not other.is_file():
            return "no such file"
        if other in pages and folder / GENERATED not in other.parents and parts.fragment and urllib.parse.unquote(parts.fragment) not in pages[other].names:
            return "no such heading"
        return ""

    for path, page in pages.items():
        name = path.relative_to(folder)
        for address in page.loads:
            if is_elsewhere(address):
                found.append(f"{name} loads {address}")
        for address in page.links + [a for a in page.loads if not a.startswith("#")]:
            if not is_elsewhere(address) and urllib.parse.urlsplit(address).scheme not in OWN and (why := missing(path, address)):
                found.append(f"{name}: {address}: {why}")
    for path in sorted(folder.rglob("*.css")):
        found += [f"{path.relative_to(folder)} loads {a}" for a in css_addresses(path.read_text(errors="replace")) if is_elsewhere(a)]
    return found


BAD = """<!doctype html><title>bad</title>
<link rel="stylesheet" href="https://one.example/a.css"><LINK REL=icon HREF='//two.example/i.png'>
<style>@import "https://three.example/b.css"; p { background: url( 'http://four.example/c.png' ) }</style>
<p style="background: url(https://five.example/d.png)">text</p>
<script src="https://six.example/e.js"></script><img alt="" srcset="own.png 1x, https://seven.example/f.png 2x">
<iframe src="https://eight.example/"></iframe><object data="https://nine.example/g.svg"></object>
<svg><use xlink:href="https://ten.example/h.svg#x"/></svg>
<a href="nowhere.html">lost</a><a href="good.html#nothing">lost</a><img alt="" src="nothing.png">"""
GOOD = """<!doctype html><title>good</title><link rel="stylesheet" href="own.css"><link rel="icon" href="data:,">
<style>p { background: url(data:image/png;base64,AAAA) }</style><h1 id="here">Here</h1>
<a href="https://elsewhere.example/">a link may lead anywhere</a><a href="mailto:a@b.example">mail</a><a href="#here">up</a>
<img alt="" src="own.png"><script>const text = '<img src="https://not.example/a.png">';</script>"""


def self_test() -> int:
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name).resolve()
        (folder / "reference/cpp").mkdir(parents=True)
        (folder / "good.html").write_text(GOOD)
        (folder / "own.css").write_text("/* url(https://comment.example/) */ p { color: red }")
        (folder / "own.png").write_bytes(b"")
        assert faults(folder) == [], faults(folder)
        (folder / "bad.html").write_text(BAD)
        (folder / "reference/cpp/bad.html").write_text('<link href="https://eleven.example/a.css">')
        (folder / "reference/cpp/bad.css").write_text("@import url(https://twelve.example/a.css); p { cursor: url('//thirteen.example/b') }")
        found = faults(folder)
        hosts = "one two three four five six seven eight nine ten eleven twelve thirteen".split()
        told = [line for line in found if " loads " in line]
        assert sorted(re.search(r"//(\w+)\.example", line).group(1) for line in told) == sorted(hosts), told
        assert sorted(line.rsplit(": ", 1)[1] for line in found if " loads " not in line) == ["no such file", "no such file", "no such heading"], found
    print(f"{len(found)} faults made and found")
    return 0


def main() -> int:
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    if len(sys.argv) != 2 or not pathlib.Path(sys.argv[1]).is_dir():
        print(__doc__, file=sys.stderr)
        return 2
    found = faults(pathlib.Path(sys.argv[1]).resolve())
    for line in found:
        print(f"broken: {line}")
    return 1 if found else 0


if __name__ == "__main__":
    raise SystemExit(main())
