"""From random numbers to a drop: cask, attitude, contacts, bending, sensors, and the motion that follows."""

import sys
from dataclasses import dataclass
from math import exp, inf, log, sqrt
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "fixtures/reference"))
from simulate import G0, Mode, Motion, Scene, crush_for, sensor, simulate  # noqa: E402

GRAVITY_M_S2 = 9.81
CASKS = (  # name, mass_kg, length_m, height_m
    ("ESBB", 315.0, 4.538, 0.15),
    ("ANF-10", 1429.0, 4.725, 0.565),
    ("ANF-18", 4466.0, 5.512, 0.792),
    ("VHLW", 20950.0, 4.486, 1.156),
)
RATES_HZ = (2000, 5000, 10000, 20000, 25000, 50000, 100000, 200000)
OVERTONES = (1.0, 2.757, 5.404)  # bending frequencies of a free uniform beam over its first
HIGHEST_MODE_HZ = 450.0
LONGEST_TO_SLAP_DOWN_S = 0.6  # below the 0.8 s after the impact that dropcheck looks at
SHORTEST_FLIGHT_S = 0.008


@dataclass
class Drop:
    """One drop: what the cask file says of it, what really happened, and how it is recorded."""

    name: str
    cask: dict  # the numbers of [cask]
    height_m: float
    angle_deg: float
    friction_text: str | None  # of [contact]; None: left out
    pulse_s: float  # aimed at; `contact_s` of the truth is what came of it
    motion: Motion
    sample_rate_hz: float
    before_s: float  # how much is recorded before first contact
    release_s: float | None  # negative, 0 at first contact; None: the record starts in free fall
    positions_m: list  # of the sensor on the first and on the second end
    offsets_m: list
    axial: bool
    noise_g: float
    zeros_g: list

    @property
    def truth(self):
        return self.motion.truth


def log_uniform(rng, low, high):
    return float(np.exp(rng.uniform(log(low), log(high))))


def draw_cask(rng):
    """Name and numbers of one of four casks; four in ten are stretched, some state centre of gravity or inertia."""
    name, mass_kg, length_m, height_m = CASKS[rng.integers(4)]
    if rng.random() < 0.4:
        length_m = round(length_m * rng.uniform(0.7, 1.3), 3)
        mass_kg = round(mass_kg * rng.uniform(0.6, 1.6), 1)
        height_m = round(height_m * rng.uniform(0.5, 1.2), 3)
        name += "-var"
    cask = {"mass_kg": mass_kg, "length_m": length_m, "height_m": height_m}
    if rng.random() < 0.25:
        cask["cog_m"] = round(length_m * rng.uniform(0.45, 0.55), 3)
    if rng.random() < 0.25:
        uniform_kg_m2 = mass_kg * (length_m**2 + height_m**2) / 12
        cask["inertia_kg_m2"] = round(uniform_kg_m2 * rng.uniform(0.85, 1.15), 1)
    return name, cask


def draw_friction(rng):
    """Friction of the first contact, and how the cask file says it."""
    part = rng.random()
    if part > 0.92:
        coefficient = float(np.round(rng.uniform(0.2, 0.9), 2))
        return coefficient, str(coefficient)
    if part > 0.88:
        return 0.0, '"smooth"'
    return inf, '"rough"' if part > 0.7 else None


def draw_modes(rng):
    """No to three bending modes of a beam."""
    count = int(rng.choice([0, 1, 2, 3], p=[0.07, 0.5, 0.28, 0.15]))
    first_hz = float(rng.uniform(30, 160)) if count else 0.0
    modes = []
    for index in range(count):
        frequency_hz = first_hz * OVERTONES[index] * (1 if index == 0 else rng.uniform(0.8, 1.1))
        if frequency_hz > HIGHEST_MODE_HZ:
            break
        damping = float(rng.uniform(0.01, 0.06))
        strength = float(rng.uniform(0.2, 1.0)) if rng.random() < 0.5 else 1.0
        modes.append(Mode(index + 1, frequency_hz, damping, strength))
    return modes


def draw_motion(rng):
    """One attempt at a drop: everything that the body and its contacts decide, and the motion."""
    name, cask = draw_cask(rng)
    angle_deg = round(float(rng.uniform(5, 30) if rng.random() < 0.8 else rng.uniform(2, 60)), 1)
    restitution = float(rng.uniform(0.02, 0.95)) if rng.random() < 0.7 else float(rng.uniform(0.1, 0.7))
    pulse_s = log_uniform(rng, 1e-3, 20e-3)
    height_m = 9.0 if rng.random() < 0.7 else float(rng.choice([0.3, 1.0, 1.2, 3.0, 5.0]))
    friction, friction_text = draw_friction(rng)
    modes = draw_modes(rng)
    plateau = float(rng.uniform(0.6, 0.95)) if rng.random() < 0.25 else inf
    body = cask | {"v0": sqrt(2 * GRAVITY_M_S2 * height_m)}
    first = crush_for(body, pulse_s, restitution, angle_deg, plateau)
    second = crush_for(body, pulse_s * rng.uniform(0.5, 1.5), float(rng.uniform(0.05, 0.7)), angle_deg)
    after_s = float(rng.uniform(0.02, 0.15))
    scene = Scene(**body, angle_deg=angle_deg, first=first, second=second, friction=friction, after_s=after_s, modes=modes)
    stated = {"name": name, "cask": cask, "height_m": height_m, "angle_deg": angle_deg}
    return stated | {"friction_text": friction_text, "pulse_s": pulse_s, "motion": simulate(scene)}


def is_slap_down(truth):
    """Whether the drop is one that dropcheck claims to measure: a rebound, one flight, a slap-down."""
    if "speed" not in truth or "k" not in truth or truth["flight_s"] is None or truth["relands"]:
        return False
    in_time = truth["slap_t"] <= LONGEST_TO_SLAP_DOWN_S and truth["flight_s"] >= SHORTEST_FLIGHT_S
    return in_time and 0.005 < truth["k"] < 0.97


def draw_sample_rate_hz(rng, motion):
    """A rate with 25 samples in the contact and 15 in a period of the highest mode."""
    highest_hz = max((mode.frequency_hz for mode in motion.scene.modes), default=0.0)
    needed_hz = max(2000, 25 / motion.truth["contact_s"], 15 * highest_hz)
    rates_hz = [rate for rate in RATES_HZ if rate >= needed_hz] or [50000]
    return float(rng.choice(rates_hz))


def draw_drop(rng):
    """A whole random drop."""
    drawn = draw_motion(rng)
    while not is_slap_down(drawn["motion"].truth):
        drawn = draw_motion(rng)
    rate_hz = draw_sample_rate_hz(rng, drawn["motion"])
    fall_s = sqrt(2 * drawn["height_m"] / GRAVITY_M_S2)
    rest = rng.random() < 0.2
    if rest:
        before_s = fall_s + float(rng.uniform(0.1, 0.4))
    else:
        longest_s = min(0.3, fall_s * 0.95) if rng.random() < 0.8 else fall_s * 0.95
        before_s = float(rng.uniform(0.05, longest_s))
    length_m, section_m = drawn["cask"]["length_m"], drawn["cask"]["height_m"]
    positions_m = [round(float(rng.uniform(0.05, 0.4)), 3), round(float(length_m - rng.uniform(0.05, 0.4)), 3)]
    offsets_m = [0.0, 0.0]
    if rng.random() < 0.2:
        offsets_m = [round(float(rng.uniform(-0.4, 0.4) * section_m), 3) for _ in range(2)]
    return Drop(
        **drawn, sample_rate_hz=rate_hz, before_s=before_s, release_s=-fall_s if rest else None,
        positions_m=positions_m, offsets_m=offsets_m, axial=rng.random() < 0.15,
        noise_g=log_uniform(rng, 0.02, 0.5), zeros_g=[float(zero) for zero in rng.uniform(-0.5, 0.5, 3)],
    )


def record(drop, rng):
    """Channels A1, A2 and perhaps A3 (axial, beside A1) in g, offset and noise on them."""
    end_s = drop.truth["slap_t"] + drop.motion.scene.after_s
    count = int(round((drop.before_s + end_s) * drop.sample_rate_hz))
    times_s = np.arange(count) / drop.sample_rate_hz - drop.before_s
    mounts = [("A1", 0, "transverse"), ("A2", 1, "transverse")] + ([("A3", 0, "axial")] if drop.axial else [])
    channels = {}
    for (name, end, axis), zero_g in zip(mounts, drop.zeros_g):
        force = sensor(drop.motion, times_s, drop.positions_m[end], drop.offsets_m[end], axis, drop.release_s)
        channels[name] = force / G0 + zero_g + drop.noise_g * rng.standard_normal(count)
    return channels
