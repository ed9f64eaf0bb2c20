"""From a seed to a folder of recordings with cask files and a `reference.toml` of their truth: random drops of the other
simulation. Python 3.11, with the packages of `fixtures/reference/requirements.txt`; outside the repository:

    python3 tests/campaign/make.py ../drops --scenes 200 --seed 20261121
    dropcheck validate --quick --reference ../drops

says of each drop whether the stated intervals hold its truth. 200 drops take two minutes and 60 MB.
"""

import argparse
import sys
from pathlib import Path

import h5py
import numpy as np
from scenes import draw_drop, record

import formats  # from fixtures/reference/, which `scenes` puts on the path

REPOSITORY = Path(__file__).resolve().parents[2]
EXPECTED = {  # key of reference.toml: key of the truth
    "slap_down_speed_m_s": "speed", "k": "k", "angular_velocity_rad_s": "omega_rebound",
}


def cask_file_text(drop, sources):
    """The cask file: all of it true."""
    lines = ["[cask]", f'name = "{drop.name}"', *(f"{key} = {value}" for key, value in drop.cask.items())]
    lines += ["", "[drop]", f"height_m = {drop.height_m}", f"angle_deg = {drop.angle_deg}"]
    if drop.friction_text is not None:
        lines += ["", "[contact]", f"friction = {drop.friction_text}"]
    for name, source in sources.items():
        end = 1 if name == "A2" else 0
        lines += ["", "[[channel]]", f'name = "{name}"', f'end = "{("first", "second")[end]}"']
        lines += [f'axis = "{"axial" if name == "A3" else "transverse"}"', f'source = "{source}"']
        lines += ['unit = "g"', f"position_m = {drop.positions_m[end]}"]
        if drop.offsets_m[end]:
            lines += [f"offset_m = {drop.offsets_m[end]}"]
    return "\n".join(lines) + "\n"


def write_hdf5(path, channels, rate_hz, packed):
    """One dataset of 32-bit floats a channel."""
    options = {"compression": "gzip", "compression_opts": 1, "shuffle": True} if packed else {}
    with h5py.File(path, "w") as file:
        for name, samples in channels.items():
            dataset = file.create_dataset("daq/" + name, data=np.asarray(samples, "f4"), **options)
            dataset.attrs["sample_rate_hz"] = float(rate_hz)
            dataset.attrs["unit"] = "g"


def write(folder, stem, rng):
    """One drop, one in five as MCAP, the others as HDF5; its table of `reference.toml`."""
    drop = draw_drop(rng)
    channels = record(drop, rng)
    if rng.random() < 0.2:
        recording = stem + ".mcap"
        topics = {"/daq/" + name.lower(): samples for name, samples in channels.items()}
        compression = str(rng.choice(["zstd", "lz4", "none"]))
        formats.write_mcap(folder / recording, "protobuf", topics, drop.sample_rate_hz, compression=compression)
        sources = {name: f"/daq/{name.lower()}.samples" for name in channels}
    else:
        recording = stem + ".h5"
        write_hdf5(folder / recording, channels, drop.sample_rate_hz, rng.random() < 0.3)
        sources = {name: "/daq/" + name for name in channels}
    (folder / (stem + ".toml")).write_text(cask_file_text(drop, sources))
    expected = [f"{key} = {float(drop.truth[truth])!r}" for key, truth in EXPECTED.items()]
    return "\n".join([f'["{recording}"]', *expected])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--scenes", type=int, default=200)
    parser.add_argument("--seed", type=int, default=20261121)
    words = parser.parse_args()
    folder = words.folder.resolve()
    if folder.is_relative_to(REPOSITORY):
        sys.exit(f"{folder} lies in the repository; name a folder outside it")
    folder.mkdir(parents=True, exist_ok=True)
    seeds = ((number, np.random.default_rng([words.seed, number])) for number in range(words.scenes))
    tables = [write(folder, f"{number:03d}", rng) for number, rng in seeds]
    (folder / "reference.toml").write_text("\n\n".join(tables) + "\n")


if __name__ == "__main__":
    main()
