"""Links between the pages: files that are there, and headings that they have."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def pages():
    """README.md, and all pages in these folders."""
    return [ROOT / "README.md", *(page for folder in ("docs", "data", "tests", "scripts")
                                  for page in sorted((ROOT / folder).rglob("*.md")))]


def text_of(page):
    """Without code, in which brackets mean other things."""
    return re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)


def anchors(page):
    """Of its headings, as GitHub makes them."""
    names, seen = set(), {}
    for heading in re.findall(r"^#+ +(.+?) *$", text_of(page), re.MULTILINE):
        heading = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading)
        name = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        seen[name] = seen.get(name, -1) + 1
        names.add(f"{name}-{seen[name]}" if seen[name] else name)
    return names


def broken(page):
    """Links of a page that lead nowhere."""
    for link in re.findall(r"\]\(([^)\s]+)\)", text_of(page)):
        file, _, anchor = link.partition("#")
        if re.match(r"[a-z]+:", link):
            continue
        target = (page.parent / file).resolve() if file else page
        if not target.exists():
            yield f"{link}: no such file"
        elif anchor and target.suffix == ".md" and anchor not in anchors(target):
            yield f"{link}: no such heading"


class Links(unittest.TestCase):
    def test_links_lead_to_files_and_headings(self):
        found = [f"{page.relative_to(ROOT)}: {what}" for page in pages() for what in broken(page)]
        self.assertGreater(len(pages()), 10)
        self.assertEqual(found, [])

    def test_headings_become_anchors(self):
        self.assertIn("what-info-predicts", anchors(ROOT / "docs/accuracy.md"))
        self.assertNotIn("no-such-heading", anchors(ROOT / "docs/accuracy.md"))


if __name__ == "__main__":
    unittest.main()
