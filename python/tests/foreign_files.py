"""Files of other formats, by the libraries of their fields."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import asammdf
import hdf5storage
import idelib
import netCDF4
import nptdms
import numpy as np
import pyarrow
import pyarrow.feather
import pyarrow.parquet
import pyuff
import scipy.io
import scipy.io.wavfile
from asammdf.signal import InvalidationArray
from ebmlite import loadSchema
from numpy.typing import NDArray

RATE_HZ = 25_000.0
# Of the numbers in a WAV file, g.
FULL_SCALE = 2000.0
Channels = Mapping[str, NDArray[Any]]


def times_of(channels: Channels) -> NDArray[np.float64]:
    return np.arange(len(next(iter(channels.values())))) / RATE_HZ


def tdms(path: Path, channels: Channels, **properties: Any) -> None:
    said = {"wf_increment": 1 / RATE_HZ, "unit_string": "g"} | properties
    with nptdms.TdmsWriter(path) as writer:
        writer.write_segment([nptdms.ChannelObject("daq", name, values, said) for name, values in channels.items()])


def scaled_tdms(path: Path, channels: Channels, kind: str) -> None:
    """Counts with a scale of the DAQmx driver."""
    scale = {"Scale_Type": kind, "Linear_Slope": 0.25, "Linear_Y_Intercept": 1.0, "Linear_Input_Source": np.uint32(0xFFFFFFFF)}
    said = {f"NI_Scale[0]_{name}": value for name, value in scale.items()}
    tdms(path, channels, NI_Scaling_Status="unscaled", NI_Number_Of_Scales=np.uint32(1), **said)


def mdf(
    path: Path, channels: Channels, version: str = "4.10", times_s: Any = None, invalid: Any = None, unit: str = "g", **saving: Any
) -> None:
    bits = None if invalid is None else InvalidationArray(invalid)
    times_s = times_of(channels) if times_s is None else times_s
    with asammdf.MDF(version=version) as file:
        file.append([asammdf.Signal(x, times_s, unit=unit, name=name, invalidation_bits=bits) for name, x in channels.items()])
        file.save(path, overwrite=True, **saving)


def uff(path: Path, channels: Channels, *, binary: bool = False, times_s: Any = None, double: bool = True, **said: Any) -> None:
    file = pyuff.UFF(str(path))
    fields = {"func_type": 1, "abscissa_spec_data_type": 17, "abscissa_axis_units_lab": "s", "ordinate_axis_units_lab": "g"} | said
    for number, (name, values) in enumerate(channels.items(), 1):
        function = pyuff.prepare_58(
            binary=int(binary), id1=name, rsp_node=number, rsp_dir=3, ref_node=1, ref_dir=3, data=np.asarray(values, float),
            x=times_of(channels) if times_s is None else times_s, abscissa_spacing=int(times_s is None), abscissa_min=0.0,
            abscissa_inc=1 / RATE_HZ, ordinate_spec_data_type=12, orddenom_spec_data_type=0, z_axis_spec_data_type=0,
            ord_data_type=4, **fields,
        )  # fmt: skip
        function["ord_data_type"] = 4 if double else 2
        file._write_set(function, mode="add", force_double=double)


def matlab(path: Path, channels: Channels, **saving: Any) -> None:
    scipy.io.savemat(path, {**channels, "Fs": RATE_HZ, **({} if saving else {"note": "hall 3", "test": {"height_m": 9.0}})}, **saving)


def matlab_7_3(path: Path, channels: Channels) -> None:
    hdf5storage.savemat(str(path), {**channels, "Fs": RATE_HZ}, format="7.3")


def netcdf(path: Path, channels: Channels, kind: Any) -> None:
    with netCDF4.Dataset(path, "w", format=kind) as file:
        file.createDimension("time", len(times_of(channels)))
        for name, values in {"time": times_of(channels), **channels}.items():
            variable = file.createVariable(name, "f8", ("time",))
            variable[:] = values
            variable.units = "s" if name == "time" else "g"


def wav(path: Path, channels: Channels) -> None:
    shares = np.stack(list(channels.values()), axis=1) / FULL_SCALE
    scipy.io.wavfile.write(path, int(RATE_HZ), np.round(shares * 2**31).astype(np.int32))


def table(channels: Channels) -> pyarrow.Table:
    return pyarrow.table({"time_s": times_of(channels), **{f"{name} [g]": values for name, values in channels.items()}})


def json_text(path: Path, channels: Channels) -> None:
    rows = zip(times_of(channels).tolist(), *(values.tolist() for values in channels.values()), strict=True)
    path.write_text(json.dumps([dict(zip(["timestamp", *channels], row, strict=True)) for row in rows]))


def ide(path: Path, channels: Channels) -> None:
    """As an enDAQ recorder writes it, in blocks; idelib only reads."""
    schema = loadSchema(str(Path(idelib.__file__).parent / "schemata" / "mide_ide.xml"))
    said = {"SubChannelLabel": "Acceleration", "SubChannelUnits": "g"}
    subchannels = [{"SubChannelID": at, "SubChannelName": name, **said} for at, name in enumerate(channels)]
    channel = {"ChannelID": 8, "ChannelName": "Acceleration", "TimeCodeScale": "1/1000000", "ChannelFormat": "<dd"}
    properties = {
        "RecorderInfo": {"RecorderName": "recorder"},
        "SensorList": {"Sensor": [{"SensorID": 0, "SensorName": "accelerometer"}]},
        "ChannelList": {"Channel": [channel | {"SubChannel": subchannels}]},
    }
    values, block = np.stack(list(channels.values()), axis=1).astype("<f8"), 1000
    parts = [{"EBML": {"DocType": "mide", "DocTypeVersion": 2, "DocTypeReadVersion": 2}}, {"RecordingProperties": properties}]
    for at in range(0, len(values), block):
        part = values[at : at + block]
        ends_us = [round(index / RATE_HZ * 1e6) for index in (at, at + len(part) - 1)]
        codes = {"ChannelIDRef": 8, "StartTimeCodeAbs": ends_us[0], "EndTimeCodeAbs": ends_us[1]}
        parts.append({"ChannelDataBlock": codes | {"ChannelDataPayload": part.tobytes()}})
    path.write_bytes(b"".join(schema.encodes(part) for part in parts))


def npy(path: Path, channels: Channels) -> None:
    np.save(path, np.stack(list(channels.values())))


# By the name of a file: what writes it, and the sources of both channels of what its refusal converts it to.
FORMATS: dict[str, tuple[Callable[[Path, Channels], None], tuple[str, str]]] = {
    "drop.tdms": (tdms, ("daq/A1", "/daq/A2")),
    "drop.mdf": (lambda path, channels: mdf(path, channels, "3.30"), ("ChannelGroup_0/A1", "ChannelGroup_0/A2")),
    "drop.mf4": (mdf, ("ChannelGroup_0/A1", "ChannelGroup_0/A2")),
    "drop.uff": (uff, ("1/A1 1:3", "2/A2 2:3")),
    "drop.58b.uff": (lambda path, channels: uff(path, channels, binary=True), ("1/A1 1:3", "2/A2 2:3")),
    "drop.mat": (matlab, ("A1", "A2")),
    "drop.v4.mat": (lambda path, channels: matlab(path, channels, format="4"), ("A1", "A2")),
    "drop.ide": (ide, ("8 Acceleration/0 A1", "8 Acceleration/1 A2")),
    "drop.nc": (lambda path, channels: netcdf(path, channels, "NETCDF3_CLASSIC"), ("A1", "A2")),
    "drop.wav": (wav, ("samples[0]", "samples[1]")),
    "drop.parquet": (lambda path, channels: pyarrow.parquet.write_table(table(channels), path), ("A1", "A2")),
    "drop.arrow": (lambda path, channels: pyarrow.feather.write_feather(table(channels), str(path)), ("A1", "A2")),
    "drop.json": (json_text, ("A1", "A2")),
    "drop.npy": (npy, ("samples[0]", "samples[1]")),
}
# What the program reads itself.
OWN: dict[str, tuple[Callable[[Path, Channels], None], tuple[str, str]]] = {
    "drop.v7.3.mat": (matlab_7_3, ("A1", "A2")),
    "drop.nc4": (lambda path, channels: netcdf(path, channels, "NETCDF4"), ("A1", "A2")),
}
