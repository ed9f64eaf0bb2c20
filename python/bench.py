"""A scene to what import, calls and threads cost, as ratios in one run: python bench.py, with the wheel of a release installed."""

from __future__ import annotations

import statistics
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from time import perf_counter

import dropcheck
import numpy as np

SCENE = Path(__file__).resolve().parents[1] / "fixtures" / "examples" / "scene-anf18.toml"
SAMPLES = 100_000
ROUNDS = 15


def quickest(*works: Callable[[], object]) -> list[float]:
    """The median time of each, ms, taken in turn."""
    times: list[list[float]] = [[] for _ in works]
    for _ in range(ROUNDS):
        for work, taken in zip(works, times, strict=True):
            begun = perf_counter()
            work()
            taken.append(1e3 * (perf_counter() - begun))
    return [statistics.median(taken) for taken in times]


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        made = dropcheck.synth(SCENE, Path(folder) / "drop.h5")
        recording, cask = Path(folder) / "drop.csv", made.files[1]
        dropcheck.synth(SCENE, recording)
        table = np.genfromtxt(recording, delimiter=",", names=True)
        rate_hz = 1 / (table["time_s"][1] - table["time_s"][0])
        # The fall before the drop, carried on to the front.
        front = np.tile(table["A1_g"][:2000], SAMPLES // 2000 + 1)[: SAMPLES - len(table)]
        held = {name: np.concatenate([front, table[f"{name}_g"]]) for name in ["A1", "A2"]}
        rows = np.stack([np.arange(SAMPLES) / rate_hz, *held.values()], axis=1)
        np.savetxt(recording, rows, delimiter=",", header="time_s,A1,A2", comments="", fmt="%.9g")

        def of_arrays(_: object = None) -> dropcheck.Result:
            given = {name: dropcheck.Samples(values, rate_hz=rate_hz) for name, values in held.items()}
            return dropcheck.analyze(given, cask)

        words = [str(recording), "--cask", cask, "--json", "/dev/null"]
        command = [str(Path(sysconfig.get_path("scripts")) / "dropcheck"), "analyze", *words]
        python = [sys.executable, "-c"]
        bare, imported, of_file, in_memory = quickest(
            lambda: subprocess.run([*python, "pass"], check=True),
            lambda: subprocess.run([*python, "import dropcheck"], check=True),
            lambda: subprocess.run(command, stdout=subprocess.DEVNULL, check=False),
            of_arrays,
        )
        print(f"import {imported - bare:.0f} ms; {SAMPLES} samples by the command {of_file:.0f} ms, in memory {in_memory:.0f} ms")
        with ThreadPoolExecutor(2) as threads:
            one_by_one, together = quickest(lambda: [of_arrays(), of_arrays()], lambda: list(threads.map(of_arrays, range(2))))
        print(f"two calls one after the other {one_by_one:.0f} ms, by two threads {together:.0f} ms: {one_by_one / together:.2f}")


if __name__ == "__main__":
    main()
