"""Run the program for Windows under wine, and hold what it says against this machine's.

    python3 tests/windows/under_wine.py DROPCHECK.exe DROPCHECK

Every example: exit status, verdict, findings and words equal, numbers within SAME of their magnitude. Then what a
report, a campaign and a run that was killed leave in a folder. Where wine is not installed it says so and ends with 0.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parents[2] / "fixtures/examples"
# Another libm differs in the last digits, and differences of numbers make more of them.
SAME = 1e-4
ZLIB = Path("/usr/x86_64-w64-mingw32/lib/zlib1.dll")
# Rust's standard library asks Windows for random bytes by it; wine 8 has no such function.
STUB = "int SystemFunction036(void *, unsigned); int ProcessPrng(void *to, unsigned long long n) { return SystemFunction036(to, n); }"
KILLS = 16


def wine():
    places = [shutil.which(name) for name in ("wine64", "wine")]
    return next((place for place in [*places, "/usr/lib/wine/wine64"] if place and Path(place).exists()), None)


def laid_out(program, folder):
    """The program in `folder`, with what wine lacks beside it; the words that start it."""
    shutil.copy(program, folder / "dropcheck.exe")
    if ZLIB.exists():
        shutil.copy(ZLIB, folder)
    (folder / "stub.c").write_text(STUB)
    compiler = ["x86_64-w64-mingw32-gcc", "-shared", "-o", folder / "bcryptprimitives.dll", folder / "stub.c", "-ladvapi32"]
    subprocess.run(compiler, check=True)
    os.environ |= {"WINEPREFIX": str(folder / "prefix"), "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "bcryptprimitives=n;mscoree,mshtml="}
    return [wine(), folder / "dropcheck.exe"]


def ran(words, **more):
    return subprocess.run([str(word) for word in words], capture_output=True, **more)


def differences(place, a, b, magnitude, found):
    """The places where two results differ otherwise than in a number, and the largest share by which a number does."""
    if isinstance(a, dict) and isinstance(b, dict) and a.keys() == b.keys():
        magnitude = max([abs(x) for x in a.values() if isinstance(x, int | float)], default=0) if "u95" in a else 0
        return max([differences(f"{place}.{key}", a[key], b[key], magnitude, found) for key in a], default=0)
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        magnitude = max([abs(x) for x in a if isinstance(x, int | float)], default=0)
        return max([differences(f"{place}[{i}]", *pair, magnitude, found) for i, pair in enumerate(zip(a, b))], default=0)
    if a == b:
        return 0
    try:
        # A coefficient of friction is a word where it has one, else its digits.
        a, b = float(a), float(b)
        return abs(a - b) / max(magnitude, abs(a), abs(b))
    except (TypeError, ValueError):
        found.append(f"{place}: {a} here, {b} on Windows"[:200])
        return 0


def same_result(native, windows, recording, folder):
    """Whether both say the same of a recording; prints what they say."""
    words = ["analyze", recording, "--cask", recording.with_suffix(".toml"), "--json", "-"]
    here, there = ran([*native, *words]), ran([*windows, *words])
    if here.returncode != there.returncode or not there.stdout:
        print(f"{recording.name}: exit {here.returncode} here, {there.returncode} on Windows: {there.stderr.decode()}")
        return False
    results = [json.loads(answer.stdout) for answer in (here, there)]
    for result in results:
        # The words name this result alone, the program its machine.
        del result["program"], result["command"]
    found = []
    share = differences("", *results, 0, found)
    codes = ",".join(finding["code"] for finding in results[1]["quality"])
    print(f"{recording.name}: exit {there.returncode}, {results[1]['verdict']} ({codes}), numbers within {share:.1e}")
    print("".join(f"  {line}\n" for line in found), end="")
    return not found and share <= SAME


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()} if folder.exists() else {}


def whole_reports(native, windows, folder):
    """Whether a report is whole, replaces an older one, and of a killed run leaves the old or the new files."""
    recording, other = EXAMPLES / "vhlw-rest.h5", EXAMPLES / "anf10-plain.csv"
    words = lambda of, out: ["analyze", of, "--cask", of.with_suffix(".toml"), "--out", out, "--force"]
    out, here = folder / "ä report", folder / "here"
    ran([*native, *words(recording, here)])
    states = {}
    for of in (other, recording):
        if ran([*windows, *words(of, out)]).returncode != 0:
            return "no report"
        states[of] = contents(out)
    if states[recording].keys() != contents(here).keys():
        return f"files {sorted(states[recording])}"
    took = time.monotonic()
    ran([*windows, *words(recording, out)])
    took = time.monotonic() - took
    kinds = {"old": 0, "new": 0, "mixed": 0}
    for i in range(KILLS):
        ran([*windows, *words(other, out)])
        process = subprocess.Popen([str(word) for word in [*windows, *words(recording, out)]], stdout=subprocess.DEVNULL)
        time.sleep(took * (0.6 + 0.4 * i / KILLS))
        process.kill()
        process.wait()
        left = {name: text for name, text in contents(out).items() if not name.startswith(".")} if out.exists() else {}
        kind = next((kind for kind, of in (("old", other), ("new", recording)) if left == states[of]), "mixed")
        kinds[kind] += 1
    ran([*windows, *words(recording, out)])
    print(f"killed runs left {kinds}, the next one a whole report: {contents(out) == states[recording]}")
    return "" if contents(out) == states[recording] else "the next run did not make it good"


def campaign(native, windows, folder):
    """Whether a campaign says the same, and goes on where it was stopped."""
    shutil.copytree(EXAMPLES, folder / "runs")
    words = lambda out: ["batch", folder / "runs", "--out", folder / out]
    for run, out in ((native, "c-here"), (windows, "c-there"), ([*windows], "c-there")):
        resumed = ["--resume"] if (folder / out).exists() else []
        print(f"batch {' '.join(resumed)}: exit", (ended := ran([*run, *words(out), *resumed])).returncode)
        if not (folder / out / "campaign.html").exists():
            return ended.stderr.decode()
    pages = [json.loads((folder / out / "campaign.json").read_text()) for out in ("c-here", "c-there")]
    verdicts = [[(row["id"], row["verdict"], row["codes"]) for row in page["recordings"]] for page in pages]
    return "" if verdicts[0] and verdicts[0] == verdicts[1] else f"verdicts {verdicts}"


def main(program, native):
    if not wine():
        return print("Skipped: the program for Windows runs where wine is installed (Debian: wine64, libz-mingw-w64).")
    os.environ["SOURCE_DATE_EPOCH"] = "0"
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        folder, native = Path(folder), [native.resolve()]
        windows = laid_out(program, folder)
        recordings = sorted(path for path in EXAMPLES.iterdir() if path.suffix in (".mcap", ".h5", ".csv"))
        failed = [r.name for r in recordings if not same_result(native, windows, r, folder)]
        failed += filter(None, [step(native, windows, folder) for step in (campaign, whole_reports)])
        sys.exit(f"differs: {failed}" if failed or not recordings else 0)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
