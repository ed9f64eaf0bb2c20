"""Run the recipes of docs/recipes, each where its tool is, and hold what they write against one local run, byte by byte.

    python3 tests/scale/engines.py DROPCHECK RUNS.csv

Prints a line each: how long, and what each recording costs more than in the local run.
"""

import csv
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RECIPES, HERE = ROOT / "docs/recipes", Path(__file__).resolve().parent
PARTS = 4


def has(*tools):
    return all(shutil.which(tool) for tool in tools)


def run(words, env):
    found = subprocess.run([str(word) for word in words], env=env, capture_output=True, text=True)
    if found.returncode not in (0, 1, 2):
        sys.exit(f"{words[0]} ended with {found.returncode}:\n{found.stdout}{found.stderr}")


def campaign(folder):
    return {path.name: path.read_bytes() for path in folder.glob("campaign*")}


def main(program, manifest):
    work = Path(tempfile.mkdtemp())
    (work / "bin").mkdir()
    (work / "bin/dropcheck").symlink_to(program.resolve())
    env = os.environ | {"PATH": f"{work / 'bin'}:{os.environ['PATH']}", "SOURCE_DATE_EPOCH": "0"}
    count = len(list(csv.DictReader(manifest.open())))
    batch = ["dropcheck", "batch", "--manifest", manifest, "--out"]
    start = time.time()
    run([*batch, work / "local"], env)
    local, local_s = campaign(work / "local"), time.time() - start
    print(f"local: {count} recordings in {local_s:.2f} s")
    out = {name: work / name for name in ["slurm", "parallel"]}
    merge = f"dropcheck merge {out['slurm']}/results-*-of-{PARTS}.jsonl --out {out['slurm']}"
    slurm = f"sbatch --array=0-{PARTS - 1} --wait --output=/dev/null {RECIPES}/slurm.sh {manifest} {out['slurm']}; {merge}"
    engines = {
        "slurm": (has("sbatch", "slurmctld", "slurmd") and os.geteuid() == 0, [HERE / "slurm_here.sh", "sh", "-c", slurm]),
        "parallel": (has("parallel"), ["sh", RECIPES / "parallel.sh", manifest, out["parallel"]]),
    }
    for name, (is_here, words) in engines.items():
        if not is_here:
            print(f"{name}: left out, it is not installed")
            continue
        start = time.time()
        run(words, env)
        lasts_s = time.time() - start
        found = campaign(out[name])
        if found != local:
            differ = [n for n in local if found.get(n) != local[n]]
            sys.exit(f"{name}: FAILED, other than the local run: {differ}, in {work}")
        print(f"{name}: equal in {len(found)} files, {lasts_s:.2f} s, {1e3 * (lasts_s - local_s) / count:+.0f} ms a recording")
    shutil.rmtree(work)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]).resolve())
