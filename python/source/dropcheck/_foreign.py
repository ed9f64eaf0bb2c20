"""Recordings of formats that dropcheck does not read to samples by name, and to HDF5, by the libraries of their fields."""

from __future__ import annotations

import gc
import logging
import os
import sys
import tempfile
import threading
import traceback
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from . import Error, Samples, __version__, _dropcheck

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Refused(Exception):
    """Where in a file, what is wrong, and how to mend it."""

    def __init__(self, place: str, problem: str, mend: str = "") -> None:
        super().__init__(place, problem, mend or "export the channels from the program that wrote it as CSV, HDF5 or MCAP")

    def of(self, path: str) -> Error:
        """The error in the words of the command."""
        place, problem, mend = self.args
        return Error(f"{path}: {place}: {problem}\n  help: {mend}")


def samples(path: str) -> dict[str, Samples]:
    """What `from_file` hands over."""
    try:
        return _read(path, _dropcheck.foreign_format(path))[0]
    except Refused as refused:
        raise refused.of(path) from refused


def into_hdf5(path: str, kind: str, into: str) -> list[str]:
    """Converts for the command: the reader with its version; or where, what is wrong, and how to mend it."""
    try:
        held, reader = _read(path, kind)
        _write(held, into, {})
    except Refused as refused:
        return list(refused.args)
    return [reader]


def convert(words: list[str]) -> int:
    """The command `convert`."""
    import argparse

    parser = argparse.ArgumentParser("dropcheck convert", description="Convert a recording of another format to HDF5")
    parser.add_argument("recording", metavar="RECORDING", help=f"a file of: {', '.join(sorted(_READERS))}")
    parser.add_argument("--to", required=True, metavar="FILE.h5", help="the file to write; none that is there")
    try:
        arguments = parser.parse_args(words)
    except SystemExit as ended:
        return int(ended.code or 0)
    recording, into = arguments.recording, arguments.to
    try:
        if os.path.lexists(into):
            raise Error(f"{into} is there already\n  help: name a file that is not, or take it away first")
        kind = _dropcheck.foreign_format(recording)
        before = _dropcheck.sha256(recording)
        held, reader = _read(recording, kind)
        if before != _dropcheck.sha256(recording):
            raise Refused("the whole file", "it changed while it was being read", "wait until it is written")
        about = {"recording": os.path.basename(recording), "recording_sha256": before, "converted_by": reader}
        with tempfile.TemporaryDirectory(dir=os.path.dirname(into) or ".", prefix=".dropcheck-") as folder:
            unfinished = os.path.join(folder, "curves.h5")
            _write(held, unfinished, about | {"program": f"dropcheck {__version__}"})
            os.replace(unfinished, into)
    except OSError as fault:
        print(f"error: {into} cannot be written: {fault.strerror}", file=sys.stderr)
        return 2
    except (Error, Refused) as refused:
        print(f"error: {refused.of(recording) if isinstance(refused, Refused) else refused}", file=sys.stderr)
        return 2
    print(f"Written: {into}, {len(held)} channels by {reader}; `dropcheck inspect` lists them")
    return 0


# Warnings are caught for the whole process: one reader at a time.
_alone = threading.Lock()


def _read(path: str, kind: str) -> tuple[dict[str, Samples], str]:
    """The samples by name, and the library with its version."""
    from importlib.metadata import PackageNotFoundError, version

    library, samples_of = _READERS[kind]
    try:
        reader = f"{library} {version(library)}"
    except PackageNotFoundError as missing:
        install = f"pip install 'dropcheck[{kind}]'"
        raise Refused("the whole file", f"{library}, which reads it, is not installed", install) from missing
    held, problem = {}, "it holds no samples over time"
    with _alone, _warnings_are_errors() as said:
        try:
            held = dict(samples_of(path))
        except Refused:
            raise
        except Warning as warned:
            said.append(str(warned))
        except Exception as fault:
            problem = f"{type(fault).__name__}: {fault}"
            traceback.clear_frames(fault.__traceback__)
        if not held:
            # What is half made ends here, in silence.
            gc.collect()
    if said or not held:
        raise Refused(f"as {reader} reads it", f"it warns: {said[0]}" if said else problem)
    return held, reader


@contextmanager
def _warnings_are_errors() -> Iterator[list[str]]:
    """Raises what this thread warns of or logs as a warning, which stands in the list where a library goes on all the same."""
    own, before, hook = threading.get_ident(), logging.getLogRecordFactory(), sys.unraisablehook
    said: list[str] = []

    def record(*args: Any, **named: Any) -> logging.LogRecord:
        made = before(*args, **named)
        if made.levelno >= logging.WARNING and made.thread == own:
            said.append(made.getMessage())
            raise UserWarning(said[0])
        return made

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for category in (UserWarning, RuntimeWarning):
            warnings.simplefilter("error", category)
        logging.setLogRecordFactory(record)
        sys.unraisablehook = lambda _: None
        try:
            yield said
        finally:
            logging.setLogRecordFactory(before)
            sys.unraisablehook = hook


def _is_numbers(values: Any) -> bool:
    return getattr(getattr(values, "dtype", None), "kind", "") in "fiu" and getattr(values, "ndim", 0) == 1 and values.size > 0


def _of_tdms(path: str) -> Iterator[tuple[str, Samples]]:
    from nptdms import TdmsFile

    channels = [channel for group in TdmsFile.read(path).groups() for channel in group.channels()]
    channels = [channel for channel in channels if _is_numbers(channel[:])]
    starts = {channel.properties.get("wf_start_time") for channel in channels}
    if len(starts) > 1 and None in starts:
        raise Refused("wf_start_time", "channels start at different times, and some do not say when")
    for channel in channels:
        said = channel.properties
        # npTDMS has done what NI_Scale says, and nothing else.
        undone = [name for name in said if not name.startswith("NI_") and _dropcheck.is_conversion(name)]
        if undone:
            raise Refused(f"channel {channel.name}", f"its property {undone[0]} is a conversion that nobody does")
        late = (said["wf_start_time"] - min(starts)).astype("m8[ns]").astype(float) * 1e-9 if len(starts) > 1 else 0.0
        interval_s = float(said.get("wf_increment", 0))
        yield f"{channel.group_name}/{channel.name}", Samples(
            channel[:],
            rate_hz=1 / interval_s if interval_s > 0 else None,
            unit=str(said.get("unit_string", "")) or None,
            start_s=late + float(said.get("wf_start_offset", 0)),
        )


def _of_mdf(path: str) -> Iterator[tuple[str, Samples]]:
    import numpy as np
    from asammdf import MDF

    with MDF(path) as file:
        for number, index in enumerate(file.virtual_groups):
            group = f"ChannelGroup_{number}"
            master = file.masters_db.get(index)
            # 1: time; else the master counts angles, lengths or samples.
            is_timed = master is not None and getattr(file.groups[index].channels[master], "sync_type", 1) == 1
            places = [(None, part, at) for part, all_at in file.included_channels(index)[index].items() for at in all_at]
            signals = [signal for signal in file.select(places) if _is_numbers(signal.samples)] if places else []
            names = [signal.name for signal in signals]
            for signal in signals:
                if names.count(signal.name) > 1:
                    raise Refused(group, f"several channels are named {signal.name}")
                values = signal.samples
                if signal.invalidation_bits is not None:
                    values = np.where(np.asarray(signal.invalidation_bits, bool), np.nan, values)
                times_s = signal.timestamps if is_timed else None
                yield f"{group}/{signal.name}", Samples(values, times_s=times_s, unit=signal.unit or None)


def _of_uff(path: str) -> Iterator[tuple[str, Samples]]:
    import pyuff

    with open(path, "rb") as file:
        file.seek(-min(os.path.getsize(path), 100), os.SEEK_END)
        if file.read().split()[-1:] != [b"-1"]:
            raise Refused("its end", "the last data set is cut off", "take the original from the recorder again")
    file = pyuff.UFF(path)
    sets = [file.read_sets(at) for at, kind in enumerate(file.get_set_types()) if kind == 58]
    for number, said in enumerate(sets, 1):
        if said["func_type"] != 1 or not _is_numbers(said["data"]):
            continue
        name = "{}/{id1} {rsp_node}:{rsp_dir}".format(number, **said)
        place = f"function {number}, {said['id1']}"
        if len(said["data"]) != said["num_pts"]:
            raise Refused(place, f"it states {said['num_pts']} samples and holds {len(said['data'])}")
        if said.get("fp_format", 2) != 2:
            raise Refused(place, f"its numbers are not of IEEE 754 but of format {said['fp_format']}, which pyuff does not read")
        if said["abscissa_axis_units_lab"] not in ("", "NONE", "s", "sec"):
            raise Refused(place, f"its abscissa is in {said['abscissa_axis_units_lab']}, not in s")
        unit = said["ordinate_axis_units_lab"]
        unit = None if unit in ("", "NONE") else unit
        if said["abscissa_spacing"] == 0:
            yield name, Samples(said["data"], times_s=said["x"], unit=unit)
        else:
            rate_hz = 1 / said["abscissa_inc"] if said["abscissa_inc"] > 0 else None
            yield name, Samples(said["data"], rate_hz=rate_hz, unit=unit, start_s=said["abscissa_min"])


def _of_mat(path: str) -> Iterator[tuple[str, Samples]]:
    import scipy.io

    def within(held: Mapping[str, Any], above: str) -> Iterator[tuple[str, Samples]]:
        for name, value in held.items():
            if isinstance(value, dict):
                yield from within(value, f"{above}{name}/")
            elif isinstance(value, (int, float)) and not isinstance(value, bool):
                yield above + name, Samples([value])
            elif _is_numbers(value):
                yield above + name, Samples(value)
            elif getattr(value, "ndim", 0) == 2 and value.dtype.kind in "fiu":
                # The longer side is that of the samples.
                for at, column in enumerate(value if value.shape[0] < value.shape[1] else value.T):
                    yield f"{above}{name}[{at}]", Samples(column)

    held = scipy.io.loadmat(path, simplify_cells=True)
    return within({name: value for name, value in held.items() if not name.startswith("__")}, "")


def _of_ide(path: str) -> Iterator[tuple[str, Samples]]:
    import idelib

    logging.getLogger("idelib.dataset").setLevel(logging.WARNING)
    with idelib.importFile(path) as file:
        for channel in file.channels.values():
            events = channel.getSession()
            if len(events) == 0:
                continue
            times_us, *values = events.arraySlice()
            for at, (part, column) in enumerate(zip(channel.subchannels, values, strict=True)):
                name = f"{channel.id} {channel.name}/{at} {part.name}"
                yield name, Samples(column, times_s=times_us * 1e-6, unit=part.units[1] or None)


_READERS: dict[str, tuple[str, Callable[[str], Iterator[tuple[str, Samples]]]]] = {
    "ide": ("idelib", _of_ide),
    "mat": ("scipy", _of_mat),
    "mdf": ("asammdf", _of_mdf),
    "tdms": ("npTDMS", _of_tdms),
    "uff": ("pyuff", _of_uff),
}


def _write(held: Mapping[str, Samples], into: str, about: Mapping[str, str]) -> None:
    """The HDF5 file that `docs/formats.md` describes under "What a converter writes"."""
    try:
        import h5py
        import numpy as np
    except ImportError as missing:
        raise Refused("its HDF5 file", f"{missing}, which writes it", "pip install h5py") from missing
    times_of: dict[str, NDArray[np.float64]] = {}
    try:
        with h5py.File(into, "w") as file:
            file.attrs.update(about)
            for name, samples in held.items():
                said: dict[str, Any] = {} if samples.unit is None else {"unit": samples.unit}
                if samples.rate_hz is not None:
                    said |= {"sample_rate_hz": samples.rate_hz, "start_time_s": samples.start_s}
                # MATLAB's single values, such as Fs, are statements about the others.
                values = samples.values if len(samples.values) > 1 else samples.values[0]
                file.create_dataset(name, data=values).attrs.update(said)
                if samples.times_s is None:
                    continue
                group = name.rpartition("/")[0]
                if not np.array_equal(times_of.setdefault(group, samples.times_s), samples.times_s):
                    raise Refused(group, f"{name} has other times than the channels before it")
            for group, times_s in times_of.items():
                file.create_dataset(f"{group}/time_s", data=times_s).attrs["unit"] = "s"
    except (OSError, ValueError) as fault:
        raise Refused("its HDF5 file", f"cannot be written: {fault}", "name another place; no two channels may have one name") from fault
