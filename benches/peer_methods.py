"""From samples and truths in files to the errors and times of scipy's filters and integrals on them.

Run by `dropcheck validate`, which writes the files: python3 - quick|full FOLDER. Answers with FOLDER/answer.json:
a sentence with the versions, and points as `validation.json` has them.
"""

import json
import platform
import sys
import time
from pathlib import Path

import numpy as np
import scipy
from scipy.integrate import cumulative_simpson, cumulative_trapezoid
from scipy.signal import butter, filtfilt, sosfiltfilt


def notebook(samples, rate_hz, impact_velocity_m_s):
    """Slap-down speed as one reads it off the second end's velocity: CFC 180, integrated, at the foot of the highest pulse."""
    sections = butter(2, 2.0775 * 180, fs=rate_hz, output="sos")
    smooth = sosfiltfilt(sections, samples)
    velocity = cumulative_trapezoid(smooth, dx=1 / rate_hz, initial=0.0)
    top = int(np.argmax(smooth))
    foot = top - int(np.argmax(smooth[top::-1] < 0.05 * smooth[top]))
    return np.array([impact_velocity_m_s - velocity[foot]])


def methods(work, samples):
    """Name and call of everything that does this work."""
    if work["drop"]:
        return {"scipy, whole analysis": lambda: notebook(samples, *work["drop"])}
    if work["low_pass"]:
        order, design_over_rate = work["low_pass"]
        sections = butter(order, design_over_rate, fs=1.0, output="sos")
        b, a = butter(order, design_over_rate, fs=1.0)
        return {
            "scipy sosfiltfilt": lambda: sosfiltfilt(sections, samples),
            "scipy filtfilt (b, a)": lambda: filtfilt(b, a, samples),
        }
    step = 1.0 / (len(samples) - 1)
    return {
        "scipy cumulative_trapezoid": lambda: cumulative_trapezoid(samples, dx=step, initial=0.0),
        "scipy cumulative_simpson": lambda: cumulative_simpson(samples, dx=step, initial=0.0),
    }


def times_ns(calls, rounds):
    """Quartiles of the time of a call, each having its turn in every round."""
    taken = {name: [] for name in calls}
    for _ in range(rounds + 1):
        for name, call in calls.items():
            begun = time.perf_counter_ns()
            call()
            taken[name].append(time.perf_counter_ns() - begun)
    return {name: np.percentile(of[1:], [25, 50, 75]) for name, of in taken.items()}


def main():
    quick, folder = sys.argv[1] == "quick", Path(sys.argv[2])
    found = {}
    for i, work in enumerate(json.loads((folder / "work.json").read_text())):
        samples = np.fromfile(folder / f"{i}.samples", "<f8")
        truth = np.fromfile(folder / f"{i}.truth", "<f8")
        calls = methods(work, samples)
        quartiles = times_ns(calls, 5 if quick else 15)
        for name, call in calls.items():
            with np.errstate(all="ignore"):
                error = float(np.max(np.abs(call() - truth)) / np.max(np.abs(truth)))
            error = (error if np.isfinite(error) else 1e9) * (100 if work["drop"] else 1)
            per = 1 if work["drop"] else len(samples)
            key = (work["family"], work["class"], name, work["error_unit"], "call" if work["drop"] else "sample")
            found.setdefault(key, []).append((error, *(float(t) / per for t in quartiles[name])))
    points = []
    for (family, scenes, name, unit, per), cases in found.items():
        errors, low, middle, high = (np.array(column) for column in zip(*cases))
        points.append(
            dict(family=family, method=name, is_default=False, median_error=float(np.median(errors)),
                 p95_error=float(np.percentile(errors, 95)), error_unit=unit, time_ns=float(np.median(middle)),
                 time_quartiles_ns=[float(np.median(low)), float(np.median(high))], time_per=per,
                 cases=len(cases), **{"class": scenes})
        )
    versions = f"scipy {scipy.__version__} with numpy {np.__version__} on Python {platform.python_version()}"
    (folder / "answer.json").write_text(json.dumps([versions, points]))


main()
