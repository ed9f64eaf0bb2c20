"""From three pulses by formula to the shock of their vector by numpy and scipy.

`python3 tests/reference/resultants.py` rewrites resultants.tsv; `tests/it/shocks.rs` makes the same pulses.
"""

from math import sqrt
from pathlib import Path

import numpy as np
from scipy.signal import butter, filtfilt

RATE_HZ, G = 1e5, 9.80665
TIME_S = np.arange(10_000) / RATE_HZ
# Peak in g, beginning and length in s of each half sine.
PULSES = [(80.0, 0.040, 0.011), (-50.0, 0.042, 0.007), (30.0, 0.039, 0.015)]


def half_sine(peak_g, begin_s, length_s):
    phase = (TIME_S - begin_s) / length_s
    return np.where((phase >= 0) & (phase < 1), peak_g * G * np.sin(np.pi * phase), 0.0)


def crossings(values, level):
    """Where values pass the level before and after their largest, in samples."""
    at = int(np.argmax(values))
    below = np.flatnonzero(values[:at] < level)[-1]
    after = at + np.flatnonzero(values[at:] < level)[0]
    rise = lambda i, j: i + (level - values[i]) / (values[j] - values[i]) * (j - i)
    return rise(below, below + 1), rise(after, after - 1)


def shock(cutoff_hz):
    components = np.array([half_sine(*pulse) for pulse in PULSES])
    if np.isfinite(cutoff_hz):
        # Two passes of second order have -3 dB at (sqrt(2) - 1)^(1/4) of that of one.
        numerator, denominator = butter(2, cutoff_hz / (sqrt(2) - 1) ** 0.25, fs=RATE_HZ)
        smooth = filtfilt(numerator, denominator, components)
    else:
        smooth = components
    size, raw = np.linalg.norm(smooth, axis=0), np.linalg.norm(components, axis=0)
    begin, end = crossings(size, 0.1 * size.max())
    foot, last = (int(np.ceil(at)) for at in crossings(size, 0.01 * size.max()))
    velocity = np.cumsum(components[:, foot:last], axis=1) / RATE_HZ
    way = np.cumsum(velocity, axis=1) / RATE_HZ
    return [size.max(), raw.max(), TIME_S[np.argmax(size)], (end - begin) / RATE_HZ,
            np.linalg.norm(velocity[:, -1]), np.linalg.norm(way[:, -1])]


if __name__ == "__main__":
    rows = [[cutoff_hz, *(f"{value:.7g}" for value in shock(cutoff_hz))] for cutoff_hz in (300.0, 564.0, np.inf)]
    head = "cutoff_hz peak_m_s2 unfiltered_m_s2 time_s duration_s velocity_m_s displacement_m".split()
    table = "".join("\t".join(map(str, row)) + "\n" for row in [head, *rows])
    (Path(__file__).parent / "resultants.tsv").write_text(table)
