"""Links between pages lead somewhere, and so do the names of pages in sources and of code in pages.

usage: tests/docs/test_links.py [-v] [CLASS...]
"""
import pathlib
import re
import tempfile
import unittest
from urllib.parse import unquote

ROOT = pathlib.Path(__file__).resolve().parents[2]
CODE = ("src", "apps", "tests", "scripts")
# Pages that describe the code by its names.
OF_CODE = ("docs/architecture.md", "docs/method.md", "docs/surfaces.md", "docs/trials.md")
OF_OPENVDB = {"meshToVolume"}


def pages(root):
    return sorted([*root.glob("*.md"), *root.glob("docs/**/*.md"), *root.glob("data/*.md"), *root.glob("tests/**/*.md"),
                   *root.glob("scripts/**/*.md")])


def sources(root):
    endings = {".h", ".cpp", ".py", ".sh", ".txt", ".cmake", ".in", ".json"}
    return sorted(path for folder in CODE for path in (root / folder).rglob("*")
                  if path.suffix in endings and path.name != pathlib.Path(__file__).name)


def text_of(page):
    """Without code blocks, whose brackets are no links."""
    return re.sub(r"(?ms)^```.*?^```", "", page.read_text(encoding="utf-8"))


def headings(page):
    return re.findall(r"(?m)^#+ +(.+?) *#*$", text_of(page))


def anchors(page):
    """Those that GitHub gives to the headings of a page."""
    seen, found = {}, set()
    for heading in headings(page):
        words = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading)
        slug = re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")
        found.add(slug + (f"-{seen[slug]}" if slug in seen else ""))
        seen[slug] = seen.get(slug, 0) + 1
    return found | set(re.findall(r'<a id="([^"]+)">', text_of(page)))


def broken_links(root):
    """["docs/a.md: b.md#c has no such heading", ...]"""
    broken = []
    for page in pages(root):
        text = re.sub(r"`[^`\n]*`", "", text_of(page))
        for target in re.findall(r"\]\(\s*<?([^)\s>]+)", text):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, anchor = unquote(target).partition("#")
            file = (page.parent / name).resolve() if name else page
            if not file.exists():
                broken.append(f"{page.relative_to(root)}: {target} does not exist")
            elif anchor and anchor not in anchors(file):
                broken.append(f"{page.relative_to(root)}: {target} has no such heading")
    return broken


def broken_references(root):
    """Pages that sources name: docs/a.md, docs/a.md#anchor, docs/a.md, "Heading"."""
    broken = []
    for source in sources(root):
        # A comment's lines as one.
        text = re.sub(r"\n\s*(//+|#) ?", " ", source.read_text(encoding="utf-8", errors="replace"))
        for name, anchor, heading in re.findall(r'(?<![\w/.])(docs/[\w/]+\.md)(?:#([\w-]+)|, "([^"\n]+)")?', text):
            page = root / name
            where = f"{source.relative_to(root)}: {name}"
            if not page.is_file():
                broken.append(f"{where} does not exist")
            elif anchor and anchor not in anchors(page):
                broken.append(f"{where}#{anchor} has no such heading")
            elif heading and heading not in headings(page):
                broken.append(f'{where} has no heading "{heading}"')
    return broken


def unknown_names(root):
    """Functions, types and files that pages name and no source has."""
    files = {path.name for path in sources(root)}
    words = set(OF_OPENVDB)
    for folder in ("src", "apps", "tests"):
        for path in (root / folder).rglob("*"):
            if path.suffix in {".h", ".cpp"}:
                words.update(re.findall(r"\w+", path.read_text(encoding="utf-8")))
    unknown = []
    for name in OF_CODE:
        page = root / name
        for code in re.findall(r"`([^`\n]+)`", text_of(page)) if page.is_file() else ():
            if re.fullmatch(r"[\w/]+\.(h|cpp|py)", code):
                known = pathlib.Path(code).name in files
            elif re.fullmatch(r"(\w+::)*[A-Za-z]+[a-z][A-Z]\w*(\(\))?|\w+(::\w+)+(\(\))?", code):
                known = re.findall(r"\w+", code)[-1] in words
            else:
                continue
            if not known:
                unknown.append(f"{name}: `{code}`")
    return unknown


class Repository(unittest.TestCase):
    maxDiff = None

    def test_links_lead_to_files_and_headings(self):
        self.assertEqual(broken_links(ROOT), [])
        self.assertGreater(sum(len(re.findall(r"\]\([^)]*#", text_of(page))) for page in pages(ROOT)), 100)

    def test_sources_name_pages_and_headings(self):
        self.assertEqual(broken_references(ROOT), [])

    def test_pages_name_code(self):
        self.assertEqual(unknown_names(ROOT), [])


class Finder(unittest.TestCase):
    """What it finds, on a repository of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)

    def write(self, name, text):
        file = self.root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def test_links(self):
        self.write("docs/a.md", "# One `b`, two\n## Same\n## Same\n```text\n# no heading\n[x](none.md)\n```\n")
        self.write("README.md", "[1](docs/a.md#one-b-two) [2](docs/a.md#same-1) [3](https://x.y/z#w) `[4](no)`\n"
                   "[5](docs/a.md#same-2) [6](docs/a.md#no-heading) [7](b.md) ![8](b.png) [9](#one)\n")
        self.assertEqual(broken_links(self.root),
                         ["README.md: docs/a.md#same-2 has no such heading",
                          "README.md: docs/a.md#no-heading has no such heading", "README.md: b.md does not exist",
                          "README.md: b.png does not exist", "README.md: #one has no such heading"])

    def test_references(self):
        self.write("docs/a.md", "# One two\n")
        self.write("src/x.h", '// docs/a.md, "One two"; docs/a.md,\n// "One"; docs/b.md; docs/a.md#one-two; docs/a.md#two\n')
        self.assertEqual(broken_references(self.root),
                         ['src/x.h: docs/a.md has no heading "One"', "src/x.h: docs/b.md does not exist",
                          "src/x.h: docs/a.md#two has no such heading"])

    def test_names(self):
        self.write("src/x.h", "struct Band { void markFacing(); };")
        self.write("docs/method.md", "`Band::markFacing`, `markFacing`, `x.h`, `march/x.h`, `a word`, `--option`, `K`\n"
                   "`Band::unmark`, `markAll`, `y.h`, `LeafBlock::at()`\n")
        self.assertEqual(unknown_names(self.root),
                         ["docs/method.md: `Band::unmark`", "docs/method.md: `markAll`", "docs/method.md: `y.h`",
                          "docs/method.md: `LeafBlock::at()`"])


if __name__ == "__main__":
    unittest.main()
