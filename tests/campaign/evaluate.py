"""From folders of recordings with their truth to tables of how far dropcheck is off, how often it says so, and where not.

python3 tests/campaign/evaluate.py path/to/dropcheck FOLDER [FOLDER ...] [--markdown FILE] [--csv FILE]
"""

import argparse
import csv
import json
import subprocess
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

TIMEOUT_S = 60
WRONG = 1.5  # errors above this many half-widths: the interval misses by more than half of one
QUANTITIES = {  # name: (path in result.json, key of the truth)
    "speed": (("slap_down", "speed"), "speed"),
    "k": (("k",), "k"),
    "vertical": (("slap_down", "vertical_velocity"), "vz"),
    "horizontal": (("slap_down", "horizontal_velocity"), "vx"),
    "angular": (("first_impact", "angular_velocity"), "omega_rebound"),
    "flight": (("slap_down", "flight_time"), "flight_s"),
    "hit": (("slap_down", "angle"), "angle_hit_deg"),
}
SHORT_FLIGHT_S = 0.030


def run(binary, cask_path, recording_path):
    """Exit status, result (empty where there is none) and what was said of an error."""
    command = [binary, "analyze", recording_path, "--cask", cask_path, "--json", "-"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
    except subprocess.TimeoutExpired:
        return None, {}, f"longer than {TIMEOUT_S} s"
    try:
        return done.returncode, json.loads(done.stdout), ""
    except json.JSONDecodeError:
        return done.returncode, {}, done.stderr.strip().replace("\n", " ")[-300:]


def measured(result, path):
    """Value and half-width at `path`, None where the result has none."""
    for key in path:
        result = result.get(key) if isinstance(result, dict) else None
    return (result["value"], result["u95"]) if isinstance(result, dict) else (None, None)


def compare(result, truth):
    """For each quantity: value, half-width, truth, error, and the error in half-widths."""
    row = {}
    for name, (path, key) in QUANTITIES.items():
        value, half_width = measured(result, path)
        true = truth.get(key)
        known = value is not None and half_width is not None and true is not None
        error = value - true if known else None
        row |= {name: value, name + "_u95": half_width, name + "_true": true, name + "_error": error}
        row[name + "_misses"] = abs(error) / max(half_width, 1e-12) if known else None
    row["speed_percent"] = None if row["speed_error"] is None else 100 * abs(row["speed_error"]) / truth["speed"]
    return row


def evaluate(binary, truth_path):
    """One recording as a row of the table."""
    truth = json.loads(truth_path.read_text())
    stem = truth_path.name.removesuffix(".truth.json")
    status, result, error = run(binary, truth_path.with_name(stem + ".toml"), truth_path.with_name(truth["recording"]))
    weighty = {issue["severity"] + ":" + issue["code"] for issue in result.get("quality", []) if issue["severity"] != "note"}
    row = {"scene": f"{truth_path.parent.name}/{stem}", "damage": truth["damage"] or "none", "status": status, "error": error}
    row |= {"verdict": result.get("verdict"), "findings": " ".join(sorted(weighty)), "note": json.dumps(truth["note"])}
    row |= {"angle_deg": truth["angle_deg"], "drop_height_m": truth["drop_height_m"], "contact_s": truth["contact_s"]}
    row |= {"relands": truth["relands"], "plateau": truth["plateau"], "friction": truth["friction"], "rest": truth["rest"]}
    row |= {"sample_rate_hz": truth["sample_rate_hz"], "noise_g": truth["noise_g"], "modes": json.dumps(truth["modes"])}
    row |= compare(result, truth)
    misses = [row[name] for name in ("speed_misses", "k_misses") if row[name] is not None]
    row["wrong_pass"] = row["verdict"] == "pass" and bool(misses) and max(misses) > WRONG
    return row


def present(rows, key):
    return [row[key] for row in rows if row[key] is not None]


def percentile(values, percent, digits=2):
    """Text of a percentile, a dash for nothing."""
    return f"{np.percentile(values, percent):.{digits}f}" if values else "–"


def share_inside(rows, name):
    """Text of the share of intervals that hold the truth, and how many there are."""
    misses = present(rows, name + "_misses")
    return f"{100 * sum(value <= 1 for value in misses) / len(misses):.1f} % of {len(misses)}" if misses else "–"


def verdicts(rows):
    """Numbers of pass, review, fail, and of recordings without a result."""
    found = Counter(row["verdict"] for row in rows)
    return [found["pass"], found["review"], found["fail"], found[None]]


def table(head, lines):
    """A Markdown table."""
    rows = [head, ["---"] * len(head), *lines]
    return "\n".join("| " + " | ".join(str(cell) for cell in row) + " |" for row in rows)


def undamaged_table(rows):
    """One column for those that pass, one for all that have numbers."""
    passed = [row for row in rows if row["verdict"] == "pass"]
    lines = [["recordings", len(passed), len(rows)], ["with a speed", *(len(present(part, "speed")) for part in (passed, rows))]]
    for title, percent in (("median", 50), ("95th percentile", 95), ("largest", 100)):
        errors = [percentile(present(part, "speed_percent"), percent) + " %" for part in (passed, rows)]
        lines.append([f"error of speed, {title}", *errors])
    for title, percent in (("median", 50), ("95th percentile", 95), ("largest", 100)):
        errors = [percentile([abs(error) for error in present(part, "k_error")], percent, 4) for part in (passed, rows)]
        lines.append([f"error of k, {title}", *errors])
    titles = {"speed": "speed", "k": "k", "vertical": "vertical velocity", "horizontal": "horizontal velocity"}
    titles |= {"angular": "angular velocity", "flight": "flight time", "hit": "angle at slap-down"}
    for name, title in titles.items():
        lines.append([f"intervals that hold the truth, {title}", share_inside(passed, name), share_inside(rows, name)])
    for name in ("speed", "k"):
        widths = [[100 * row["speed_u95"] / row["speed"] if name == "speed" else row["k_u95"] for row in part if row[name]] for part in (passed, rows)]
        unit = " %" if name == "speed" else ""
        lines.append([f"half-width of {name}, median", *(percentile(part, 50, 2 if unit else 4) + unit for part in widths)])
    lines.append([f"error of speed or k above {WRONG} half-widths", sum(row["wrong_pass"] for row in passed), "–"])
    return table(["undamaged", "passed", "all"], lines)


def damage_table(rows):
    """One line a kind, in the order of the recordings, and their sum."""
    kinds = list(dict.fromkeys(row["damage"] for row in rows))
    groups = [(kind, [row for row in rows if row["damage"] == kind]) for kind in kinds] + [("all", rows)]
    lines = []
    for kind, group in groups:
        wrong = sum(row["wrong_pass"] for row in group)
        lines.append([kind, len(group), *verdicts(group), percentile(present(group, "speed_percent"), 50), share_inside(group, "speed"), wrong])
    head = ["damage", "recordings", "pass", "review", "fail", "no result", "median error of stated speed, %", "speed intervals that hold", "wrong passes"]
    return table(head, lines)


def cause(row):
    """What an undamaged scene that does not pass has that others lack; the first that fits."""
    if row["relands"]:
        return "the first end touches again before the slap-down"
    if "clipped" in row["findings"]:
        return "a force plateau is taken for clipping"
    if row["flight_true"] < SHORT_FLIGHT_S:
        return f"the flight is shorter than {1000 * SHORT_FLIGHT_S:.0f} ms"
    if row["flight_true"] < 4 * row["contact_s"]:
        return "the flight is shorter than four contacts"
    return "none of these"


def causes_table(rows):
    """Undamaged scenes by cause: how many, how many of them pass, verdicts of the others."""
    groups = {}
    for row in rows:
        groups.setdefault(cause(row), []).append(row)
    lines = [[name, len(group), *verdicts(group)] for name, group in sorted(groups.items(), key=lambda item: -len(item[1]))]
    return table(["undamaged scenes in which", "scenes", "pass", "review", "fail", "no result"], lines)


def described(row):
    """One scene in a line."""
    numbers = [
        f"{name} {row[name]:.3f} ± {row[name + '_u95']:.3f} (true {row[name + '_true']:.3f})" if row[name] is not None
        else f"{name} – (true {row[name + '_true']:.3f})" for name in ("speed", "k")
    ]
    scene = f"{row['angle_deg']}°, {row['drop_height_m']} m, contact {1000 * row['contact_s']:.1f} ms, flight {1000 * row['flight_true']:.0f} ms"
    extras = f"plateau {row['plateau']}, friction {row['friction']}, touches again {row['relands']}"
    return f"{row['scene']} {row['damage']} {row['verdict']}: {', '.join(numbers)}; {scene}; {extras}; {row['findings']} {row['note']} {row['error']}"


def report(rows):
    """The tables as Markdown."""
    undamaged = [row for row in rows if row["damage"] == "none"]
    damaged = [row for row in rows if row["damage"] != "none"]
    parts = []
    if undamaged:
        parts += [undamaged_table(undamaged), causes_table(undamaged)]
        parts += ["Undamaged that do not pass:", *("- " + described(row) for row in undamaged if row["verdict"] != "pass")]
    if damaged:
        parts += [damage_table(damaged)]
    parts += ["Wrong passes:", *("- " + described(row) for row in rows if row["wrong_pass"])]
    return "\n\n".join(parts).replace("\n\n- ", "\n- ") + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary", help="path to dropcheck")
    parser.add_argument("folders", nargs="+", type=Path, help="made by make.py; several are put together")
    parser.add_argument("--markdown", type=Path, help="the tables into this file, too")
    parser.add_argument("--csv", type=Path, help="one line a recording")
    parser.add_argument("--processes", type=int, default=2)
    words = parser.parse_args()
    truths = [path for folder in words.folders for path in sorted(folder.glob("*.truth.json"))]
    if not truths:
        sys.exit("no *.truth.json in " + ", ".join(str(folder) for folder in words.folders))
    with ThreadPoolExecutor(words.processes) as pool:
        rows = list(pool.map(partial(evaluate, words.binary), truths))
    text = report(rows)
    print(text)
    if words.markdown:
        words.markdown.write_text(text)
    if words.csv:
        with words.csv.open("w", newline="") as file:
            writer = csv.DictWriter(file, list(rows[0]))
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main()
