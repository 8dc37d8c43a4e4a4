"""The examples of docs/python.md: they run as they stand, beside a recording of the name that they read."""

import re

import numpy as np
from conftest import ROOT


def blocks():
    """The blocks of the page that import the package."""
    text = (ROOT / "docs/python.md").read_text(encoding="utf-8")
    found = re.findall(r"(?:^    .*\n|^\n(?=    ))+", text, re.MULTILINE)
    code = ["".join(line[4:] or "\n" for line in block.splitlines(keepends=True)) for block in found]
    return [block for block in code if "import breakaway" in block]


def test_the_examples_run(arrays, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    np.savetxt("rec.csv", np.column_stack(arrays), delimiter=",", header="t_s,u_V,x_rad", comments="")
    code = blocks()
    assert code
    for number, block in enumerate(code):
        exec(compile(block, f"docs/python.md example {number}", "exec"), {})
    assert "cogging" in capsys.readouterr().out
    assert "cogging" in (tmp_path / "improved.toml").read_text()
