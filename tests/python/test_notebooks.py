"""The notebooks in examples/notebooks: their cells run in order, what they show can be shown, none holds output."""

import ast
import json
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((ROOT / "examples/notebooks").glob("*.ipynb"))


def run_cell(source, names):
    """The value of the cell's last line, if that is an expression."""
    body = ast.parse(source).body
    last = ast.Expression(body.pop().value) if isinstance(body[-1], ast.Expr) else None
    exec(compile(ast.Module(body, []), "cell", "exec"), names)
    return None if last is None else eval(compile(last, "cell", "eval"), names)


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook(notebook, data, tmp_path, monkeypatch):
    (tmp_path / "data").symlink_to(data)
    monkeypatch.chdir(tmp_path)
    names, scenes = {}, 0
    for cell in json.loads(notebook.read_text())["cells"]:
        if cell["cell_type"] != "code":
            continue
        assert cell["outputs"] == []
        shown = run_cell("".join(cell["source"]), names)
        if shown is not None:
            assert "<iframe" in shown._repr_html_() or "<img" in shown._repr_html_()
            scenes += 1
    assert scenes >= 3


def test_there_are_notebooks():
    assert NOTEBOOKS
