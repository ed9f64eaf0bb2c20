"""What accelerometers on both ends of a dropped cask say about its slap-down, and whether to believe it.

    import dropcheck

    result = dropcheck.analyze("drop.mcap", "cask.toml")
    result.verdict                   # "pass", "review" or "fail"
    result.slap_down.speed.value     # m/s; .u95 is the half-width of its 95 % interval
    result.curves["A1.velocity_m_s"] # numpy

Samples of any other reader come as arrays, named as the cask file names its sources (or all its channels):

    from nptdms import TdmsFile

    channels = TdmsFile.read("drop.tdms")["daq"].channels()
    rate_hz = 1 / channels[0].properties["wf_increment"]
    held = {channel.name: dropcheck.Samples(channel[:], rate_hz=rate_hz, unit="g") for channel in channels}
    result = dropcheck.analyze(held, "cask.toml")

Whatever is at fault with a file or its content raises `dropcheck.Error` with the one message of the command.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from . import _dropcheck
from ._dropcheck import Error, __version__
from ._record import Answer, Comparison, FilteredPeak, Finding, FirstImpact, Quantity, Record, Result, Shock, SlapDown

if TYPE_CHECKING:
    import numpy as np
    import pandas
    from numpy.typing import ArrayLike, NDArray

    Path = str | os.PathLike[str]

__all__ = [
    "Answer",
    "Comparison",
    "Error",
    "FilteredPeak",
    "Finding",
    "FirstImpact",
    "Quantity",
    "Record",
    "Result",
    "Samples",
    "Shock",
    "SlapDown",
    "__version__",
    "analyze",
    "from_file",
    "inspect",
    "main",
    "predict",
    "read_hdf5_with",
    "synth",
]


class Samples:
    """Samples of one channel in memory.

    `values` is a one-dimensional array of real numbers; NaN, infinite and masked ones are missing. State `rate_hz`, or a
    time a sample by `times_s` in seconds, or `sample_rate_hz` in the cask file; and `unit` ("g", "m/s^2", …), or `unit`
    in the cask file. `start_s` is the time of the first sample where channels do not begin together.
    """

    __slots__ = ("rate_hz", "start_s", "times_s", "unit", "values")

    def __init__(
        self,
        values: ArrayLike,
        *,
        rate_hz: float | None = None,
        unit: str | None = None,
        times_s: ArrayLike | None = None,
        start_s: float = 0.0,
    ) -> None:
        self.values = _array("the samples", values)
        self.times_s = None if times_s is None else _array("times_s", times_s)
        self.rate_hz = None if rate_hz is None else _number("rate_hz", rate_hz)
        if self.rate_hz is not None and not 0 < self.rate_hz < float("inf"):
            raise ValueError(f"rate_hz is {rate_hz}: a rate is above zero")
        if not (unit is None or isinstance(unit, str)):
            raise TypeError(f"unit is {unit!r}: a text is needed, such as 'g' or 'm/s^2'")
        self.unit = unit
        self.start_s = _number("start_s", start_s)

    def __repr__(self) -> str:
        rate = "" if self.rate_hz is None else f", rate_hz={self.rate_hz:g}"
        unit = "" if self.unit is None else f", unit={self.unit!r}"
        return f"Samples({len(self.values)} values{rate}{unit})"


def analyze(
    recording: Path | Mapping[str, Samples] | pandas.DataFrame,
    cask: Path | Mapping[str, Any],
    *,
    without: Iterable[str] = (),
    max_memory: str | None = None,
) -> Result:
    """Analyses a recording in MCAP, HDF5, CSV or ISO-MME, or samples in memory by name.

    The names are those of each `source` in the cask file, or of each channel's `name`. Of a DataFrame each column is a
    channel; an index called `time_s`, or one of times, dates the rows, else the cask file states the rate. `cask` may be a
    dict as `tomllib` reads a cask file; paths in it count from the working folder. `without` leaves corrections of the
    samples out ("offset", "zero_shift", "skew", "hum"); `max_memory` is what reading may take, such as "8GB".
    """
    _name_interpreter()
    given = None
    if hasattr(recording, "columns") and hasattr(recording, "index"):
        recording = _of_frame(recording)
    if isinstance(recording, Mapping):
        given = [_named(name, samples) for name, samples in recording.items()]
        recording = "samples in memory"
    corrections = [without] if isinstance(without, str) else [str(name) for name in without]
    with _cask_file(cask) as file:
        words = ["analyze", _path(recording), "--cask", file, "--json", "-"]
        words += ["--without", ",".join(corrections)] if corrections else []
        words += [] if max_memory is None else [f"--max-memory={max_memory}"]
        return Result(_dropcheck.analyze(words, given))


def predict(
    cask: Path | Mapping[str, Any],
    *,
    angle_deg: float | None = None,
    k: float | None = None,
    contact: str | float | None = None,
    duration_s: float | None = None,
    sweep: str | Iterable[str] = (),
    draws: int | None = None,
    seed: int | None = None,
) -> Answer:
    """Predicts the slap-down by the analytical model: `.predictions`, and what else `predict --json` says.

    Without `k` and `contact` ("rough", "smooth" or a Coulomb coefficient) the four borderline cases; `sweep` is "5:45:5"
    or "k=0:1:0.1", or several of them. The cask file needs no channel.
    """
    words = ["predict", "--json", "-"]
    numbers = {"angle": angle_deg, "k": k, "duration": duration_s, "draws": draws, "seed": seed}
    words += [f"--{name}={_number(name, value)!r}" for name, value in numbers.items() if value is not None]
    words += [] if contact is None else [f"--contact={contact}"]
    words += [f"--sweep={range}" for range in ([sweep] if isinstance(sweep, str) else sweep)]
    with _cask_file(cask) as file:
        return Answer(_dropcheck.predict([*words, "--cask", file]))


def from_file(recording: Path) -> dict[str, Samples]:
    """Reads a recording in TDMS, MDF 3 or 4, UFF 58 or 58b, MATLAB before 7.3 or IDE to samples by name.

    The library of the format does it: `pip install 'dropcheck[tdms]'` installs that of TDMS; likewise `[mdf]`, `[uff]`,
    `[mat]`, `[ide]`. What it warns of is an error. Rate and unit are those that the file states, else the cask file states
    them; MATLAB files state neither, and hold single values such as `Fs` beside the channels. The names are sources as
    `inspect` lists them, without the first slash.

    `analyze` and `inspect` also take the file itself, and so do the commands `analyze`, `inspect`, `init` and `batch`;
    `reader` under `input` of the result names the library. `dropcheck convert RECORDING --to FILE.h5` writes it as HDF5,
    for machines without Python. The library reads in this process, without the isolation that HDF5 has.
    """
    from . import _foreign

    return _foreign.samples(os.fsdecode(recording))


def inspect(recording: Path) -> Answer:
    """Lists what a recording holds: `.channels` with source, rate, unit and gaps, and the `.issues` of the file."""
    _name_interpreter()
    return Answer(_dropcheck.inspect(os.fsdecode(recording)))


def synth(scene: Path, out: Path | None = None, *, seed: int | None = None, encoding: str | None = None) -> Answer:
    """Makes a synthetic recording of a scene file, with its cask file and its truth beside it.

    `out` ends in .mcap, .h5, .hdf5 or .csv; else it is the scene's name with -synth.mcap, beside the scene. The answer is
    the truth, such as `.k`, with the `.files` that were written: recording, cask file, truth.
    """
    import json

    words = ["synth", _path(scene)]
    words += [] if out is None else ["--out", _path(out)]
    words += [] if seed is None else [f"--seed={_number('seed', seed)!r}"]
    words += [] if encoding is None else [f"--encoding={encoding}"]
    files = [os.fspath(path) for path in _dropcheck.synth(words)]
    with open(files[2], encoding="utf-8") as truth:
        return Answer(json.dumps(json.load(truth) | {"files": files}).encode())


def main(argv: list[str] | None = None) -> int:
    """Runs the command `dropcheck` with these words, else those of the process, and returns its exit status."""
    import signal
    import threading

    _name_interpreter()
    words = sys.argv[1:] if argv is None else argv
    if words[:1] == ["convert"]:
        from . import _foreign

        return _foreign.convert(words[1:])
    if argv is None:
        # The process is the command's: Ctrl-C ends it at once, and the HDF5 library loads no code that variables name.
        if threading.current_thread() is threading.main_thread():
            signal.signal(signal.SIGINT, signal.SIG_DFL)
        for name in [name for name in os.environ if name.startswith("HDF5_")]:
            del os.environ[name]
        os.environ["HDF5_PLUGIN_PRELOAD"] = "::"
    return _dropcheck.main(words)


def __dir__() -> list[str]:
    return sorted(__all__)


def read_hdf5_with(python: Path) -> None:
    """Names the Python interpreter that takes HDF5 files apart, before the first is read: where `sys.executable` is none."""
    words = ["-S", "-c", _TAKE_APART.format(os.path.dirname(os.path.abspath(__file__)))]
    needed = ["LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "PYTHONHOME", "SYSTEMROOT"]
    variables = [(name, os.environ[name]) for name in needed if name in os.environ]
    _dropcheck.read_hdf5_by(os.fsdecode(python), words, variables)
    _named_already.append(True)


# The interpreter is started for each HDF5 file without its site packages; the extension alone is loaded.
_TAKE_APART = "import sys; sys.path.insert(0, {!r}); import _dropcheck; _dropcheck.take_hdf5_apart(sys.argv[2])"
_named_already: list[bool] = []


def _name_interpreter() -> None:
    if not _named_already and sys.executable:
        read_hdf5_with(sys.executable)


def _path(path: Path) -> str:
    text = os.fsdecode(path)
    # A name must not be taken for an option.
    return os.path.join(".", text) if text.startswith("-") else text


@contextmanager
def _cask_file(cask: Path | Mapping[str, Any]) -> Iterator[str]:
    """The path of a cask file, which is written for the time being where a dict is given."""
    if not isinstance(cask, Mapping):
        yield _path(cask)
        return
    from tempfile import TemporaryDirectory

    with TemporaryDirectory(prefix="dropcheck-") as folder:
        file = os.path.join(folder, "cask.toml")
        with open(file, "w", encoding="utf-8") as text:
            text.write("\n".join(f"{_toml(str(key))} = {_toml(value, str(key))}" for key, value in cask.items()))
        yield file


# Keys whose values are paths beside the cask file.
_PATHS = ("file", "rest", "sensors")


def _toml(value: Any, key: str = "") -> str:
    import json
    from numbers import Integral, Real

    if isinstance(value, str | os.PathLike):
        text = os.fspath(value)
        return json.dumps(os.path.abspath(text) if key in _PATHS else text, ensure_ascii=False)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Real):
        return str(int(value)) if isinstance(value, Integral) else repr(float(value))
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_toml(str(name))} = {_toml(of, str(name))}" for name, of in value.items()) + "}"
    if isinstance(value, Iterable):
        return "[" + ", ".join(_toml(of, key) for of in value) + "]"
    raise TypeError(f"{key} is {value!r}: a cask file holds texts, numbers, true and false, lists and tables")


def _of_frame(frame: pandas.DataFrame) -> dict[str, Samples]:
    index, times_s = frame.index, None
    if hasattr(index, "total_seconds"):
        times_s = index.total_seconds()
    elif index.dtype.kind == "M":
        times_s = (index - index[0]).total_seconds()
    elif index.name == "time_s":
        times_s = index
    elif not (index.dtype.kind in "iu" and index.name is None):
        name = index.name or "without a name"
        raise TypeError(f"the index is {name}: call it time_s if it holds seconds, else reset_index(drop=True)")
    return {str(name): Samples(frame[name], times_s=times_s) for name in frame.columns}


def _number(name: str, value: float) -> float:
    from numbers import Real

    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(f"{name} is {value!r}: a number is needed")
    return value if isinstance(value, int) else float(value)


def _named(name: str, samples: Samples) -> tuple[str, Samples]:
    if not isinstance(name, str):
        raise TypeError(f"{name!r} names samples: a text is needed, as `source` or `name` of a channel in the cask file")
    if not isinstance(samples, Samples):
        kind = type(samples).__name__
        raise TypeError(f"{name!r} is of type {kind}: write dropcheck.Samples(values, rate_hz=…, unit=…)")
    return name, samples


def _array(what: str, values: ArrayLike) -> NDArray[np.float64]:
    import numpy as np

    if isinstance(values, np.ma.MaskedArray):
        values = np.ma.filled(values.astype(np.float64), np.nan)
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{what} are of type {array.dtype}: real numbers are needed")
    if array.ndim != 1:
        raise ValueError(f"{what} have the shape {array.shape}: one dimension is needed, such as values[:, 0]")
    return np.ascontiguousarray(array, dtype=np.float64)
