"""What pages become before they are built: links out of docs/, and our docstrings as Markdown."""

import importlib
from pathlib import Path
from types import SimpleNamespace

import pytest

ROOT = Path(__file__).resolve().parents[2]
pytest.importorskip("mkdocs", reason="needs the extra [docs]")
pytest.importorskip("griffe", reason="needs the extra [docs]")


@pytest.fixture
def hooks(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    return importlib.import_module("docs_hooks")


@pytest.fixture
def docstrings(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    return importlib.import_module("docs_griffe")


def converted(hooks, text, repo_url=""):
    page = SimpleNamespace(file=SimpleNamespace(abs_src_path=str(ROOT / "docs/metrics.md"), src_path="metrics.md"))
    return hooks.on_page_markdown(text, page, SimpleNamespace(docs_dir=str(ROOT / "docs"), repo_url=repo_url), None)


def test_links_out_of_docs_become_text_or_lead_to_the_repository(hooks):
    link = "[its header](../include/shapelight/io/io.hpp)"
    assert converted(hooks, link) == "`include/shapelight/io/io.hpp`"
    assert converted(hooks, link, "https://example.org/x/") == (
        "[its header](https://example.org/x/blob/main/include/shapelight/io/io.hpp)")
    assert converted(hooks, "[a](register.md)") == "[a](register.md)"


def test_a_link_to_a_missing_file_is_refused(hooks):
    with pytest.raises(Exception, match="link to ../include/absent.hpp, which is not there"):
        converted(hooks, "[its header](../include/absent.hpp)")


def test_names_that_no_group_has_are_appended(hooks):
    text = converted(hooks, f"::: shapelight.sample\n\n{hooks.REST}")
    assert "::: shapelight.simplify\n" in text
    assert text.count("::: shapelight.sample\n") == 1 and "__version__" not in text


def test_aligned_lines_become_a_table(docstrings):
    table = docstrings.as_table("count   [points] to keep, or\nratio   share to keep: a|b,\n        rounded")
    rows = ["| `count` | [points] to keep, or |", "| `ratio` | share to keep: a\\|b, rounded |"]
    assert table.splitlines()[2:] == rows
    assert docstrings.as_table("Two lines of\nplain text.") == "Two lines of\nplain text."


def test_options_are_those_of_the_library(docstrings):
    table = docstrings.options_as_table(docstrings.option_table("sample"))
    assert "| `local_weight` | Share of points chosen for local detail (the paper's T). |  | 0.65 |" in table
    assert "One of `shape`, `random`" in table


def test_functions_and_results_of_the_package_get_their_tables(docstrings):
    import griffe

    extensions = griffe.load_extensions(docstrings.Tables())
    package = griffe.load("shapelight", search_paths=[str(ROOT / "python")], extensions=extensions)
    result = package["results.SampleResult"]
    assert "| `usable` | `int` | Finite points of the input. |" in result.docstring.value
    assert "| `points` | " in result.docstring.value and result["points"].docstring is None
    sample = package["sample"].docstring.value
    assert "| `ratio` | share of the finite points to keep, or |" in sample and "| `local_weight` |" in sample
