"""The module and the command say the same, to the byte."""

from __future__ import annotations

import importlib.metadata
import json
import pickle
import subprocess
import sys
from pathlib import Path

import dropcheck
import numpy as np
import pytest
from conftest import EXAMPLES, Command

RECORDINGS = sorted(p for p in EXAMPLES.iterdir() if p.suffix in {".mcap", ".h5", ".csv"} and p.with_suffix(".toml").exists())


@pytest.mark.parametrize("recording", RECORDINGS, ids=lambda path: path.name)
def test_a_result_is_the_commands_json(recording: Path, command: Command) -> None:
    cask = recording.with_suffix(".toml")
    said = command("analyze", recording, "--cask", cask, "--json", "-")
    result = dropcheck.analyze(recording, cask)
    assert result.to_json().encode() == said.stdout
    assert result.to_dict() == json.loads(said.stdout)
    assert said.returncode == (0 if result.verdict == "pass" else 1)


def test_the_fields_of_a_result() -> None:
    result = dropcheck.analyze(EXAMPLES / "anf18-json.mcap", str(EXAMPLES / "anf18-json.toml"))
    truth = json.loads((EXAMPLES.parent / "reference" / "anf18-json.truth.json").read_text())
    speed, k = result.slap_down.speed, result.k
    assert result.verdict == "pass" and speed is not None and k is not None
    assert abs(speed.value - truth["speed"]) < speed.u95 and speed.unit == "m/s"
    # The README's session is of this drop, and a test of the command holds it.
    session = (EXAMPLES.parent.parent / "README.md").read_text()
    assert f"Slap-down speed {speed!r} (rigid cask)" in session and f"Restitution k   {k!r}\n" in session
    assert [finding.code for finding in result.findings] == [found["code"] for found in result.to_dict()["quality"]]
    assert result.findings[0].severity in {"note", "warning", "error"}
    with pytest.raises(AttributeError, match="there is: time, impact_velocity"):
        result.first_impact.speed  # noqa: B018
    with pytest.raises(AttributeError, match="cannot be set"):
        result.verdict = "fail"
    assert pickle.loads(pickle.dumps(speed)) == speed
    assert pickle.loads(pickle.dumps(result)).to_dict() == result.to_dict()


def test_curves_are_arrays() -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    result = dropcheck.analyze(EXAMPLES / "anf18-json.mcap", EXAMPLES / "anf18-json.toml")
    curves, table = result.curves, result.curves_frame()
    assert {"A1", "A1.time_s", "A1.filtered_m_s2", "A1.velocity_m_s"} <= curves.keys()
    for name, curve in curves.items():
        assert curve.dtype == np.float64 and curve.ndim == 1 and np.isfinite(curve).all(), name
    assert np.array_equal(table.loc["A1"]["raw_m_s2"], curves["A1"])
    assert np.array_equal(result.to_xarray()["A1.velocity_m_s"], curves["A1.velocity_m_s"])
    motion = result.motion
    assert motion["angle_deg"].shape == motion["time_s"].shape
    assert motion["angle_deg"][0] == pytest.approx(15, abs=1)


def test_a_report_is_that_of_the_command(tmp_path: Path, command: Command) -> None:
    recording, cask = EXAMPLES / "vhlw-rest.h5", EXAMPLES / "vhlw-rest.toml"
    dropcheck.analyze(recording, cask).write(tmp_path / "module")
    command("analyze", recording, "--cask", cask, "--out", tmp_path / "command")
    names = sorted(path.name for path in (tmp_path / "command").iterdir())
    assert names == sorted(path.name for path in (tmp_path / "module").iterdir())
    for name in ["curves.csv", "impacts.svg", "results.tex"]:
        assert (tmp_path / "module" / name).read_bytes() == (tmp_path / "command" / name).read_bytes()
    with pytest.raises(dropcheck.Error, match="was not written by dropcheck"):
        (tmp_path / "theirs").mkdir()
        (tmp_path / "theirs" / "report.html").write_text("theirs")
        dropcheck.analyze(recording, cask).write(tmp_path / "theirs")


def test_predictions_and_listings_are_the_commands(command: Command) -> None:
    cask, recording = EXAMPLES / "anf18-json.toml", EXAMPLES / "vhlw-rest.h5"
    said = command("predict", "--cask", cask, "--json", "-").stdout
    assert dropcheck.predict(cask).to_json().encode() == said
    said = command("predict", "--cask", cask, "--angle", 20, "--contact", 0.4, "--sweep", "k=0:1:0.5", "--json", "-").stdout
    swept = dropcheck.predict(cask, angle_deg=20, contact=0.4, sweep="k=0:1:0.5")
    assert swept.to_json().encode() == said
    assert {row.k for row in swept.predictions} == {0.0, 0.5, 1.0}
    listing = dropcheck.inspect(recording)
    assert listing.to_json().encode() == command("inspect", recording, "--json", "-").stdout
    assert listing.channels[0].sample_rate_hz > 0


def test_a_synthetic_recording_is_the_commands(tmp_path: Path, command: Command) -> None:
    scene = EXAMPLES / "scene-anf18.toml"
    made = dropcheck.synth(scene, tmp_path / "module.csv", seed=7)
    command("synth", scene, "--out", tmp_path / "command.csv", "--seed", 7)
    assert (tmp_path / "module.csv").read_bytes() == (tmp_path / "command.csv").read_bytes()
    result = dropcheck.analyze(made.files[0], made.files[1])
    assert result.k is not None and abs(result.k.value - made.k) < result.k.u95


def test_the_command_runs_in_the_module(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    recording, cask = str(EXAMPLES / "anf18-json.mcap"), str(EXAMPLES / "anf18-json.toml")
    assert dropcheck.main(["inspect", recording]) == 0
    assert "a1" in capfd.readouterr().out
    assert dropcheck.main(["analyze", str(tmp_path / "none"), "--cask", cask]) == 2
    said = capfd.readouterr().err
    assert said.startswith("error: ") and dropcheck.main(["--version"]) == 0
    assert capfd.readouterr().out.startswith(f"dropcheck {dropcheck.__version__}")
    with pytest.raises(dropcheck.Error) as raised:
        dropcheck.analyze(tmp_path / "none", cask)
    assert f"error: {raised.value}\n" == said


def test_the_import_is_light() -> None:
    code = "import sys, dropcheck; print(*[m for m in ('numpy', 'pandas', 'xarray', 'inspect') if m in sys.modules])"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, text=True).stdout
    assert loaded.strip() == ""


def test_the_module_shows_its_own_names_alone() -> None:
    assert dir(dropcheck) == sorted(dropcheck.__all__) and not {"os", "sys", "Iterable", "_dropcheck"} & set(dir(dropcheck))
    assert all(hasattr(dropcheck, name) for name in dropcheck.__all__)


def test_a_library_that_is_not_there_is_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> str:
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "version", missing)
    recording = tmp_path / "drop.tdms"
    recording.write_bytes(b"TDSm")
    said = f"{recording}: the whole file: npTDMS, which reads it, is not installed\n  help: pip install 'dropcheck[tdms]'"
    for read in (dropcheck.from_file, dropcheck.inspect, lambda path: dropcheck.analyze(path, EXAMPLES / "anf10-plain.toml")):
        with pytest.raises(dropcheck.Error) as raised:
            read(recording)
        assert str(raised.value) == said
