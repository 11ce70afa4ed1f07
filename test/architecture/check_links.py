#!/usr/bin/python3
"""The documents against the tree: every relative link and its heading exist, and so does every file of the package that is named.

usage: check_links.py SOURCE_DIRECTORY
"""
import pathlib
import re
import sys
import tempfile
import unittest

SOURCE = pathlib.Path()
FOLDERS = "src|include|test|validation|benchmark|config|scripts|sweep|doc|launch|msg|urdf|fuzz"
LINK = re.compile(r"\]\(([^)\s]+)\)")
NAMED = re.compile(r"(?<![\w/.$*-])((?:%s)/[\w./*-]*[\w*/])" % FOLDERS)
MADE_BY_THE_BUILD = {"config/grasp.bag", "config/two_psm.bag", "config/incline.bag"}


def headings(text):
    """The anchors of a document, as GitHub makes them."""
    lines = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", line.strip().lower()).replace(" ", "-") for line in lines}


def broken(document, source):
    """What `document` names that is not there, one line each."""
    text = document.read_text(encoding="utf-8")
    found = []
    for link in LINK.findall(text):
        if re.match(r"\w+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = (document.parent / path).resolve() if path else document
        if not target.exists():
            found.append("link to %s" % link)
        elif anchor and target.suffix == ".md" and anchor not in headings(target.read_text(encoding="utf-8")):
            found.append("link to %s: no such heading" % link)
    for name in NAMED.findall(text):
        if name not in MADE_BY_THE_BUILD and not any(source.glob(name.rstrip("/"))):
            found.append("%s is named" % name)
    return found


class Links(unittest.TestCase):
    def test_documents_of_the_package(self):
        documents = [d for d in sorted(SOURCE.rglob("*.md")) if "corpus" not in d.parts]
        self.assertGreaterEqual(len(documents), 8)
        lines = ["%s: %s" % (d.relative_to(SOURCE), line) for d in documents for line in broken(d, SOURCE)]
        self.assertEqual(lines, [])

    def test_this_test_can_fail(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "src").mkdir()
            (root / "src" / "there.cpp").touch()
            document = root / "a.md"
            document.write_text("# A `b[]` c\n[x](#a-b-c) [y](#d) [z](e.md) `src/there.cpp` `src/*.cpp` `src/gone.cpp`",
                                encoding="utf-8")
            self.assertEqual(broken(document, root),
                             ["link to #d: no such heading", "link to e.md", "src/gone.cpp is named"])


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    SOURCE = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
