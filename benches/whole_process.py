"""From recordings of 1e5 to 1e7 samples a channel to a table of time and memory: dropcheck beside a numpy script.

    cargo build --release
    pip install -r fixtures/reference/requirements.txt pandas mcap-protobuf-support
    python3 benches/whole_process.py                     # all sizes, five rounds, files kept in target/whole_process
    python3 benches/whole_process.py --sizes 1e6 --rounds 9 --out

Every figure is the median over whole processes, from start to exit; both programs run in turn on the same file.
`python3 benches/whole_process.py --peer FILE` is the script that dropcheck is held against: read both channels, low-pass
them forward and back (CFC 180), integrate, take extrema and where the force rises.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RATE_HZ = 500_000.0
KINDS = ["HDF5 raw f32", "HDF5 gzip", "CSV", "MCAP JSON, zstd", "MCAP protobuf, zstd"]
SUFFIX = dict(zip(KINDS, ["raw.h5", "gzip.h5", "csv", "json.mcap", "protobuf.mcap"]))


def peer(path):
    """What one would write in a notebook; prints how long it took without the imports."""
    import numpy as np
    from scipy.integrate import cumulative_trapezoid
    from scipy.signal import butter, sosfiltfilt

    if path.endswith(".h5"):
        import h5py
    elif path.endswith(".csv"):
        import pandas
    else:
        from mcap.reader import make_reader
        if "protobuf" in path:
            from mcap_protobuf.decoder import DecoderFactory
    begun = time.perf_counter()
    rate_hz = RATE_HZ
    if path.endswith(".h5"):
        with h5py.File(path) as file:
            samples = [file[f"daq/{name}"][()].astype(float) for name in ("a1", "a2")]
            rate_hz = file["daq/a1"].attrs["sample_rate_hz"]
    elif path.endswith(".csv"):
        table = pandas.read_csv(path)
        samples = [table[name].to_numpy() for name in ("a1", "a2")]
        rate_hz = (len(table) - 1) / (table["time_s"].iloc[-1] - table["time_s"].iloc[0])
    else:
        blocks = {"/daq/a1": [], "/daq/a2": []}
        with open(path, "rb") as file:
            if "protobuf" in path:
                reader = make_reader(file, decoder_factories=[DecoderFactory()])
                for _, channel, _, block in reader.iter_decoded_messages():
                    blocks[channel.topic].append(np.array(block.samples))
            else:
                for _, channel, message in make_reader(file).iter_messages():
                    blocks[channel.topic].append(np.array(json.loads(message.data)["samples"]))
        samples = [np.concatenate(parts) for parts in blocks.values()]
    sections = butter(2, 2.0775 * 180.0, fs=rate_hz, output="sos")
    for g in samples:
        force = sosfiltfilt(sections, g) * 9.80665
        velocity = cumulative_trapezoid(force, dx=1 / rate_hz, initial=0.0)
        rises = np.flatnonzero(np.abs(force) > 200.0)
        at_s = rises[0] / rate_hz if len(rises) else None
        print(at_s, force.min(), force.max(), velocity.min(), velocity.max())
    print(json.dumps({"work_s": time.perf_counter() - begun}))


def make(folder, count):
    """One drop of the fixtures' ANF-18 in the middle of `count` samples, in every format; kept for the next run."""
    sys.path.insert(0, str(ROOT / "fixtures/reference"))
    import formats
    import numpy as np
    from generate import ANF18, scene
    from simulate import G0, sensor, simulate

    if all((folder / f"{count}.{suffix}").exists() for suffix in SUFFIX.values()):
        return
    motion = simulate(scene(ANF18, 15.0, 0.55, 5e-3, 62.0))
    times = np.arange(count) / RATE_HZ - count / RATE_HZ / 2.2
    during = (times > -0.01) & (times < motion.t[-1] - 1e-4)
    data = {}
    for seed, (name, position_m) in enumerate((("a1", 0.15), ("a2", ANF18["length_m"] - 0.15))):
        force = np.zeros(count)
        force[during] = sensor(motion, times[during], position_m)
        data[name] = (force / G0 + np.random.default_rng(seed).normal(0, 0.2, count)).astype("f4")
    formats.write_hdf5(folder / f"{count}.raw.h5", data, RATE_HZ, compression=None)
    formats.write_hdf5(folder / f"{count}.gzip.h5", data, RATE_HZ)
    with open(folder / f"{count}.csv", "w") as file:
        file.write("time_s,a1,a2\n")
        rows = zip(data["a1"].tolist(), data["a2"].tolist())
        file.writelines(f"{i / RATE_HZ:.6f},{a:.3f},{b:.3f}\n" for i, (a, b) in enumerate(rows))
    topics = {f"/daq/{name}": samples for name, samples in data.items()}
    for encoding in ("json", "protobuf"):
        formats.write_mcap(folder / f"{count}.{encoding}.mcap", encoding, topics, RATE_HZ, block=1000, chunk=1 << 20)


def cask_file(folder, kind):
    form = {"C": "{}", "H": "/daq/{}", "M": "/daq/{}.samples"}[kind[0]]
    text = '[cask]\nname = "ANF-18"\nmass_kg = 4466.0\nlength_m = 5.512\nheight_m = 0.792\n'
    text += "[drop]\nheight_m = 9.0\nangle_deg = 15.0\n[filter]\ncfc = 180\n"
    for name, end, position_m in (("a1", "first", 0.15), ("a2", "second", 5.362)):
        text += f'[[channel]]\nname = "{name.upper()}"\nend = "{end}"\naxis = "transverse"\n'
        text += f'source = "{form.format(name)}"\nunit = "g"\nposition_m = {position_m}\n'
    path = folder / f"{kind[0].lower()}.toml"
    path.write_text(text)
    return path


def measure(command):
    """Wall seconds, processor seconds, peak MiB and output of one process."""
    with tempfile.TemporaryFile() as output:
        begun = time.perf_counter()
        process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(process.pid, 0)
        wall_s = time.perf_counter() - begun
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        text = output.read().decode()
    if process.returncode not in (0, 1):
        sys.exit(f"{command} ended with {process.returncode}:\n{text}")
    return wall_s, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, text


def compare(program, path, cask, rounds, report):
    """Medians over `rounds` runs in turn: wall s, processor s, MiB of ours and of the script, and its wall s without imports."""
    with tempfile.TemporaryDirectory() as out:
        ours = [program, "analyze", str(path), "--cask", str(cask), "--json", os.devnull]
        ours += ["--out", f"{out}/report"] if report else []
        theirs = [sys.executable, __file__, "--peer", str(path)]
        runs = [(measure(ours), measure(theirs)) for _ in range(rounds + 1)][1:]  # the first warms the page cache
    middle = lambda pick: statistics.median(map(pick, runs))
    work_s = middle(lambda r: json.loads(r[1][3].splitlines()[-1])["work_s"])
    return [middle(lambda r, a=a, b=b: r[a][b]) for a in (0, 1) for b in (0, 1, 2)] + [work_s]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peer", metavar="FILE", help="be the numpy script on FILE")
    parser.add_argument("--make", metavar="COUNT", type=int, help=argparse.SUPPRESS)
    parser.add_argument("--sizes", nargs="+", type=lambda text: int(float(text)), default=[10**5, 10**6, 10**7])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", action="store_true", help="with the whole report, pictures and curves included")
    parser.add_argument("--program", default=str(ROOT / "target/release/dropcheck"))
    arguments = parser.parse_args()
    if arguments.peer:
        return peer(arguments.peer)
    folder = ROOT / "target/whole_process"
    folder.mkdir(parents=True, exist_ok=True)
    if arguments.make:
        return make(folder, arguments.make)
    print("| samples a channel | input | dropcheck ms | cpu ms | MiB | script ms | cpu ms | MiB | ratio | without imports | memory |")
    print("|---" * 11 + "|")
    for count in arguments.sizes:
        # In a process of its own: a child's peak counts from what its parent holds when it is started.
        subprocess.run([sys.executable, __file__, "--make", str(count)], check=True)
        for kind in KINDS:
            path = folder / f"{count}.{SUFFIX[kind]}"
            row = compare(arguments.program, path, cask_file(folder, kind), arguments.rounds, arguments.out)
            s, cpu_s, mib, script_s, script_cpu_s, script_mib, work_s = row
            print(
                f"| 1e{len(str(count)) - 1} | {kind} | {1e3 * s:.0f} | {1e3 * cpu_s:.0f} | {mib:.0f} "
                f"| {1e3 * script_s:.0f} | {1e3 * script_cpu_s:.0f} | {script_mib:.0f} "
                f"| {script_s / s:.0f} | {work_s / s:.1f} | {mib / script_mib:.2f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
