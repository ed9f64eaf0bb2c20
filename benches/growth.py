"""From recordings of growing size to a chart and a table: how dropcheck's time and memory grow with samples, channels and file size.

    cargo build --release
    pip install -r fixtures/reference/requirements.txt matplotlib
    python3 benches/growth.py                  # docs/growth.svg and a table, some minutes
    python3 benches/growth.py --large 4e9      # also two files of 4 GB with 64 channels, two of them analysed

The drop is that of `whole_process.py`; every figure is the median over whole processes, from start to exit.
"""

import argparse
import multiprocessing
import os
import statistics
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import whole_process as whole

FOLDER = whole.ROOT / "target/growth"


def recording(count):
    """Both channels of the drop, g, as whole_process.py writes them."""
    whole.make(whole.ROOT / "target/whole_process", count)
    import h5py

    with h5py.File(whole.ROOT / f"target/whole_process/{count}.raw.h5") as file:
        return {name: file[f"daq/{name}"][()] for name in ("a1", "a2")}


def write_hdf5(path, count, others, seed=5):
    """The two channels among `others` of noise, a dataset each, without compression."""
    import h5py
    import numpy as np

    data = recording(count)
    draw = np.random.default_rng(seed)
    with h5py.File(path, "w") as file:
        for name, samples in list(data.items()) + [(f"n{i}", None) for i in range(others)]:
            if samples is None:
                samples = draw.standard_normal(count, dtype="f4")
            dataset = file.create_dataset(f"daq/{name}", data=samples)
            dataset.attrs["sample_rate_hz"] = whole.RATE_HZ
            dataset.attrs["unit"] = "g"


def write_mcap(path, count, others, block=10_000, seed=5):
    """The same as protobuf blocks in chunks of 4 MiB with zstd, the channels in turn."""
    sys.path.insert(0, str(whole.ROOT / "fixtures/reference"))
    import formats
    import numpy as np

    data = recording(count)
    draw = np.random.default_rng(seed)
    noise = {f"/daq/n{i}": draw.standard_normal(count, dtype="f4") for i in range(others)}
    topics = {f"/daq/{name}": samples for name, samples in data.items()} | noise
    formats.write_mcap(path, "protobuf", topics, whole.RATE_HZ, block=block, chunk=1 << 22)


def apart(work, *arguments):
    """In a process of its own: a child's peak memory counts from what its parent holds when it is started."""
    process = multiprocessing.get_context("spawn").Process(target=work, args=arguments)
    process.start()
    process.join()
    if process.exitcode:
        sys.exit(f"{work.__name__} failed")


def median_run(program, path, kind, rounds):
    command = [program, "analyze", str(path), "--cask", str(whole.cask_file(FOLDER, kind)), "--json", os.devnull]
    runs = [whole.measure(command) for _ in range(rounds + 1)][1:]  # the first warms the page cache
    return [statistics.median(run[i] for run in runs) for i in (0, 1, 2)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--large", type=float, default=0.0, metavar="BYTES")
    parser.add_argument("--program", default=str(whole.ROOT / "target/release/dropcheck"))
    parser.add_argument("--chart", default=str(whole.ROOT / "docs/growth.svg"))
    arguments = parser.parse_args()
    FOLDER.mkdir(parents=True, exist_ok=True)
    by_samples = {kind: [] for kind in whole.KINDS}
    print("| what grows | size | input | wall ms | cpu ms | MiB |\n|---|---|---|---|---|---|")

    def row(what, size, kind, path):
        wall_s, cpu_s, mib = median_run(arguments.program, path, kind, arguments.rounds)
        print(f"| {what} | {size} | {kind} | {1e3 * wall_s:.0f} | {1e3 * cpu_s:.0f} | {mib:.0f} |", flush=True)
        return wall_s, mib

    for count in (10**5, 3 * 10**5, 10**6, 3 * 10**6, 10**7):
        apart(recording, count)
        for kind in whole.KINDS:
            path = whole.ROOT / f"target/whole_process/{count}.{whole.SUFFIX[kind]}"
            by_samples[kind].append((count, *row("samples a channel", f"{count:.0e}", kind, path)))
    by_channels = {"HDF5 raw f32": [], "MCAP protobuf, zstd": []}
    for channels in (2, 4, 8, 16, 32, 64):
        for kind, suffix, write in (("HDF5 raw f32", "h5", write_hdf5), ("MCAP protobuf, zstd", "mcap", write_mcap)):
            path = FOLDER / f"channels.{suffix}"
            apart(write, path, 10**6, channels - 2)
            by_channels[kind].append((channels, *row("channels in the file", channels, kind, path)))
            path.unlink()
    if arguments.large:
        count = int(arguments.large / 64 / 4)
        for kind, suffix, write in (("HDF5 raw f32", "h5", write_hdf5), ("MCAP protobuf, zstd", "mcap", write_mcap)):
            path = FOLDER / f"large.{suffix}"
            if not path.exists():
                apart(write, path, count, 62)
            row("64 channels", f"{path.stat().st_size / 1e9:.1f} GB", kind, path)
    draw(arguments.chart, by_samples, by_channels)


def draw(path, by_samples, by_channels):
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "dropcheck"
    import matplotlib.pyplot as plt
    from matplotlib.ticker import NullFormatter, ScalarFormatter

    figure, axes = plt.subplots(2, 2, figsize=(9, 7), constrained_layout=True, sharex="col", sharey="row")
    colour = {kind: f"C{i}" for i, kind in enumerate(whole.KINDS)}
    for column, (label, table) in enumerate(
        (("samples a channel, two channels", by_samples), ("channels in the file, two of them analysed, 1e6 samples", by_channels))
    ):
        for kind, points in table.items():
            size, wall_s, mib = zip(*points)
            axes[0, column].loglog(size, [1e3 * s for s in wall_s], "o-", color=colour[kind], label=kind)
            axes[1, column].loglog(size, mib, "o-", color=colour[kind], label=kind)
        axes[1, column].set_xlabel(label)
        if column:
            axes[1, column].set_xticks(size)
            axes[1, column].xaxis.set_major_formatter(ScalarFormatter())
            axes[1, column].xaxis.set_minor_formatter(NullFormatter())
        for row, ticks in enumerate(([30, 50, 100, 200, 300, 500, 1000], [20, 30, 50, 100, 200, 300])):
            axes[row, column].grid(True, which="both", alpha=0.3)
            axes[row, column].set_yticks(ticks)
            axes[row, column].yaxis.set_major_formatter(ScalarFormatter())
            axes[row, column].yaxis.set_minor_formatter(NullFormatter())
    axes[0, 0].set_ylabel("whole process, ms")
    axes[1, 0].set_ylabel("peak memory, MiB")
    for column in (0, 1):
        axes[0, column].legend(fontsize=8)
    figure.suptitle("dropcheck analyze: time and memory against the size of the recording")
    figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    main()
