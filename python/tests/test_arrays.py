"""Samples in memory give what the same samples give as a CSV file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import asammdf
import dropcheck
import nptdms
import numpy as np
import pytest
from conftest import EXAMPLES
from dropcheck import Samples
from numpy.typing import NDArray

RATE_HZ = 25_000.0
CASK = """[cask]
mass_kg = 4466
length_m = 5.512
height_m = 0.792
[drop]
height_m = 9.0
angle_deg = 15.0
[[channel]]
name = "first"
end = "first"
axis = "transverse"
source = "A1"
unit = "g"
position_m = 0.15
RATE
[[channel]]
name = "second"
end = "second"
axis = "transverse"
source = "A2"
unit = "g"
position_m = 5.362
RATE
"""


@pytest.fixture(scope="module")
def samples(tmp_path_factory: pytest.TempPathFactory) -> dict[str, NDArray[np.float64]]:
    """Both channels of a drop, g, at `RATE_HZ`."""
    path = tmp_path_factory.mktemp("drop") / "drop.csv"
    scene = (EXAMPLES / "scene-anf18.toml").read_text()
    (path.parent / "scene.toml").write_text(scene)
    dropcheck.synth(path.parent / "scene.toml", path)
    table = np.genfromtxt(path, delimiter=",", names=True)
    names = [name for name in table.dtype.names or () if name != "time_s"][:2]
    return {key: np.round(table[name], 4) for key, name in zip(["A1", "A2"], names, strict=True)}


@pytest.fixture
def cask(tmp_path: Path) -> Path:
    path = tmp_path / "cask.toml"
    path.write_text(CASK.replace("RATE\n", ""))
    return path


def of_csv(folder: Path, samples: Mapping[str, NDArray[Any]], *, timed: bool, rate_hz: float = RATE_HZ) -> dict[str, Any]:
    """What the samples give as a table, with a column of times or with the rate in the cask file."""
    columns = {"time_s": np.arange(len(samples["A1"])) / RATE_HZ, **samples} if timed else dict(samples)
    rows = zip(*(map(repr, map(float, column)) for column in columns.values()), strict=True)
    (folder / "drop.csv").write_text("\n".join([",".join(columns), *map(",".join, rows)]))
    (folder / "csv.toml").write_text(CASK.replace("RATE\n", "" if timed else f"sample_rate_hz = {rate_hz}\n"))
    return told(dropcheck.analyze(folder / "drop.csv", folder / "csv.toml"))


def told(result: dropcheck.Result) -> dict[str, Any]:
    """A result without what tells a file from an array, or says where the rate is stated."""
    fields = result.to_dict()
    for key in ["input", "command", "settings", "cask_text"]:
        del fields[key]
    return fields


def test_arrays_are_the_csv(samples: dict[str, NDArray[np.float64]], cask: Path, tmp_path: Path) -> None:
    expected = of_csv(tmp_path, samples, timed=False)
    assert expected["slap_down"]["speed"] is not None
    by_source = {name: Samples(values, rate_hz=RATE_HZ) for name, values in samples.items()}
    assert told(dropcheck.analyze(by_source, cask)) == expected
    by_name = {"first": by_source["A1"], "second": by_source["A2"], "other": by_source["A1"]}
    assert told(dropcheck.analyze(by_name, cask)) == expected
    result = dropcheck.analyze(by_source, cask)
    assert result.input.recording == "samples in memory" and result.input.format == "samples" and result.command == []
    assert len(result.input.recording_sha256) == 64
    assert result.input.recording_sha256 != dropcheck.analyze(by_name, cask).input.recording_sha256


def test_arrays_with_times_are_the_csv(samples: dict[str, NDArray[np.float64]], cask: Path, tmp_path: Path) -> None:
    times_s = np.arange(len(samples["A1"])) / RATE_HZ
    held = {name: Samples(values, times_s=times_s) for name, values in samples.items()}
    assert told(dropcheck.analyze(held, cask)) == of_csv(tmp_path, samples, timed=True)


def test_missing_samples_are_the_csvs(samples: dict[str, NDArray[np.float64]], cask: Path, tmp_path: Path) -> None:
    gappy = {name: values.copy() for name, values in samples.items()}
    gappy["A1"][700:720] = np.nan
    expected = of_csv(tmp_path, gappy, timed=False)
    held = {name: Samples(values, rate_hz=RATE_HZ) for name, values in gappy.items()}
    assert told(dropcheck.analyze(held, cask)) == expected
    masked = np.ma.masked_invalid(gappy["A1"])
    held["A1"] = Samples(masked, rate_hz=RATE_HZ)
    assert told(dropcheck.analyze(held, cask)) == expected


def test_any_layout_and_type_of_numbers(samples: dict[str, NDArray[np.float64]], cask: Path, tmp_path: Path) -> None:
    counts = {name: np.round(values).astype(np.int16) for name, values in samples.items()}
    expected = of_csv(tmp_path, counts, timed=False)
    table = np.stack([counts["A1"], counts["A2"]], axis=1)
    for numbers in [table, table.astype(">i4"), table.astype(np.float32), np.asfortranarray(table), table.astype("f8")[::-1][::-1]]:
        held = {"A1": Samples(numbers[:, 0], rate_hz=RATE_HZ), "A2": Samples(numbers[:, 1], rate_hz=int(RATE_HZ))}
        assert told(dropcheck.analyze(held, cask)) == expected
    lists = {name: Samples(values.tolist(), rate_hz=RATE_HZ) for name, values in counts.items()}
    assert told(dropcheck.analyze(lists, cask)) == expected


def test_tdms(samples: dict[str, NDArray[np.float64]], cask: Path, tmp_path: Path) -> None:
    properties = {"wf_increment": 1 / RATE_HZ, "unit_string": "g"}
    with nptdms.TdmsWriter(tmp_path / "drop.tdms") as writer:
        writer.write_segment([nptdms.ChannelObject("daq", name, values, properties) for name, values in samples.items()])
    group = nptdms.TdmsFile.read(tmp_path / "drop.tdms")["daq"]
    rate_hz = 1 / group["A1"].properties["wf_increment"]
    held = {
        channel.name: Samples(channel[:], rate_hz=rate_hz, unit=channel.properties["unit_string"])
        for channel in group.channels()
    }
    assert told(dropcheck.analyze(held, cask)) == of_csv(tmp_path, samples, timed=False, rate_hz=rate_hz)


def test_mdf(samples: dict[str, NDArray[np.float64]], cask: Path, tmp_path: Path) -> None:
    times_s = np.arange(len(samples["A1"])) / RATE_HZ
    with asammdf.MDF(version="4.10") as file:
        file.append([asammdf.Signal(values, times_s, unit="g", name=name) for name, values in samples.items()])
        file.save(tmp_path / "drop.mf4", overwrite=True)
    with asammdf.MDF(tmp_path / "drop.mf4") as file:
        signals = [file.get(name) for name in ["A1", "A2"]]
    held = {signal.name: Samples(signal.samples, times_s=signal.timestamps, unit=signal.unit) for signal in signals}
    assert told(dropcheck.analyze(held, cask)) == of_csv(tmp_path, samples, timed=True)


@pytest.mark.parametrize(
    ("held", "words"),
    [
        ({"A1": {}, "A2": {}}, ['channel "first"', "rate_hz", "sample_rate_hz"]),
        ({"A1": {"rate_hz": 1e5}, "B": {"rate_hz": 1e5}}, ['channel "second"', '"A2"', 'there is: "A1", "B"', "by its `source`"]),
        ({"A1": {"rate_hz": 1e5}, "second": {"rate_hz": 1e5}}, ['"A2"', "of every one by its `name`"]),
        ({}, ['channel "first"', "there is: none"]),
        ({"A1": {"rate_hz": 1e5, "times_s": [0.0, 1.0]}, "A2": {}}, ["2 times but", "channel"]),
        ({"A1": {"rate_hz": 1e5, "unit": "rad/s"}, "A2": {"rate_hz": 1e5}}, []),
    ],
)
def test_what_is_not_stated_is_refused_with_the_line_that_mends_it(
    held: dict[str, dict[str, Any]], words: list[str], samples: dict[str, NDArray[np.float64]], cask: Path
) -> None:
    given = {name: Samples(samples["A1"], **stated) for name, stated in held.items()}
    if not words:
        cask.write_text(cask.read_text().replace('unit = "g"\n', ""))
        words = ['"rad/s"', "unit = "]
    with pytest.raises(dropcheck.Error) as raised:
        dropcheck.analyze(given, cask)
    for word in words:
        assert word in str(raised.value)
    assert "help: " in str(raised.value)
