"""What is wrong in built pages: links and anchors that lead nowhere, and what would be loaded from elsewhere."""

import re
from collections.abc import Iterable
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {
    "script": "src",
    "img": "src",
    "iframe": "src",
    "source": "src",
    "object": "data",
    "use": "href",
    "image": "href",
}
"""Element -> the attribute with the address of what a browser loads with it."""
ADDRESS_IN_STYLE = re.compile(r"(?:@import\s+|url\()\s*['\"]?\s*((?:https?:)?//[^'\")\s]*)")


class Page(HTMLParser):
    """Anchors of a page, its links, and the addresses that a browser loads with it."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        if tag == "link" and given.get("rel") not in ("canonical", "author", "license"):
            (
                self.loaded if "stylesheet" in given.get("rel", "") or "icon" in given.get("rel", "") else self.links
            ).append(given.get("href", ""))
        if tag in LOADED and LOADED[tag] in given:
            self.loaded.append(given[LOADED[tag]])
        self.loaded += ADDRESS_IN_STYLE.findall(given.get("style", ""))

    handle_startendtag = handle_starttag


def faults(folder: Path, anchors: Iterable[str]) -> list[str]:
    """Return what is wrong in the pages of a folder, one line each; some page must have each of the anchors."""
    pages = {path.resolve(): Page(path.read_text("utf-8")) for path in sorted(folder.rglob("*.html"))}
    result = []
    for path, page in pages.items():
        place = path.relative_to(folder.resolve())
        for address in page.loaded:
            if urlsplit(address).netloc:
                result.append(f"{place}: loads {address}")
        for address in (*page.links, *page.loaded):
            parts = urlsplit(address)
            if parts.scheme in ("http", "https", "mailto", "data") or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if parts.scheme or not target.exists():
                result.append(f"{place}: {address} leads to no file")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                result.append(f"{place}: {address} leads to no anchor")
    for path in sorted(folder.rglob("*.css")):
        result += [
            f"{path.relative_to(folder)}: loads {address}"
            for address in ADDRESS_IN_STYLE.findall(path.read_text("utf-8"))
        ]
    present = {anchor for page in pages.values() for anchor in page.anchors}
    return result + [f"{anchor}: no page has this anchor" for anchor in anchors if anchor not in present]
