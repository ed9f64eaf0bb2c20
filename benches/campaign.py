"""Recordings a second of `dropcheck batch`, by jobs, with and without reports; its memory by their number.

    python3 benches/campaign.py [RECORDINGS [ROUNDS]]        after cargo build --release

Copies of one drop, two channels of 1e5 samples each (MCAP, protobuf), in the page cache. The runs stand in turn,
eighty recordings and five rounds unless told; a line a case with its fastest round.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = ROOT / "target/release/dropcheck"


def made(folder, count):
    scene = (ROOT / "fixtures/examples/scene-anf18.toml").read_text().replace("sample_rate_hz = 25000", "sample_rate_hz = 500000")
    (folder / "drop.scene.toml").write_text(scene)
    first = folder / "drop.mcap"
    subprocess.run([PROGRAM, "synth", folder / "drop.scene.toml", "--encoding", "protobuf", "--out", first],
                   check=True, stdout=subprocess.DEVNULL)
    rows = ["id,recording,cask"]
    for i in range(count):
        shutil.copy(first, folder / f"{i}.mcap")
        rows.append(f"{i},{i}.mcap,drop.toml")
    (folder / "runs.csv").write_text("\n".join(rows) + "\n")


def timed(words):
    start = time.time()
    process = subprocess.Popen([str(w) for w in words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = status
    assert os.waitstatus_to_exitcode(status) in (0, 1), status
    return time.time() - start, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def main(count, rounds):
    folder = Path(tempfile.mkdtemp())
    made(folder, count)
    small = folder / "small.csv"
    small.write_text("\n".join((folder / "runs.csv").read_text().splitlines()[: 1 + count // 4]) + "\n")
    cases = {}
    for jobs in (1, 2):
        cases[f"{jobs} jobs, no reports"] = (folder / "runs.csv", count, jobs, ["--jsonl", folder / "lines.jsonl"])
        cases[f"{jobs} jobs, reports"] = (folder / "runs.csv", count, jobs, ["--out", folder / "out"])
    cases["2 jobs, no reports, a quarter"] = (small, count // 4, 2, ["--jsonl", folder / "lines.jsonl"])
    best = {}
    for _ in range(rounds):
        for name, (manifest, n, jobs, words) in cases.items():
            shutil.rmtree(folder / "out", ignore_errors=True)
            found = timed([PROGRAM, "batch", "--manifest", manifest, "--jobs", jobs, *words])
            best[name] = min(best.get(name, found), found)
    for name, (_, n, jobs, _) in cases.items():
        wall, cpu, mib = best[name]
        print(f"{name}: {n / wall:.1f} recordings/s, {n / wall / jobs:.1f} a core, {1e3 * cpu / n:.1f} ms of processor time each, {mib:.0f} MiB")
    for kind in ("no reports", "reports"):
        one, two = best[f"1 jobs, {kind}"][0], best[f"2 jobs, {kind}"][0]
        print(f"efficiency from one to two jobs, {kind}: {one / two / 2:.2f}")
    shutil.rmtree(folder)


if __name__ == "__main__":
    main(*([int(word) for word in sys.argv[1:]] + [80, 5][len(sys.argv) - 1 :]))
