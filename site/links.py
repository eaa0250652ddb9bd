"""Links of the built site: those between its pages, and what a check of other servers says."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

#: Answers of a server that say: there is no such page. Others (refused, too many, no server) say nothing of the page.
GONE = re.compile(r"\b(404|410)\b")


class _Page(HTMLParser):
    """Places of a page, and what it links to or shows."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.places: set[str] = set()
        self.links: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        for name, value in attributes:
            if value and (name == "id" or (name == "name" and tag == "a")):
                self.places.add(value)
            if value and name in ("href", "src"):
                self.links.append(value)


def dead_links(folder: Path) -> Iterator[str]:
    """Every link inside the site that leads to no page, file or place: "page: link"."""
    # The viewer of a 3D scene is one file of somebody else's.
    files = [file for file in sorted(folder.rglob("*.html")) if "_static" not in file.parts]
    pages = {file.resolve(): _Page(file.read_text(encoding="utf-8")) for file in files}
    for file, page in pages.items():
        for link in dict.fromkeys(page.links):
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            target = target / "index.html" if target.is_dir() else target
            place = unquote(parts.fragment)
            if not target.is_file() or (place and target in pages and place not in pages[target].places):
                yield f"{file.relative_to(folder.resolve())}: {link}"


def answers_of_servers(output: Path) -> tuple[list[str], list[str], int]:
    """Broken links, links whose server was not reached, and the number that answered, from linkcheck's output.json."""
    broken, unreachable, answered = [], [], 0
    for line in output.read_text(encoding="utf-8").splitlines():
        entry = json.loads(line)
        if entry["status"] in ("working", "redirected"):
            answered += entry["uri"].startswith("http")
        elif entry["status"] in ("broken", "timeout"):
            gone = GONE.search(entry["info"]) or not entry["uri"].startswith("http")
            (broken if gone else unreachable).append(
                f"{entry['filename']}:{entry['lineno']}: {entry['uri']}: {entry['info'][:100]}"
            )
    return broken, unreachable, answered
