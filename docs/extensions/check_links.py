"""Checks a built site: every internal link and every file that a page loads exists, and no page loads anything from elsewhere.

``python docs/extensions/check_links.py docs/_build/html``
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag, urlsplit

LOADED = {"script": "src", "img": "src", "iframe": "src", "source": "src", "link": "href"}
"""Elements that make a browser load something, and the attribute that names it."""
NOT_LOADED = ("canonical", "index", "search", "next", "prev", "author", "copyright", "alternate")
"""Relations of a link element that name a page without loading it."""


class Page(HTMLParser):
    """The anchors of a page, where it links to, and what it loads."""

    def __init__(self, path: Path):
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        """Collects one element."""
        given = {name: value for name, value in attributes if value is not None}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        if tag in LOADED and LOADED[tag] in given and given.get("rel", "") not in NOT_LOADED:
            self.loads.append(given[LOADED[tag]])


def faults(site: Path) -> Iterator[str]:
    """What is wrong, one line each."""
    pages = {path: Page(path) for path in sorted(site.rglob("*.html")) if "_static" not in path.relative_to(site).parts}
    for path, page in pages.items():
        place = path.relative_to(site).as_posix()
        for target in page.loads:
            if urlsplit(target).scheme in ("http", "https") or target.startswith("//"):
                yield f"{place}: loads {target} from elsewhere"
        for target in (*page.links, *page.loads):
            if not urlsplit(target).scheme and not target.startswith("//"):
                yield from (f"{place}: {fault}" for fault in _fault_of(target, path, pages))


def _fault_of(target: str, path: Path, pages: dict[Path, Page]) -> Iterator[str]:
    name, anchor = urldefrag(target)
    name = name.partition("?")[0]
    found = (path.parent / unquote(name)).resolve() if name else path
    if not found.exists():
        yield f"{target} does not exist"
    elif anchor and found in pages and unquote(anchor) not in pages[found].anchors:
        yield f"{target} has no such anchor"


if __name__ == "__main__":
    found = list(faults(Path(sys.argv[1]).resolve()))
    sys.stdout.write("".join(f"{fault}\n" for fault in found) or "every internal link leads somewhere\n")
    sys.exit(bool(found))
