"""A hundred bad calls raise what Python raises or the command's message; the interpreter goes on."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import dropcheck
import numpy as np
import pytest
from conftest import EXAMPLES
from dropcheck import Samples

RECORDING, CASK = EXAMPLES / "anf10-plain.csv", EXAMPLES / "anf10-plain.toml"
GOOD = Samples(np.zeros(100), rate_hz=1e4, unit="g")

NO_PATHS: list[Any] = [None, 5, 1.5, [], {"x": 1}.items(), object(), (), b"\xff\xfe", "", "\0", "none.mcap", EXAMPLES, "-", "-x"]
NO_NUMBERS: list[Any] = ["text", "0.5", None, b"1", [1], {}, 1j, True, float("nan"), float("inf"), -1, 10**400, 0]
NO_ARRAYS: list[Any] = [None, "text", 5, [], [1.0], [[1.0, 2.0]], [1j], ["a"], [None], np.zeros((3, 3)), [True, False], object(),
                        np.array(["2026-01-01"], dtype="M8[s]"), [1.0, [2.0]], np.full(9, np.nan), np.zeros(0), {}, np.ma.masked_invalid([np.nan] * 5)]  # fmt: skip
NO_MAPPINGS: list[Any] = [{}, {1: GOOD}, {"A1": [1.0]}, {"A1": None}, {None: GOOD}, {"": GOOD}, {"A1": np.zeros(9)}, {"A1": GOOD}]

CALLS: list[Callable[[], object]] = [
    *[lambda bad=bad: dropcheck.analyze(bad, CASK) for bad in NO_PATHS],
    *[lambda bad=bad: dropcheck.analyze(RECORDING, bad) for bad in NO_PATHS],
    *[lambda bad=bad: dropcheck.inspect(bad) for bad in NO_PATHS],
    *[lambda bad=bad: dropcheck.from_file(bad) for bad in NO_PATHS],
    *[lambda bad=bad: dropcheck.predict(bad) for bad in NO_PATHS],
    *[lambda bad=bad: dropcheck.synth(bad) for bad in NO_PATHS],
    *[lambda bad=bad: dropcheck.analyze(bad, CASK) for bad in NO_MAPPINGS],
    *[lambda bad=bad: dropcheck.analyze({"A1": Samples(bad, rate_hz=1e4), "A2": GOOD, "A3": GOOD}, CASK) for bad in NO_ARRAYS],
    *[lambda bad=bad: dropcheck.analyze({"A1": Samples(np.zeros(9), times_s=bad)}, CASK) for bad in NO_ARRAYS[1:]],
    *[lambda bad=bad: Samples(np.zeros(9), rate_hz=bad) for bad in NO_NUMBERS if bad not in (None, 10**400)],
    *[lambda bad=bad: Samples(np.zeros(9), start_s=bad) for bad in NO_NUMBERS[:8]],
    *[lambda bad=bad: dropcheck.predict(CASK, k=bad) for bad in NO_NUMBERS if bad is not None and bad != 0],
    *[lambda bad=bad: dropcheck.predict(CASK, angle_deg=bad) for bad in [*NO_NUMBERS[:2], 91, -1, True]],
    *[lambda bad=bad: dropcheck.predict(CASK, contact=bad) for bad in ["soft", -1, [], ""]],
    *[lambda bad=bad: dropcheck.predict(CASK, sweep=bad) for bad in ["", "1:2", "k=0:1:0", 5, [None]]],
    lambda: dropcheck.predict(CASK, k=0.5, sweep="k=0:1:0.5"),
    lambda: dropcheck.analyze(RECORDING, CASK, without=["offset", "everything"]),
    lambda: dropcheck.analyze(RECORDING, CASK, without=5),  # type: ignore[arg-type]
    lambda: dropcheck.analyze(RECORDING, CASK, max_memory="much"),
    lambda: dropcheck.analyze(RECORDING, CASK, "offset"),  # type: ignore[call-arg]
    lambda: dropcheck.analyze(CASK, RECORDING),
    lambda: dropcheck.analyze(RECORDING, RECORDING),
    lambda: Samples(np.zeros(9), 1e4),  # type: ignore[call-arg]
    lambda: Samples(np.zeros(9), unit=5),  # type: ignore[arg-type]
    lambda: dropcheck.synth(EXAMPLES / "scene-anf18.toml", "drop.txt"),
    lambda: dropcheck.analyze(RECORDING, CASK).write("/etc"),
]


def test_bad_calls_raise(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert len(CALLS) >= 100
    for number, call in zip(itertools.count(), CALLS, strict=False):
        with pytest.raises((dropcheck.Error, TypeError, ValueError, OverflowError)) as raised:
            pytest.fail(f"call {number} gave {call()!r}")
        assert str(raised.value).strip(), number
        assert "broke off" not in str(raised.value), number
    assert list(tmp_path.iterdir()) == []
    assert dropcheck.analyze(RECORDING, CASK).verdict


def test_a_fault_in_the_cask_file_shows_its_line(tmp_path: Path) -> None:
    cask = tmp_path / "cask.toml"
    cask.write_text(CASK.read_text().replace("mass_kg", "mas_kg", 1))
    with pytest.raises(dropcheck.Error, match=r"line \d+: mas_kg") as raised:
        dropcheck.analyze(RECORDING, cask)
    assert "did you mean mass_kg?" in str(raised.value)
