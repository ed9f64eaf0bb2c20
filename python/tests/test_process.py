"""HDF5 is taken apart in a process of its own, beside other HDF5 libraries, threads and forks."""

from __future__ import annotations

import multiprocessing
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import dropcheck
import h5py
import numpy as np
import pytest
from conftest import EXAMPLES, Command

RECORDING, CASK = EXAMPLES / "vhlw-rest.h5", EXAMPLES / "vhlw-rest.toml"


def test_beside_h5py(tmp_path: Path) -> None:
    with h5py.File(RECORDING) as recording:
        first = np.asarray(recording["/daq/A1"][:])
        result = dropcheck.analyze(RECORDING, CASK)
        result.write(tmp_path / "report")
        assert np.array_equal(first, recording["/daq/A1"][:])
    with h5py.File(tmp_path / "report" / "curves.h5") as curves:
        assert len(curves) > 0
    with h5py.File(tmp_path / "own.h5", "w") as own:
        own["x"] = first
    assert dropcheck.inspect(tmp_path / "own.h5").channels[0].source == "/x"


def in_python(code: str, **variables: str) -> subprocess.CompletedProcess[str]:
    words = [sys.executable, "-c", f"import sys, dropcheck\n{code}", str(RECORDING), str(CASK)]
    return subprocess.run(words, capture_output=True, text=True, check=False, env=os.environ | variables)


def test_without_an_interpreter_to_start_the_error_says_so() -> None:
    code = "sys.executable = None\ntry: dropcheck.inspect(sys.argv[1])\nexcept dropcheck.Error as e: print(e)"
    said = in_python(code).stdout
    assert "no program was named for it" in said and "dropcheck.read_hdf5_with(python)" in said
    code = "python = sys.executable; sys.executable = None; dropcheck.read_hdf5_with(python)\nprint(dropcheck.inspect(sys.argv[1]).format)"
    assert in_python(code).stdout == "HDF5\n"
    code = "sys.executable = '/bin/false'\ntry: dropcheck.inspect(sys.argv[1])\nexcept dropcheck.Error as e: print(e)"
    assert "/bin/false could not be started for it" in in_python(code).stdout


def test_variables_that_load_code_do_not_reach_the_library(tmp_path: Path, command: Command) -> None:
    os.environ |= {"HDF5_DRIVER": "x", "HDF5_VOL_CONNECTOR": "x", "HDF5_PLUGIN_PATH": str(tmp_path)}
    try:
        report = tmp_path / "report"
        said = command("analyze", RECORDING, "--cask", CASK, "--out", report)
        assert said.returncode in {0, 1} and said.stderr == b"" and (report / "curves.h5").exists()
        assert dropcheck.inspect(RECORDING).channels
    finally:
        for name in ["HDF5_DRIVER", "HDF5_VOL_CONNECTOR", "HDF5_PLUGIN_PATH"]:
            del os.environ[name]


@pytest.mark.skipif(shutil.which("strace") is None, reason="strace is not installed")
def test_the_process_opens_nothing_but_the_recording(tmp_path: Path) -> None:
    code = "import sys, dropcheck; dropcheck.analyze(sys.argv[1], sys.argv[2])"
    calls = "trace=open,openat,execve,seccomp,landlock_restrict_self"
    trace = ["strace", "-ff", "-e", calls, "-o", str(tmp_path / "trace")]
    subprocess.run([*trace, sys.executable, "-c", code, str(RECORDING), str(CASK)], check=True)
    traces = [path.read_text() for path in tmp_path.iterdir()]
    reader = next(text for text in traces if '"__hdf5"' in text)
    walled = reader.split("seccomp(", 1)[1].splitlines()
    opened = [line for line in walled if line.startswith("open") and "= -1" not in line]
    assert len(opened) == 1 and "vhlw-rest.h5" in opened[0]


def analysed(path: str) -> str:
    return dropcheck.analyze(path, CASK).to_json()


def test_threads_and_forks_say_the_same() -> None:
    expected = analysed(str(RECORDING))
    with ThreadPoolExecutor(4) as threads:
        assert set(threads.map(analysed, [str(RECORDING)] * 8)) == {expected}
    # The threads of the parent are not there in a forked process.
    with multiprocessing.get_context("fork").Pool(2) as forked:
        assert set(forked.map_async(analysed, [str(RECORDING)] * 4).get(timeout=60)) == {expected}
