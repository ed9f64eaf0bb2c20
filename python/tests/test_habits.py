"""Results and casks behave as a notebook expects of them."""

from __future__ import annotations

import pickle
import tomllib
from pathlib import Path

import dropcheck
import numpy as np
import pytest
from conftest import EXAMPLES

RECORDING, CASK = EXAMPLES / "anf10-plain.csv", EXAMPLES / "anf10-plain.toml"


@pytest.fixture(scope="module")
def result() -> dropcheck.Result:
    return dropcheck.analyze(RECORDING, CASK)


def test_a_quantity_formats_and_floats(result: dropcheck.Result) -> None:
    speed = result.slap_down.speed
    assert speed is not None
    assert f"{speed:.1f}" == f"{speed.value:.1f} ± {speed.u95:.1f} m/s"
    assert (f"{speed}", float(speed)) == (repr(speed), speed.value)


def test_a_result_goes_to_another_process(result: dropcheck.Result, tmp_path: Path) -> None:
    copy = pickle.loads(pickle.dumps(result))
    assert copy.to_json() == result.to_json() and copy.curves.keys() == result.curves.keys()
    assert all(np.array_equal(copy.curves[name], of, equal_nan=True) for name, of in result.curves.items())
    with pytest.raises(TypeError, match="came from another process"):
        copy.write(tmp_path)


def test_a_notebook_shows_the_numbers(result: dropcheck.Result) -> None:
    shown = result._repr_html_()
    assert str(result.k) in shown and str(result.slap_down.speed) in shown and "<table>" in shown


def test_a_cask_may_be_a_dict(result: dropcheck.Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cask = tomllib.loads(CASK.read_text())
    assert dropcheck.analyze(RECORDING, cask).k == result.k
    assert dropcheck.predict(cask).predictions == dropcheck.predict(CASK).predictions
    with pytest.raises(TypeError, match="length_m is None"):
        dropcheck.predict(cask | {"cask": {"length_m": None}})


def test_a_frame_is_a_recording(result: dropcheck.Result) -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.read_csv(RECORDING, index_col="time_s")
    assert str(dropcheck.analyze(frame, CASK).k) == str(result.k)
    frame.index.name = "t"
    with pytest.raises(TypeError, match="call it time_s"):
        dropcheck.analyze(frame, CASK)


def test_another_recordings_report_stays(result: dropcheck.Result, tmp_path: Path) -> None:
    result.write(tmp_path)
    other = dropcheck.analyze(EXAMPLES / "anf18-json.mcap", EXAMPLES / "anf18-json.toml")
    with pytest.raises(dropcheck.Error, match="another recording"):
        other.write(tmp_path)
    result.write(tmp_path)
