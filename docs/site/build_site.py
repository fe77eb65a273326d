"""Makes one static site of all documents: no resource comes from the network.

    build_site.py --out FOLDER [--reference FOLDER] [--play FILE]

    --reference: HTML of Doxygen, copied to reference/cpp
    --play: the page with the live scenes. It becomes index.html and play/index.html, each with recording_module.js beside
            it, and gets links into the site. The README is about.html; without --play it is index.html, too.
"""

import argparse
import html
import pathlib
import re
import shutil
import urllib.parse

import markdown

import check_site

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
DOORS = [("Play", "index.html"), ("About", "about.html"), ("Documents", "documents.html"), ("Learn", "documents.html#learn"), ("Do", "documents.html#do"),
         ("Look up", "documents.html#look-up"), ("Understand", "documents.html#understand"), ("Results", "documents.html#results")]
PAGES = [("docs/index.md", "documents.html"), ("README.md", "about.html"), ("CHANGELOG.md", "changelog.html"),
         ("docs/glossary.md", "glossary.html"), ("docs/architecture.md", "architecture.html"), ("docs/contributing.md", "contributing.html")]
FOLDERS = ["tutorials", "how-to", "reference", "theory", "results", "decisions"]


def pages() -> dict[pathlib.Path, str]:
    """Source -> place in the site."""
    all_pages = {ROOT / source: place for source, place in PAGES}
    for folder in FOLDERS:
        for source in sorted((ROOT / "docs" / folder).glob("*.md")):
            all_pages[source] = f"{folder}/{source.stem}.html"
    return all_pages


def relative(place: str, target: str) -> str:
    depth = place.count("/")
    return "../" * depth + target


class Site:
    def __init__(self, out: pathlib.Path, has_reference: bool, has_play: bool) -> None:
        self.out = out
        self.pages = pages()
        self.has = {"reference": has_reference, "play": has_play}
        self.template = (HERE / "page.template.html").read_text()
        self.broken: list[str] = []

    def link(self, source: pathlib.Path, place: str, target: str, is_image: bool) -> str:
        """Where a link of a document leads in the site; files that are not part of it become plain text (empty)."""
        parts = urllib.parse.urlsplit(target)
        if parts.scheme or target.startswith("#"):
            return target
        path = (source.parent / urllib.parse.unquote(parts.path)).resolve()
        fragment = f"#{parts.fragment}" if parts.fragment else ""
        if path in self.pages:
            return relative(place, self.pages[path]) + fragment
        if not path.exists():
            self.broken.append(f"{source.relative_to(ROOT)}: {target}")
            return ""
        if is_image or path.suffix in (".png", ".svg"):
            name = path.relative_to(ROOT)
            copy = self.out / name
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, copy)
            return relative(place, name.as_posix())
        return ""

    def body(self, source: pathlib.Path, place: str) -> str:
        text = source.read_text()
        text = re.sub(r"<!--.*?-->\n?", "", text, flags=re.S)
        out = markdown.markdown(text, extensions=["tables", "fenced_code", "toc", "sane_lists", "md_in_html"],
                                extension_configs={"toc": {"slugify": slug}})

        def image(match: re.Match[str]) -> str:
            return f'{match.group(1)}{self.link(source, place, html.unescape(match.group(2)), True)}"'

        def anchor(match: re.Match[str]) -> str:
            where = self.link(source, place, html.unescape(match.group(1)), False)
            return f'<a href="{where}">{match.group(2)}</a>' if where else match.group(2)

        out = re.sub(r'(<img [^>]*src=")([^"]*)"', image, out)
        out = re.sub(r'<a href="([^"]*)">(.*?)</a>', anchor, out, flags=re.S)
        return re.sub(r"(<table>.*?</table>)", r'<div class="table" tabindex="0" role="region" aria-label="Table">\1</div>', out, flags=re.S)

    def write(self, source: pathlib.Path, place: str) -> None:
        body = self.body(source, place)
        title = re.sub("<.*?>", "", (re.search(r"<h1[^>]*>(.*?)</h1>", body, re.S) or re.match("(Supercircle)", "Supercircle")).group(1))
        doors = [(name, where) for name, where in DOORS if self.has["play"] or where != "index.html"]
        if self.has["reference"]:
            doors.append(("C++ reference", "reference/cpp/index.html"))
        menu = "".join(f'<li><a href="{relative(place, where)}">{name}</a></li>' for name, where in doors)
        values = {"title": title, "menu": menu, "body": body, "home": relative(place, "index.html"),
                  "css": relative(place, "site.css")}
        path = self.out / place
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(re.sub(r"\{\{(\w+)\}\}", lambda m: values[m.group(1)], self.template))

    def play(self, page: pathlib.Path) -> None:
        """The live page in front, and where older links expect it. Where it is part of a site it leads to documents."""
        text = page.read_text()
        for place in ("index.html", "play/index.html"):
            folder = (self.out / place).parent
            folder.mkdir(exist_ok=True)
            linked = re.sub(r'<a data-site="([^"]*)"', lambda m: f'<a href="{relative(place, m.group(1))}"', text)
            (self.out / place).write_text(linked)
            shutil.copy(page.parent / "recording_module.js", folder)


def slug(value: str, separator: str) -> str:
    """Headings are named as the forges do it: lower case, no punctuation, spaces to hyphens."""
    return re.sub(r"[^\w\- ]", "", value.strip().lower()).replace(" ", separator)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--reference", type=pathlib.Path)
    parser.add_argument("--play", type=pathlib.Path)
    arguments = parser.parse_args()
    out = arguments.out.resolve()
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    site = Site(out, arguments.reference is not None, arguments.play is not None)
    shutil.copyfile(HERE / "site.css", out / "site.css")
    if arguments.reference:
        shutil.copytree(arguments.reference, out / "reference/cpp")
    for source, place in site.pages.items():
        site.write(source, place)
    if arguments.play:
        site.play(arguments.play)
    else:
        site.write(ROOT / "README.md", "index.html")
    broken = site.broken + check_site.faults(out)
    for line in broken:
        print(f"broken: {line}")
    print(f"{len(site.pages)} pages in {out}")
    return 1 if broken else 0


if __name__ == "__main__":
    raise SystemExit(main())
