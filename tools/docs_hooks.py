"""Hooks of mkdocs: links from pages to files of the repository, and lists of Python names that follow the package."""

import ast
import re
from pathlib import Path

from mkdocs.exceptions import PluginError

ROOT = Path(__file__).resolve().parents[1]
LINK = re.compile(r"(?<!!)\[([^\]]+)\]\(((?:\.\./)+[^)#\s]+)(#[^)\s]*)?\)")
PACKAGE = ROOT / "python/shapelight"
REST = "<!-- every other public name -->"
MODULES = re.compile(r"<!-- modules of shapelight\.(\w+) -->")


def on_page_markdown(markdown, page, config, files):
    """Files outside docs/ are no part of the site: their links become text, or lead to repo_url where there is one.
    A file that is not there fails the build."""
    folder = Path(page.file.abs_src_path).parent
    docs = Path(config.docs_dir)

    def replaced(link):
        target = (folder / link[2]).resolve()
        if not target.exists():
            raise PluginError(f"{page.file.src_path}: link to {link[2]}, which is not there")
        if target.is_relative_to(docs):
            return link[0]
        path = target.relative_to(ROOT).as_posix()
        if config.repo_url:
            return f"[{link[1]}]({config.repo_url.rstrip('/')}/blob/main/{path})"
        return f"`{path}`"

    markdown = LINK.sub(replaced, markdown)
    markdown = MODULES.sub(lambda found: modules(found[1]), markdown)
    return markdown.replace(REST, other_names(markdown)) if REST in markdown else markdown


def modules(package):
    """The public modules of a package, each under its name."""
    names = sorted(path.stem for path in (PACKAGE / package).glob("[!_]*.py"))
    options = "    options:\n      heading_level: 2\n      show_root_full_path: true\n"
    return "\n\n".join(f"::: shapelight.{package}.{name}\n{options}" for name in names)


def public_names():
    """shapelight.__all__, without importing it."""
    tree = ast.parse((PACKAGE / "__init__.py").read_text())
    for node in tree.body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__":
            return ast.literal_eval(node.value)
    raise PluginError("shapelight/__init__.py: no list __all__")


def other_names(markdown):
    listed = set(re.findall(r"^::: shapelight\.(\w+)", markdown, re.MULTILINE))
    pages = {path.name for path in PACKAGE.iterdir() if path.is_dir()}  # packages have pages of their own
    rest = [name for name in public_names() if name not in listed | pages and not name.startswith("__")]
    return "\n\n".join(f"::: shapelight.{name}" for name in rest)
