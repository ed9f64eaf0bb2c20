"""From a plain drop to one with a single damage: to the sensors, the recorder, the file, or what the cask file says."""

from dataclasses import dataclass, field
from math import pi

import numpy as np
from scenes import Drop, log_uniform, record
from scipy.signal import bilinear, lfilter
from simulate import G0

BOTH = ("A1", "A2")
MAINS_HZ = 50.0


@dataclass
class Case:
    """A damaged drop on its way to the files."""

    drop: Drop
    struck: str  # the channel that a damage of one channel strikes
    end_s: float | None = None  # where the record ends, 0 at first contact; None: after the slap-down
    times_s: np.ndarray | None = None
    channels: dict = field(default_factory=dict)
    statement: dict = field(default_factory=dict)  # what the cask file says otherwise than it is
    missing_blocks: list = field(default_factory=list)  # (channel, block)
    block_samples: int = 1000
    note: dict = field(default_factory=dict)  # for the truth: what was done, with its size

    @property
    def impact_s(self):
        """First contact, after the first sample."""
        return self.drop.before_s

    @property
    def contact_s(self):
        return self.drop.truth["contact_s"]

    @property
    def slap_s(self):
        """Slap-down, after first contact."""
        return self.drop.truth["slap_t"]

    def index(self, since_impact_s):
        return int((self.impact_s + since_impact_s) * self.drop.sample_rate_hz)

    def some_channels(self, rng):
        """Half the time one channel, half the time both."""
        return [self.struck] if rng.random() < 0.5 else list(BOTH)


# Before the recording


def wrong_position(case, rng):
    """The cask file puts one sensor 0.3 to 1 m too far inward."""
    end = int(rng.integers(2))
    shift_m = float(rng.uniform(0.3, 1.0))
    positions_m = list(case.drop.positions_m)
    positions_m[end] = round(positions_m[end] + (shift_m if end == 0 else -shift_m), 3)
    case.statement["positions_m"] = positions_m
    case.note = {"channel": BOTH[end], "shift_m": shift_m}


def low_rate(case, rng):
    """1.5 to 5 samples in the first contact, no filter before the sampling."""
    rate_hz = float(max(300, round(rng.uniform(1.5, 5) / case.contact_s, -1)))
    case.drop.sample_rate_hz = rate_hz
    case.note = {"samples_in_contact": rate_hz * case.contact_s}


def ends_early(case, rng):
    """The record ends in the flight."""
    case.end_s = float(rng.uniform(case.contact_s * 1.2, case.slap_s * 0.97))
    flight_s = case.slap_s - case.contact_s
    case.note = {"end_after_impact_s": case.end_s, "part_of_flight": (case.end_s - case.contact_s) / flight_s}


def starts_late(case, rng):
    """The record starts around first contact, up to half a contact after it ended."""
    late_s = float(rng.uniform(-0.1, 1.5)) * case.contact_s
    case.drop.release_s, case.drop.before_s = None, -late_s
    case.note = {"start_after_impact_s": late_s}


# On the recorded samples


def clip(case, rng, channel, part):
    """Cuts `channel` at 20 to 95 % of its peak in `part` (or anywhere); the limit is stated, noisy or neither."""
    samples = case.channels[channel]
    peak_g = np.abs(samples[part] if rng.random() < 0.6 else samples).max()
    of_peak = float(rng.uniform(0.2, 0.95))
    limit_g = float(of_peak * peak_g)
    case.channels[channel] = np.clip(samples, -limit_g, limit_g)
    case.note = {"channel": channel, "limit_g": limit_g, "of_peak": of_peak}
    if rng.random() < 0.5:
        case.statement["lines"] = {channel: [f"full_scale = {limit_g:.4f}"]}
        case.note["full_scale_stated"] = True
    elif rng.random() < 0.4:
        case.channels[channel] += 0.3 * case.drop.noise_g * rng.standard_normal(len(samples))
        case.note["noisy_rail"] = True


def clip_first(case, rng):
    clip(case, rng, "A1", slice(case.index(0), case.index(case.contact_s)))


def clip_second(case, rng):
    clip(case, rng, "A2", slice(case.index(case.slap_s), None))


def cut_gap(case, rng, as_blocks, from_s, to_s):
    """Loses what lies between from_s and to_s after the first sample, as lost blocks of an MCAP file or as NaN."""
    rate_hz = case.drop.sample_rate_hz
    names = [case.struck] if rng.random() < 0.6 else list(BOTH)
    if as_blocks:
        case.block_samples = block = max(20, int((to_s - from_s) * rate_hz / 3))
        first = int(from_s * rate_hz) // block
        last = max(first + 1, int(to_s * rate_hz) // block)
        case.missing_blocks = [(name, number) for name in names for number in range(first, last)]
        case.note = {"channels": names, "from_s": first * block / rate_hz, "to_s": last * block / rate_hz}
        return
    for name in names:
        case.channels[name][int(from_s * rate_hz) : int(to_s * rate_hz)] = np.nan
    case.note = {"channels": names, "from_s": from_s, "to_s": to_s, "nan": True}


def gap_impact(case, rng):
    as_blocks = rng.random() < 0.5
    from_s = case.impact_s + rng.uniform(-0.3, 0.7) * case.contact_s
    cut_gap(case, rng, as_blocks, from_s, from_s + rng.uniform(0.1, 0.8) * case.contact_s)


def gap_flight(case, rng):
    as_blocks = rng.random() < 0.5
    flight_s = case.slap_s - case.contact_s
    from_s = case.impact_s + case.contact_s + rng.uniform(0.1, 0.5) * flight_s
    cut_gap(case, rng, as_blocks, from_s, from_s + rng.uniform(0.1, 0.45) * flight_s)


def zero_shift(case, rng):
    """A step of 1 to 50 g that grows over the first contact and stays."""
    shift_g = float(np.exp(rng.uniform(0, np.log(50))) * rng.choice([-1, 1]))
    case.channels[case.struck] += shift_g * np.clip(case.times_s / case.contact_s, 0, 1)
    case.note = {"channel": case.struck, "shift_g": shift_g}


def drift(case, rng):
    """A slope of 5 to 100 g/s over the record, or 5 to 100 g at the impact that decay in 5 to 50 ms."""
    size = float(rng.uniform(5, 100) * rng.choice([-1, 1]))
    shape = str(rng.choice(["linear", "decay"]))
    if shape == "linear":
        added_g = size * (case.times_s - case.times_s[0])
    else:
        decay_s = rng.uniform(0.005, 0.05)
        added_g = size * np.where(case.times_s > 0, np.exp(-np.maximum(case.times_s, 0) / decay_s), 0)
    case.channels[case.struck] += added_g
    case.note = {"channel": case.struck, "shape": shape, "g_per_s" if shape == "linear" else "g": size}


def polarity(case, _rng):
    case.channels[case.struck] *= -1
    case.note = {"channel": case.struck}


def ends_swapped(case, _rng):
    case.channels["A1"], case.channels["A2"] = case.channels["A2"], case.channels["A1"]


def unit_g_as_ms2(case, rng):
    """Samples in g that file and cask file call m/s²."""
    names = case.some_channels(rng)
    case.statement["units"] = {name: "m/s^2" for name in names}
    case.note = {"channels": names}


def scale_some(case, rng, factors):
    names = case.some_channels(rng)
    factor = float(rng.choice(factors)) if len(factors) > 1 else factors[0]
    for name in names:
        case.channels[name] = case.channels[name] * factor
    case.note = {"channels": names, "factor": factor}


def unit_ms2_as_g(case, rng):
    scale_some(case, rng, [G0])


def scale_10(case, rng):
    scale_some(case, rng, [10, 0.1])


def scale_1000(case, rng):
    scale_some(case, rng, [1000, 0.001])


def unit_mv(case, rng):
    """Both channels in mV with a sensitivity off by a factor of 0.001 to 1000, or by 20 to 25 %."""
    mv_per_g = float(rng.choice([1.0, 10.0, 100.0, 0.5]))
    stated = float(mv_per_g * rng.choice([10, 0.1, 1000, 0.001, 1.25, 0.8]))
    for name in BOTH:
        case.channels[name] = case.channels[name] * mv_per_g
    case.statement["units"] = {name: "mV" for name in BOTH}
    case.statement["lines"] = {name: [f"sensitivity = {stated}"] for name in BOTH}
    case.note = {"channels": list(BOTH), "mv_per_g": mv_per_g, "stated_mv_per_g": stated}


def scale_off(case, rng):
    """One channel 5 to 30 % too large or too small."""
    factor = float(1 + rng.uniform(0.05, 0.3) * rng.choice([-1, 1]))
    case.channels[case.struck] *= factor
    case.note = {"channel": case.struck, "factor": factor}


def skew(case, rng):
    """One channel 0.2 to 5 ms early or late."""
    late_s = float(log_uniform(rng, 0.2e-3, 5e-3) * rng.choice([-1, 1]))
    case.channels[case.struck] = np.interp(case.times_s - late_s, case.times_s, case.channels[case.struck])
    case.note = {"channel": case.struck, "late_s": late_s}


def ac_coupled(case, rng):
    """Both channels through a high-pass of 0.1 to 2 s that the cask file does not mention."""
    time_constant_s = log_uniform(rng, 0.1, 2)
    numerator, denominator = bilinear([time_constant_s, 0], [time_constant_s, 1], case.drop.sample_rate_hz)
    for name in BOTH:
        case.channels[name] = lfilter(numerator, denominator, case.channels[name] - case.channels[name][0])
    case.note = {"time_constant_s": time_constant_s}


def dead(case, rng):
    """One channel with nothing but noise, or exactly zero."""
    noise_g = case.drop.noise_g * rng.standard_normal(len(case.times_s))
    case.channels[case.struck] = noise_g * (1 if rng.random() < 0.5 else 0)
    case.note = {"channel": case.struck}


def hum(case, rng):
    """50 Hz of 0.5 to 5 g."""
    size_g = log_uniform(rng, 0.5, 5)
    phase_rad = rng.uniform(0, 2 * pi)
    names = case.some_channels(rng)
    for name in names:
        case.channels[name] += size_g * np.sin(2 * pi * MAINS_HZ * case.times_s + phase_rad)
    case.note = {"channels": names, "hum_g": size_g}


def spikes(case, rng):
    """1 to 29 single samples off by 20 to 2000 g."""
    count = int(rng.integers(1, 30))
    earliest = 0 if rng.random() < 0.5 else case.index(0)
    at = rng.integers(earliest, len(case.times_s), count)
    size_g = log_uniform(rng, 20, 2000)
    case.channels[case.struck][at] += size_g * rng.choice([-1, 1], count)
    case.note = {"channel": case.struck, "spikes": count, "size_g": size_g}


def dropouts(case, rng):
    """1 to 7 stretches of exact zeros, 0.5 to 6 ms long, between first contact and slap-down."""
    count, length_s = int(rng.integers(1, 8)), float(rng.uniform(0.0005, 0.006))
    length = max(1, int(length_s * case.drop.sample_rate_hz))
    earliest = max(case.index(0) - int(0.01 * case.drop.sample_rate_hz), 0)
    latest = min(case.index(case.slap_s) + 10, len(case.times_s) - 2)
    for _ in range(count):
        at = int(rng.integers(earliest, latest))
        case.channels[case.struck][at : at + length] = 0.0
    case.note = {"channel": case.struck, "dropouts": count, "length_s": length_s}


# In the cask file


def wrong_angle(case, rng):
    """The cask file is 2 to 10° off."""
    angle_deg = case.drop.angle_deg
    off_deg = float(rng.uniform(2, 10) * rng.choice([-1, 1]))
    off_deg = off_deg if angle_deg + off_deg > 2 else -off_deg
    case.statement["angle_deg"] = round(angle_deg + off_deg, 1)
    case.note = {"stated_deg": case.statement["angle_deg"]}


def wrong_height(case, rng):
    """The drop height in the cask file is 20 to 50 % off."""
    factor = float(1 + rng.uniform(0.2, 0.5) * rng.choice([-1, 1]))
    case.statement["height_m"] = round(case.drop.height_m * factor, 3)
    case.note = {"factor": factor}


BEFORE = (wrong_position, low_rate, ends_early, starts_late)
KINDS = (  # one after the other over the numbers of the scenes
    clip_first, clip_second, gap_impact, gap_flight, zero_shift, drift, polarity, ends_swapped, unit_g_as_ms2,
    unit_ms2_as_g, scale_10, scale_1000, unit_mv, scale_off, skew, ac_coupled, dead, hum, spikes, dropouts,
    starts_late, ends_early, wrong_angle, wrong_height, wrong_position, low_rate,
)


def damage(kind, drop, rng):
    """The drop recorded with a damage of that kind."""
    case = Case(drop, struck=str(rng.choice(["A1", "A2"])))
    if kind in BEFORE:
        kind(case, rng)
    case.times_s, case.channels = record(drop, rng, case.end_s)
    if kind not in BEFORE:
        kind(case, rng)
    return case
