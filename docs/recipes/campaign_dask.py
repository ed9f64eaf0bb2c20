"""python3 campaign_dask.py runs.csv campaign 4 [SCHEDULER]: in four parts, on the workers of a scheduler or on two here"""
import glob, subprocess, sys
from dask.distributed import Client

def part(manifest, out, i, parts):
    words = ["--manifest", manifest, "--out", out, "--shard", f"{i}/{parts}", "--jobs", "1", "--resume"]
    return subprocess.run(["dropcheck", "batch", *words], stdout=subprocess.DEVNULL).returncode

if __name__ == "__main__":
    manifest, out, parts = sys.argv[1], sys.argv[2], int(sys.argv[3])
    with Client(*sys.argv[4:5], **({} if sys.argv[4:5] else {"n_workers": 2, "threads_per_worker": 1})) as client:
        client.gather([client.submit(part, manifest, out, i, parts, pure=False) for i in range(parts)])
    sys.exit(subprocess.run(["dropcheck", "merge", *glob.glob(f"{out}/results-*-of-{parts}.jsonl"), "--out", out]).returncode)
