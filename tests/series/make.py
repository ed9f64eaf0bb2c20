"""Make a test series of simulated drops: three casks, six angles, three repeats, its manifest, and what is wrong with it.

    python3 tests/series/make.py dropcheck FOLDER

FOLDER then holds the recordings (MCAP, HDF5, CSV) with a truth each, a cask file a cask, runs.csv, and truth.json: the
k that each cask's drops are drawn about, their scatter, and the names of the drop that is otherwise and of the broken
recordings.
"""

import csv
import json
import random
import subprocess
import sys
from datetime import date, timedelta
from pathlib import Path

CASKS = {
    "ANF-18": dict(mass_kg=4466.0, length_m=5.512, height_m=0.792, k=0.50, mode_hz=62.0),
    "ANF-10": dict(mass_kg=1429.0, length_m=4.725, height_m=0.565, k=0.40, mode_hz=75.0),
    "VHLW": dict(mass_kg=20950.0, length_m=4.486, height_m=1.156, k=0.30, mode_hz=110.0),
}
ANGLES = [5, 10, 15, 20, 25, 30]
REPEATS = 3
ENDINGS = ["mcap", "h5", "csv"]
SCATTER = 0.01
# This drop's first end gives back far more than its repeats do.
OUTLIER, OUTLIER_K = "ANF-18-15-2", 0.70
EXTRA = 6  # further repeats of the first cask, which make it sixty

CHANNEL = """
[[channel]]
name = "{name}"
end = "{end}"
axis = "transverse"
position_m = {at}
sample_rate_hz = 25000
full_scale = 4000.0
bits = 16
anti_alias_hz = 8000.0
offset_g = 0.1
white_noise_g = 0.1
"""


def scene(name, cask, angle, k, seed):
    channels = "".join(
        CHANNEL.format(name=n, end=end, at=at)
        for n, end, at in [("A1", "first", 0.15), ("A2", "second", cask["length_m"] - 0.15)]
    )
    return f"""name = "{name}"
seed = {seed}
[cask]
name = "{name.rsplit('-', 2)[0]}"
mass_kg = {cask['mass_kg']}
length_m = {cask['length_m']}
height_m = {cask['height_m']}
[drop]
height_m = 9.0
angle_deg = {angle}
[contact]
friction = "rough"
[first_end]
pulse_ms = 5.0
k = {k}
[second_end]
pulse_ms = 4.0
k = 0.3
[[mode]]
order = 1
frequency_hz = {cask['mode_hz']}
damping = 0.03
[recording]
before_s = 0.1
after_s = 0.04
{channels}"""


def main(program, folder):
    folder.mkdir(parents=True, exist_ok=True)
    draw = random.Random(24)
    tests = [(c, a, r) for r in range(1, REPEATS + 1) for a in ANGLES for c in CASKS]
    tests += [("ANF-18", a, REPEATS + 1) for a in ANGLES][:EXTRA]
    rows = []
    for i, (name, angle, repeat) in enumerate(tests):
        cask, test = CASKS[name], f"{name}-{angle}-{repeat}"
        k = OUTLIER_K if test == OUTLIER else round(draw.gauss(cask["k"], SCATTER), 4)
        source = folder / f"{test}.scene.toml"
        source.write_text(scene(test, cask, angle, k, i + 1))
        recording = folder / f"{test}.{ENDINGS[i % 3]}"
        subprocess.run([program, "synth", source, "--out", recording], check=True, stdout=subprocess.DEVNULL)
        source.unlink()
        made, own = recording.with_suffix(".toml"), folder / f"{name.lower()}.toml"
        # Sources differ by format: a cask file of each format for each cask.
        own = own.with_name(f"{name.lower()}-{recording.suffix[1:]}.toml")
        if not own.exists():
            own.write_text(made.read_text())
        made.unlink()
        day = date(2026, 3, 2) + timedelta(days=i // 3)
        rows.append([test, recording.name, own.name, angle, day, f"hall {1 + i % 2}"])
    broken = ["ANF-10-20-3", "VHLW-30-3", "ANF-18-5-4"]
    for test, content in zip(broken, [b"", b"no recording", None]):
        path = folder / next(row[1] for row in rows if row[0] == test)
        path.write_bytes(path.read_bytes()[:2000] if content is None else content)
    with (folder / "runs.csv").open("w", newline="") as out:
        csv.writer(out).writerows([["id", "recording", "cask", "drop.angle_deg", "test.date", "hall"], *rows])
    truth = {"k": {n: c["k"] for n, c in CASKS.items()}, "scatter": SCATTER, "outlier": OUTLIER, "broken": broken}
    (folder / "truth.json").write_text(json.dumps(truth, indent=1))
    print(f"{len(rows)} recordings in {folder}")


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
