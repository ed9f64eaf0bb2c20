"""From 40 pairs of curves by formula to their ratings by another program, objective_rating_metrics 1.3 (TU Graz).

`python3 tests/reference/ratings.py` rewrites ratings.tsv; `numerics/rating.rs` makes the same curves of its columns.
"""

from itertools import product
from math import exp, pi, sin
from pathlib import Path

import numpy as np
from objective_rating_metrics.rating import ISO18571

STEP_S = 1e-4


def value(t, pulse_s, ring_share, ring_hz):
    """A half sine, and a decaying sine from its beginning on."""
    pulse = sin(pi * t / pulse_s) if 0 <= t <= pulse_s else 0.0
    return pulse + (ring_share * exp(-t / 0.03) * sin(2 * pi * ring_hz * t) if t >= 0 else 0.0)


def curve(count, scale, late_s, velocity, *shape):
    values = [scale * value(i * STEP_S - late_s, *shape) for i in range(count)]
    return np.cumsum(values) if velocity else np.array(values)


def rows():
    counts, pulses_s, scales = (180, 500, 1103), (0.006, 0.021), (1.0, 0.85, 1.4)
    lates_s, rings_hz = (0.0, 0.0011, -0.0008), (60.0, 75.0, 240.0)
    grid = list(product(counts, pulses_s, scales, lates_s, rings_hz, (0, 1)))
    # Every eighth of 324 combinations, begun at the fourth: 40 of them, each value among them.
    for count, pulse_s, scale, late_s, ring_hz, velocity in grid[4::8][:40]:
        time = STEP_S * np.arange(count)
        reference = curve(count, 1.0, 0.0, velocity, pulse_s, 0.3, 60.0)
        compared = curve(count, scale, late_s, velocity, pulse_s, 0.3, ring_hz)
        rating = ISO18571(*(np.column_stack([time, values]) for values in (reference, compared)))
        parts = (rating.corridor_rating, rating.phase_rating, rating.magnitude_rating, rating.slope_rating, rating.overall_rating)
        yield [count, pulse_s, scale, late_s, ring_hz, velocity] + [f"{part(-1):.6f}" for part in parts]


if __name__ == "__main__":
    head = "count pulse_s scale late_s ring_hz velocity corridor phase magnitude slope rating".split()
    table = "".join("\t".join(map(str, row)) + "\n" for row in [head, *rows()])
    (Path(__file__).parent / "ratings.tsv").write_text(table)
