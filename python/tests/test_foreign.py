"""Recordings of other formats give what the same samples give as a CSV file: by the lines that the program's refusal names, by
the wheel's command, and by `from_file`. What their libraries warn of is refused."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import dropcheck
import foreign_files as write
import nptdms
import numpy as np
import pytest
from conftest import ROOT, Command
from dropcheck import Samples
from foreign_files import FORMATS, OWN, RATE_HZ, Channels
from numpy.typing import NDArray
from test_arrays import CASK, samples  # noqa: F401

# What the module reads by the libraries of their fields.
READ = list(FORMATS)[:8]


@pytest.fixture
def program() -> Callable[..., subprocess.CompletedProcess[str]]:
    """The command without Python, as `cargo test` has built it."""

    def run(*words: object) -> subprocess.CompletedProcess[str]:
        words = (Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "debug" / "dropcheck", *words)
        return subprocess.run(list(map(str, words)), capture_output=True, text=True, check=False)

    return run


def cask_file(folder: Path, sources: tuple[str, str]) -> Path:
    """A cask file that states the unit, and the rate where the recording does not."""
    text = CASK.replace('"A1"', f'"{sources[0]}"').replace('"A2"', f'"{sources[1]}"')
    path = folder / "cask.toml"
    path.write_text(text.replace("RATE\n", f"sample_rate_hz = {RATE_HZ}\n" if sources[0] == "samples[0]" else ""))
    return path


def speed(result: dict[str, Any]) -> dict[str, float]:
    found: dict[str, float] = result["slap_down"]["speed"]
    return found


@pytest.fixture(scope="module")
def expected(samples: Channels, tmp_path_factory: pytest.TempPathFactory) -> dict[str, float]:  # noqa: F811
    """The slap-down speed of the same samples as a CSV file."""
    folder = tmp_path_factory.mktemp("csv")
    rows = np.column_stack([write.times_of(samples), *samples.values()])
    np.savetxt(folder / "drop.csv", rows, "%.17g", ",", header="time_s,A1 [g],A2 [g]", comments="")
    return speed(dropcheck.analyze(folder / "drop.csv", cask_file(folder, ("A1", "A2"))).to_dict())


def is_the_csvs(result: dict[str, Any], expected: dict[str, float]) -> bool:
    return abs(speed(result)["value"] - expected["value"]) < expected["u95"] / 1000


def lines_of(refusal: str) -> list[str]:
    """The lines for a shell that a refusal ends with."""
    lines = refusal.splitlines()
    return lines[next(at for at, line in enumerate(lines) if line.startswith("pip install ")) :]


@pytest.mark.parametrize("name", [*FORMATS, *OWN])
def test_the_lines_of_the_refusal_convert_a_recording(
    name: str, samples: Channels, expected: dict[str, float], tmp_path: Path, program: Any  # noqa: F811
) -> None:
    write_it, sources = (FORMATS | OWN)[name]
    recording = tmp_path / name
    write_it(recording, samples)
    if name in FORMATS:
        refused = program("inspect", recording)
        assert refused.returncode == 2
        pip, line = lines_of(refused.stderr)
        # pip itself needs a network: that it names all that the line imports, and nothing that is not there.
        assert subprocess.run([sys.executable, "-m", "pip", "show", *pip.split()[2:]], capture_output=True, check=False).returncode == 0
        output = next(word for word in ("OUT.hdf", "OUT.h5", "OUT.csv", "OUT.nc") if word in line)
        converted = tmp_path / output
        line = line.replace("python ", f"{sys.executable} ", 1).replace("'IN'", f"'{name}'").replace("FULL_SCALE", str(write.FULL_SCALE))
        done = subprocess.run(line, shell=True, cwd=tmp_path, capture_output=True, text=True, check=False)  # noqa: S602
        assert done.returncode == 0, done.stderr
    else:
        converted = recording
    said = program("analyze", converted, "--cask", cask_file(tmp_path, sources), "--json", "-")
    assert is_the_csvs(json.loads(said.stdout), expected), said.stderr


@pytest.mark.parametrize("name", READ)
def test_the_wheels_command_reads_it(
    name: str, samples: Channels, expected: dict[str, float], tmp_path: Path, command: Command, program: Any  # noqa: F811
) -> None:
    write_it, sources = FORMATS[name]
    recording, cask = tmp_path / name, cask_file(tmp_path, sources)
    write_it(recording, samples)
    said = command("analyze", recording, "--cask", cask, "--json", "-")
    result = json.loads(said.stdout)
    assert is_the_csvs(result, expected)
    read = result["input"]
    assert read["recording"] == str(recording) and read["recording_sha256"] == hashlib.sha256(recording.read_bytes()).hexdigest()
    assert read["reader"].split()[0] in {"npTDMS", "asammdf", "pyuff", "scipy", "idelib"}
    assert dropcheck.analyze(recording, cask).to_dict()["slap_down"] == result["slap_down"]
    # As samples in memory, and as HDF5 without Python.
    held = dropcheck.from_file(recording)
    if name.endswith(".mat"):
        held = {key: Samples(of.values, rate_hz=held["Fs"].values[0], unit="g") for key, of in held.items()}
    assert is_the_csvs(dropcheck.analyze(held, cask).to_dict(), expected)
    done = command("convert", recording, "--to", tmp_path / "converted.h5")
    assert done.returncode == 0 and b"Written: " in done.stdout
    said = program("analyze", tmp_path / "converted.h5", "--cask", cask, "--json", "-")
    assert is_the_csvs(json.loads(said.stdout), expected)
    listed = dropcheck.inspect(recording)
    assert {source.lstrip("/") for source in sources} <= {channel.source.lstrip("/") for channel in listed.channels}
    assert listed.recording == str(recording) and listed.facts.converted_by == read["reader"]
    template = command("init", recording).stdout.decode()
    assert all(f'"/{source.lstrip("/")}"' in template for source in sources)
    (tmp_path / "folder").mkdir()
    shutil.copy(recording, tmp_path / "folder")
    command("batch", tmp_path / "folder", "--cask", cask, "--jsonl", tmp_path / "lines")
    lines = [json.loads(line) for line in (tmp_path / "lines").read_text().splitlines()]
    assert len(lines) == 1 and is_the_csvs(lines[0], expected)


def counts(kind: str = "<i2") -> dict[str, NDArray[Any]]:
    return {"A1": np.arange(100).astype(kind), "A2": np.arange(100)[::-1].astype(kind)}


KINDS = ["i1", "u1", "<i2", "<u2", "<i4", "<u4", "<f4", "<f8"]
# What writes a file, the source of A1 in it, and what it holds where that is not what was written.
ORACLE: list[tuple[str, Callable[[Path, Channels], None], Callable[[NDArray[Any]], NDArray[Any]]]] = [
    *[("tdms", lambda path, channels, kind=kind: write.tdms(path, {n: x.astype(kind) for n, x in channels.items()}), lambda x: x) for kind in KINDS],
    *[("mat", lambda path, channels, kind=kind: write.matlab(path, {n: x.astype(kind) for n, x in channels.items()}), lambda x: x) for kind in KINDS],
    *[("mf4", lambda path, channels, kind=kind: write.mdf(path, {n: x.astype(kind) for n, x in channels.items()}), lambda x: x) for kind in KINDS],
    *[("mf4", lambda path, channels, how=how: write.mdf(path, channels, compression=how), lambda x: x) for how in (1, 2)],
    *[("mdf", lambda path, channels, version=version: write.mdf(path, channels, version), lambda x: x) for version in ("2.14", "3.10")],
    *[
        ("uff", lambda path, channels, said=(binary, double): write.uff(path, channels, binary=said[0], double=said[1]), lambda x: x)
        for binary in (False, True) for double in (False, True) if double or not binary
    ],
    ("uff", lambda path, channels: write.uff(path, channels, times_s=write.times_of(channels)), lambda x: x),
    ("tdms", lambda path, channels: write.scaled_tdms(path, channels, "Linear"), lambda x: 0.25 * x + 1.0),
    ("mat", lambda path, channels: write.matlab(path, channels, do_compression=True), lambda x: x),
]  # fmt: skip


@pytest.mark.parametrize(("ending", "write_it", "held_as"), ORACLE)
def test_values_are_those_that_were_written(ending: str, write_it: Any, held_as: Any, tmp_path: Path) -> None:
    path = tmp_path / f"drop.{ending}"
    write_it(path, counts("<i2"))
    held = dropcheck.from_file(path)
    first = next(of for name, of in held.items() if name.split("/")[-1].startswith("A1"))
    assert np.array_equal(first.values, held_as(counts()["A1"].astype(float)))
    if ending in {"tdms", "uff", "mf4", "mdf"}:
        rate_hz = first.rate_hz if first.times_s is None else 1 / np.diff(first.times_s).mean()
        assert first.unit == "g" and rate_hz == pytest.approx(RATE_HZ, rel=1e-5)


def test_what_is_invalid_is_missing(tmp_path: Path) -> None:
    invalid = np.zeros(100, bool)
    invalid[10:20] = True
    write.mdf(tmp_path / "drop.mf4", counts(), invalid=invalid)
    held = dropcheck.from_file(tmp_path / "drop.mf4")["ChannelGroup_0/A1"]
    assert np.array_equal(np.isnan(held.values), invalid)


def uneven(path: Path, channels: Channels) -> None:
    write.uff(path, channels, abscissa_axis_units_lab="ms")


def no_time(path: Path, channels: Channels) -> None:
    write.uff(path, channels, func_type=2)


def cut(writer: Callable[[Path, Channels], None], share: float) -> Callable[[Path, Channels], None]:
    def write_and_cut(path: Path, channels: Channels) -> None:
        writer(path, channels)
        path.write_bytes(path.read_bytes()[: int(path.stat().st_size * share)])

    return write_and_cut


def patched(writer: Callable[[Path, Channels], None], before: bytes, now: bytes) -> Callable[[Path, Channels], None]:
    def write_and_patch(path: Path, channels: Channels) -> None:
        writer(path, channels)
        assert before in path.read_bytes()
        path.write_bytes(path.read_bytes().replace(before, now))

    return write_and_patch


def starting(path: Path, channels: Channels, *starts: str | None) -> None:
    said = {"wf_increment": 1 / RATE_HZ, "wf_start_offset": 0.5}
    stated = [{} if start is None else {"wf_start_time": np.datetime64(start)} for start in starts]
    objects = [nptdms.ChannelObject("daq", name, channels[name], said | start) for name, start in zip(channels, stated, strict=True)]
    with nptdms.TdmsWriter(path) as writer:
        writer.write_segment(objects)


def other_starts(path: Path, channels: Channels) -> None:
    starting(path, channels, "2026-01-01T00:00:00", None)


def test_starts_are_kept(tmp_path: Path) -> None:
    starting(tmp_path / "drop.tdms", counts(), "2026-01-01T00:00:00.002", "2026-01-01T00:00:00")
    held = dropcheck.from_file(tmp_path / "drop.tdms")
    assert [held[f"daq/{name}"].start_s for name in ("A1", "A2")] == pytest.approx([0.502, 0.5])
    assert held["daq/A1"].unit is None


REFUSED: list[tuple[str, Callable[[Path, Channels], None], str]] = [
    ("drop.tdms", lambda path, channels: write.scaled_tdms(path, channels, "Foo"), "it warns: Unsupported scale type: Foo"),
    ("drop.tdms", lambda path, channels: write.tdms(path, channels, gain=2.0), "its property gain is a conversion"),
    ("drop.tdms", other_starts, "some do not say when"),
    ("drop.uff", uneven, "its abscissa is in ms"),
    ("drop.uff", no_time, "it holds no samples over time"),
    ("drop.uff", patched(write.uff, b"       100         1", b"        99         1"), "it states 99 samples and holds 100"),
    ("drop.uff", patched(lambda p, c: write.uff(p, c, binary=True), b"58b     1     2", b"58b     1     1"), "not of IEEE 754"),
    *[(name, cut(FORMATS[name][0], share), "") for name in READ for share in (0.3, 0.9)],
    *[(name, lambda path, channels, name=name: cut(FORMATS[name][0], 40 / 1e4)(path, channels), "") for name in ("drop.mf4",)],
]


@pytest.mark.parametrize(("name", "write_it", "words"), REFUSED)
def test_what_a_library_warns_of_or_nobody_states_is_refused(
    name: str, write_it: Any, words: str, tmp_path: Path, command: Command, samples: Channels  # noqa: F811
) -> None:
    path = tmp_path / name
    write_it(path, counts() if words else samples)
    said = command("inspect", path)
    message = said.stderr.decode()
    assert said.returncode == 2 and said.stdout == b"" and words in message and "help: " in message
    assert message.startswith(f"error: {path}: ") and len(message.splitlines()) < 5, message
    with pytest.raises(dropcheck.Error) as raised:
        dropcheck.from_file(path)
    assert message == f"error: {raised.value}\n"
    assert command("convert", path, "--to", tmp_path / "converted.h5").stderr == said.stderr
    assert [left.name for left in tmp_path.iterdir()] == [name]


def test_convert_leaves_files_alone(tmp_path: Path, command: Command) -> None:
    write.tdms(tmp_path / "drop.tdms", counts())
    said = command("convert", tmp_path / "drop.tdms", "--to", tmp_path / "drop.tdms")
    assert said.returncode == 2 and b"is there already" in said.stderr
    said = command("convert", ROOT / "fixtures/examples/anf10-plain.csv", "--to", tmp_path / "new.h5")
    assert said.returncode == 2 and b"dropcheck reads it itself" in said.stderr
    assert command("convert", tmp_path / "drop.tdms").returncode == 2 and command("convert", "--help").returncode == 0


def test_times_that_are_not_even_go_the_way_of_any_others(tmp_path: Path, samples: Channels, command: Command) -> None:  # noqa: F811
    times_s = write.times_of(samples)
    times_s[1000:] += 0.002
    write.mdf(tmp_path / "drop.mf4", samples, times_s=times_s)
    said = json.loads(command("inspect", tmp_path / "drop.mf4", "--json", "-").stdout)
    assert said["channels"][0]["gaps"] == 1
