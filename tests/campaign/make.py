"""From a seed to a folder of recordings with cask files and truths: random drops, undamaged or each with one damage.

python3 tests/campaign/make.py FOLDER --scenes 300 --seed 77 [--damaged]
"""

import argparse
import json
import sys
from math import inf, isfinite
from pathlib import Path

import h5py
import numpy as np
from damages import KINDS, damage
from scenes import draw_drop, record

import formats  # from fixtures/reference/, which `scenes` puts on the path

REPOSITORY = Path(__file__).resolve().parents[2]


def cask_file_text(drop, sources, statement):
    """The cask file; what `statement` holds is said in place of what is so."""
    lines = ["[cask]", f'name = "{drop.name}"', *(f"{key} = {value}" for key, value in drop.cask.items())]
    lines += ["", "[drop]", f"height_m = {statement.get('height_m', drop.height_m)}"]
    lines += [f"angle_deg = {statement.get('angle_deg', drop.angle_deg)}"]
    if drop.friction_text is not None:
        lines += ["", "[contact]", f"friction = {drop.friction_text}"]
    positions_m = statement.get("positions_m", drop.positions_m)
    for name, source in sources.items():
        end = 1 if name == "A2" else 0
        unit = statement.get("units", {}).get(name, "g")
        lines += ["", "[[channel]]", f'name = "{name}"', f'end = "{("first", "second")[end]}"']
        lines += [f'axis = "{"axial" if name == "A3" else "transverse"}"', f'source = "{source}"']
        lines += [f'unit = "{unit}"', f"position_m = {positions_m[end]}"]
        if drop.offsets_m[end]:
            lines += [f"offset_m = {drop.offsets_m[end]}"]
        lines += statement.get("lines", {}).get(name, [])
    return "\n".join(lines) + "\n"


def write_hdf5(path, channels, rate_hz, units, packed):
    """One dataset of 32-bit floats a channel, which may hold NaN."""
    options = {"compression": "gzip", "compression_opts": 1, "shuffle": True} if packed else {}
    with h5py.File(path, "w") as file:
        for name, samples in channels.items():
            dataset = file.create_dataset("daq/" + name, data=np.asarray(samples, "f4"), **options)
            dataset.attrs["sample_rate_hz"] = float(rate_hz)
            dataset.attrs["unit"] = units.get(name, "g")


def write_mcap(path, channels, rate_hz, compression, block=1000, missing=()):
    """Protobuf blocks; `missing` names the (channel, block) pairs that are lost."""
    topics = {"/daq/" + name.lower(): samples for name, samples in channels.items()}
    lost = {("/daq/" + name.lower(), number) for name, number in missing}
    formats.write_mcap(path, "protobuf", topics, rate_hz, compression=compression, block=block, drop=lost)


def truth_text(drop, recording, impact_s, kind, note):
    """The truth of the fixtures, then what the scene was."""
    scene = drop.motion.scene
    modes = [
        {"order": m.order, "frequency_hz": round(m.frequency_hz, 1), "damping": round(m.damping, 3), "strength": round(m.strength, 2)}
        for m in scene.modes
    ]
    said = {
        "recording": recording, "t_impact": impact_s, "damage": kind, "note": note,
        "sample_rate_hz": drop.sample_rate_hz, "drop_height_m": drop.height_m, "noise_g": drop.noise_g,
        "friction": None if scene.friction == inf else scene.friction, "rest": drop.release_s is not None,
        "axial": drop.axial, "plateau": isfinite(scene.first.yield_n), "modes": modes,
    }
    return json.dumps(drop.truth | said, indent=1, default=float) + "\n"


def write_undamaged(folder, stem, rng):
    """One in five as MCAP, the others as HDF5."""
    drop = draw_drop(rng)
    _, channels = record(drop, rng)
    if rng.random() < 0.2:
        recording = stem + ".mcap"
        write_mcap(folder / recording, channels, drop.sample_rate_hz, str(rng.choice(["zstd", "lz4", "none"])))
        sources = {name: f"/daq/{name.lower()}.samples" for name in channels}
    else:
        recording = stem + ".h5"
        write_hdf5(folder / recording, channels, drop.sample_rate_hz, {}, rng.random() < 0.3)
        sources = {name: "/daq/" + name for name in channels}
    (folder / (stem + ".toml")).write_text(cask_file_text(drop, sources, {}))
    (folder / (stem + ".truth.json")).write_text(truth_text(drop, recording, drop.before_s, None, None))


def write_damaged(folder, stem, rng, kind):
    """HDF5, but MCAP where blocks are lost."""
    case = damage(kind, draw_drop(rng, plain=True), rng)
    drop = case.drop
    if case.missing_blocks:
        recording = stem + ".mcap"
        write_mcap(folder / recording, case.channels, drop.sample_rate_hz, "zstd", case.block_samples, case.missing_blocks)
        sources = {name: f"/daq/{name.lower()}.samples" for name in case.channels}
    else:
        recording = stem + ".h5"
        write_hdf5(folder / recording, case.channels, drop.sample_rate_hz, case.statement.get("units", {}), rng.random() < 0.3)
        sources = {name: "/daq/" + name for name in case.channels}
    (folder / (stem + ".toml")).write_text(cask_file_text(drop, sources, case.statement))
    (folder / (stem + ".truth.json")).write_text(truth_text(drop, recording, case.impact_s, kind.__name__, case.note))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--scenes", type=int, default=300)
    parser.add_argument("--seed", type=int, default=77)
    parser.add_argument("--damaged", action="store_true")
    words = parser.parse_args()
    folder = words.folder.resolve()
    if folder.is_relative_to(REPOSITORY):
        sys.exit(f"{folder} lies in the repository; name a folder outside it, 300 recordings take about 100 MB")
    folder.mkdir(parents=True, exist_ok=True)
    for number in range(words.scenes):
        rng = np.random.default_rng([words.seed, number])
        if words.damaged:
            write_damaged(folder, f"{number:03d}", rng, KINDS[number % len(KINDS)])
        else:
            write_undamaged(folder, f"{number:03d}", rng)


if __name__ == "__main__":
    main()
