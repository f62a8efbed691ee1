"""The built site: what the check of links finds, and that the pages pass it."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def check(site):
    done = subprocess.run([sys.executable, ROOT / "tools/check_site.py", site], stdout=subprocess.PIPE, text=True)
    return done.returncode, done.stdout


def write(site, **pages):
    for name, body in pages.items():
        (site / f"{name}.html").write_text(f"<html><body>{body}</body></html>")


def test_whole_links_pass(tmp_path):
    (tmp_path / "a.png").write_bytes(b"")
    write(tmp_path, index='<a href="two.html#here">x</a><img src="a.png"><a href="https://example.org/">y</a>',
          two='<h1 id="here">x</h1><a href="#here">y</a>')
    status, text = check(tmp_path)
    assert status == 0 and "2 pages, 4 links, 1 other sites' pages linked, 0 problems" in text


@pytest.mark.parametrize("body, message", [
    ('<a href="absent.html">x</a>', "absent.html: no such file"),
    ('<a href="two.html#absent">x</a>', "two.html#absent: no such anchor"),
    ('<a href="#absent">x</a>', "#absent: no such anchor"),
    ('<img src="absent.png">', "absent.png: no such file"),
    ('<a href="/two.html">x</a>', "an absolute path"),
    ('<script src="https://example.org/x.js"></script>', "loaded from another site"),
    ('<link rel="stylesheet" href="//example.org/x.css">', "loaded from another site"),
])
def test_broken_links_are_told(tmp_path, body, message):
    write(tmp_path, index=f"\n{body}", two='<h1 id="here">x</h1>')
    status, text = check(tmp_path)
    assert status == 1 and message in text and "index.html:2" in text


@pytest.mark.skipif(importlib.util.find_spec("mkdocs") is None, reason="needs the extra [docs]")
def test_the_documentation_builds_and_passes(tmp_path):
    environment = {**os.environ, "PYTHON": sys.executable, "SITE": str(tmp_path / "site"),
                   "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    done = subprocess.run([ROOT / "tools/build_docs.sh"], env=environment, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)
    assert done.returncode == 0, done.stdout[-4000:]
    assert (tmp_path / "site/tutorials/thin-a-scan.html").exists()
