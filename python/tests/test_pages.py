"""The page is that of the docstrings, and the notebook runs and shows what it says."""

from __future__ import annotations

import json
import runpy
import shutil
from pathlib import Path

import pytest
from conftest import ROOT


def test_the_page_is_of_the_docstrings() -> None:
    page = runpy.run_path(str(ROOT / "python" / "page.py"))["page"]()
    assert (ROOT / "python" / "README.md").read_text() == page, "python/page.py > python/README.md writes it anew"


def test_the_notebook_says_what_it_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import matplotlib

    matplotlib.use("Agg")
    shutil.copytree(ROOT / "fixtures", tmp_path / "fixtures")
    (tmp_path / "examples").mkdir()
    monkeypatch.chdir(tmp_path / "examples")
    names: dict[str, object] = {}
    cells = json.loads((ROOT / "examples" / "campaign.ipynb").read_text())["cells"]
    for cell in [cell for cell in cells if cell["cell_type"] == "code"]:
        exec("".join(cell["source"]), names)  # noqa: S102
        streams = [output["text"] for output in cell["outputs"] if output["output_type"] == "stream"]
        assert capsys.readouterr().out == "".join(line for text in streams for line in text)
