#!/usr/bin/env python3
"""Checks a built site without a network: its links, anchors and pictures, and that it loads nothing from elsewhere.

  tools/check_site.py SITE

Links to other sites are counted and listed by -v, not fetched.
"""

import argparse
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {("script", "src"), ("img", "src"), ("link", "href"), ("source", "src"), ("iframe", "src")}
FOLLOWED = LOADED | {("a", "href")}


class Page(HTMLParser):
    """The anchors of a page, and what it links to: (tag, attribute, url, line)."""

    def __init__(self, path):
        super().__init__()
        self.anchors, self.links = set(), []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors |= {values[key] for key in ("id", "name") if values.get(key)}
        for attribute in ("src", "href"):
            if values.get(attribute) and (tag, attribute) in FOLLOWED:
                self.links.append((tag, attribute, values[attribute], self.getpos()[0]))


def problem(site, pages, path, link, external):
    """What is wrong with a link, or None."""
    tag, attribute, url, _ = link
    parts = urlsplit(url)
    if parts.scheme in ("data", "mailto", "javascript"):
        return None
    if parts.scheme or parts.netloc:
        external.add(url)
        rel_only = (tag, attribute) == ("a", "href")
        return None if rel_only else "loaded from another site"
    if parts.path.startswith("/"):
        return "an absolute path, which breaks the site in a folder or as files"
    target = path if not parts.path else (path.parent / unquote(parts.path)).resolve()
    if not target.is_file():
        return "no such file"
    if not target.is_relative_to(site):
        return "outside the site"
    if parts.fragment and target.suffix == ".html" and parts.fragment != "__skip":
        if target in pages and unquote(parts.fragment) not in pages[target].anchors:
            return "no such anchor"
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("site", type=Path)
    parser.add_argument("-v", "--verbose", action="store_true", help="list links to other sites")
    arguments = parser.parse_args()
    site = arguments.site.resolve()
    pages = {path: Page(path) for path in sorted(site.rglob("*.html")) if path.name != "404.html"}
    external, num_links, problems = set(), 0, []
    for path, page in pages.items():
        for link in page.links:
            num_links += 1
            if found := problem(site, pages, path, link, external):
                problems.append(f"{path.relative_to(site)}:{link[3]}: {link[2]}: {found}")
    if arguments.verbose:
        print("\n".join(sorted(external)))
    print("\n".join([*problems, f"{len(pages)} pages, {num_links} links, {len(external)} other sites' pages linked, "
                                f"{len(problems)} problems"]))
    return 1 if problems or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
