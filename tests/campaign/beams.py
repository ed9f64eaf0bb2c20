"""From a seed to a folder of recordings with cask files and a `reference.toml` of their truth: random drops of a free
Timoshenko beam that bends in all modes up to the recorder's band, slides, and crushes limiters at both ends. Shares no
code with `synth` and no formula with the analysis. Python 3.11, with h5py, numpy, scipy and numba:

    python3 tests/campaign/beams.py ../beams --scenes 400 --seed 3000
    dropcheck validate --quick --reference ../beams

With `--faults`, one channel of each drop has a fault of its measuring chain: limited, slewing, overloaded, compressed,
broken or torn.

A drop is left out where the first end touches again, still stands on the target as the second one strikes, or has left
it for less than 8 ms, and where the cask has turned by 60 degrees beyond the horizontal. About three in five remain.
"""

import argparse
import json
import math
from pathlib import Path

import h5py
import numpy as np
from numba import njit
from scipy.interpolate import CubicSpline
from scipy.linalg import eigh
from scipy.signal import butter, lfilter, sosfilt

G_M_S2, UNIT_G = 9.81, 9.80665
RATES_HZ = [5000, 10000, 12500, 20000, 25000, 48000, 50000, 51200, 96000, 100000]
BENDING_SHARES = (0.5, 2.5)  # of the first bending frequency of a thick steel tube of this length and section
ELEMENTS = 24
HARDENING = 0.08  # of the elastic stiffness, behind the yield of a limiter
SLIDES_M_S = 0.05  # friction reaches its Coulomb value at about this velocity


def free_beam(drop):
    """Places of the nodes, frequencies and shapes of the bending modes, centre of gravity and inertia."""
    length, ends = drop["L"], drop["ends"]
    element = length / ELEMENTS
    count = 2 * (ELEMENTS + 1)
    line_mass = drop["m"] * (1 - sum(ends)) / length
    gyration2 = (drop["gyration"] * drop["h"]) ** 2
    shear = 12 * gyration2 * 2.6 / 0.53 / element**2
    mass, stiffness = np.zeros((count, count)), np.zeros((count, count))
    own = np.array([
        [12, 6 * element, -12, 6 * element],
        [6 * element, (4 + shear) * element**2, -6 * element, (2 - shear) * element**2],
        [-12, -6 * element, 12, -6 * element],
        [6 * element, (2 - shear) * element**2, -6 * element, (4 + shear) * element**2],
    ]) / (element**3 * (1 + shear))
    turn = gyration2
    inert = line_mass * element / 6 * np.array([[2, 0, 1, 0], [0, 2 * turn, 0, turn], [1, 0, 2, 0], [0, turn, 0, 2 * turn]])
    for i in range(ELEMENTS):
        part = slice(2 * i, 2 * i + 4)
        stiffness[part, part] += own
        mass[part, part] += inert
    for share, node in zip(ends, (0, ELEMENTS)):
        mass[2 * node, 2 * node] += share * drop["m"]
        mass[2 * node + 1, 2 * node + 1] += share * drop["m"] * (0.28 * drop["h"]) ** 2
    squares, shapes = eigh(stiffness, mass)
    frequencies = np.sqrt(squares[2:])
    places = np.linspace(0, length, ELEMENTS + 1)
    moved, turned = np.zeros(count), np.zeros(count)
    moved[0::2], turned[0::2], turned[1::2] = 1, places, 1
    centre = (moved @ mass @ turned) / (moved @ mass @ moved)
    turned[0::2] -= centre
    return places, frequencies * drop["f1"] / frequencies[0], shapes[:, 2:], centre, turned @ mass @ turned


def at(places, shapes, place):
    """Deflection and rotation of each mode at a place."""
    return CubicSpline(places, shapes[0::2])(place), CubicSpline(places, shapes[1::2])(place)


@njit(cache=True)
def fly(step, steps, body, omega, zeta, corner_w, corner_b, sensor_w, sensor_b, sensors, limiter, mu, begin, out, log):
    """Velocity Verlet of a rigid body in the plane and its modes; specific forces of the sensors go to `out`, times and
    rigid motions at the events to `log`."""
    m, inertia, c, length, height = body
    angle0, v0, rotation, sideways, before = begin
    modes, places = omega.size, sensors.shape[0]
    q, qd, qdd, push = np.zeros(modes), np.zeros(modes), np.zeros(modes), np.zeros(modes)
    deepest, hardest, normal, friction = np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2)
    eta = -height / 2
    theta, spin, vx, vz = angle0 + rotation * before, -rotation, sideways, -(v0 - G_M_S2 * before)
    reached = theta + spin * before
    z = c * math.sin(reached) - eta * math.cos(reached) - (vz * before - 0.5 * G_M_S2 * before * before)
    ax, az, turning = 0.0, -G_M_S2, 0.0
    left = struck = first = ended = -1.0
    for i in range(steps):
        z += vz * step + 0.5 * az * step * step
        theta += spin * step + 0.5 * turning * step * step
        half_x, half_z, half_spin = vx + 0.5 * ax * step, vz + 0.5 * az * step, spin + 0.5 * turning * step
        q += qd * step + 0.5 * qdd * step * step
        half_q = qd + 0.5 * qdd * step
        s, k = math.sin(theta), math.cos(theta)
        fx = fz = moment = 0.0
        push[:] = 0.0
        for end in range(2):
            w, b = np.dot(corner_w[end], q), np.dot(corner_b[end], q)
            wd, bd = np.dot(corner_w[end], half_q), np.dot(corner_b[end], half_q)
            along = (0.0 if end == 0 else length) - c - eta * math.sin(b)
            across = w + eta * math.cos(b)
            slip = half_x - eta * math.cos(b) * bd * k - (wd - eta * math.sin(b) * bd) * s
            slip -= half_spin * (along * s + across * k)
            depth = -(z + along * s + across * k)
            loading, unloading, limit = limiter[end]
            if depth > deepest[end]:
                force = min(loading * depth, limit) + HARDENING * loading * max(0.0, depth - limit / loading)
                deepest[end], hardest[end] = depth, force
            else:
                force = max(0.0, hardest[end] - unloading * (deepest[end] - depth)) if depth > 0 else 0.0
            drag = -mu * force * math.tanh(slip / SLIDES_M_S)
            normal[end], friction[end] = force, drag
            fx += drag
            fz += force
            moment += (along * k - across * s) * force - (along * s + across * k) * drag
            axial, shear = drag * k + force * s, force * k - drag * s
            push += corner_w[end] * shear - corner_b[end] * eta * (math.cos(b) * axial + math.sin(b) * shear)
        ax, az, turning = fx / m, fz / m - G_M_S2, moment / inertia
        vx, vz, spin = half_x + 0.5 * ax * step, half_z + 0.5 * az * step, half_spin + 0.5 * turning * step
        qdd = push - omega * omega * q - 2 * zeta * omega * half_q
        qd = half_q + 0.5 * qdd * step
        t = i * step
        if normal[0] > 0:
            if first < 0:
                first = t
                log[0] = np.array([t, vx, vz, spin, theta])
            elif left >= 0 and struck < 0:
                log[3, 0] = max(log[3, 0], t - left)
            left = -1.0
        elif first >= 0 and left < 0 and struck < 0:
            left = t
            log[1] = np.array([t, vx, vz, spin, theta])
        if normal[1] > 0 and struck < 0:
            struck = t
            log[2], log[3, 3] = np.array([t, vx, vz, spin, theta]), deepest[0]
            log[3, 1] = 1.0 if left < 0 else 0.0
        elif normal[1] == 0 and struck >= 0 and ended < 0:
            ended = t
            log[3, 2] = t - struck
        for j in range(places):
            w, wd, wdd = np.dot(sensor_w[j], q), np.dot(sensor_w[j], qd), np.dot(sensor_w[j], qdd)
            b, bd, bdd = np.dot(sensor_b[j], q), np.dot(sensor_b[j], qd), np.dot(sensor_b[j], qdd)
            arm, off = sensors[j, 0] - c, sensors[j, 1]
            sine, cosine = math.sin(b), math.cos(b)
            axial = ax * k + (az + G_M_S2) * s - turning * w - spin * spin * arm - 2 * spin * wd
            shear = -ax * s + (az + G_M_S2) * k + turning * arm - spin * spin * w + wdd
            axial += off * ((spin + bd) ** 2 * sine - (turning + bdd) * cosine)
            shear -= off * ((spin + bd) ** 2 * cosine + (turning + bdd) * sine)
            out[j, i] = shear * cosine - axial * sine if sensors[j, 2] == 0 else axial * cosine + shear * sine
    log[3, 4] = deepest[1]


def draw(rng):
    """What varies, over the envelope of docs/validation.md."""
    u = rng.uniform
    log_u = lambda low, high: math.exp(u(math.log(low), math.log(high)))  # noqa: E731
    while True:
        length = log_u(0.3, 8)
        height, f1 = length / u(2, 8.4), log_u(40, 600)
        usual = 1.03 * 5000 * 0.36 * height / length**2
        if BENDING_SHARES[0] * usual < f1 < BENDING_SHARES[1] * usual:
            break
    drop = {
        "L": length, "h": height, "m": log_u(900, 3500) * length * height**2, "f1": f1, "gyration": u(0.26, 0.36),
        "ends": [u(0, 0.12), u(0, 0.12)], "zeta": log_u(0.005, 0.03), "mu": u(0.1, 1.0),
        "H": 9.0 if u() < 0.5 else u(0.3, 12), "phi": math.radians(u(5, 30) if u() < 0.75 else u(2, 60)),
        "pulses_s": [log_u(1e-3, 45e-3) for _ in range(2)], "k": [u(0.05, 0.8) for _ in range(2)],
        "plateaus": [u(0.5, 0.95) if u() < 1 / 3 else None for _ in range(2)],
        "rotation": math.radians(rng.normal(0, 0.5)), "sideways": rng.normal(0, 0.05),
        "before": u(0.02, 0.25), "after": u(0.03, 0.12), "rest": u() < 0.2, "poles": int(rng.choice([4, 6, 8])),
        "bits": int(rng.integers(14, 25)), "noise_g": log_u(0.02, 0.5), "offset_g": u(0, 0.5), "stated": u() < 1 / 3,
    }
    wanted = max(log_u(5e3, 1e5), 25 / min(drop["pulses_s"]))
    drop["rate"] = float(min(RATES_HZ, key=lambda rate: abs(math.log(rate / wanted))))
    drop["cutoff"] = max(u(0.15, 0.4), min(0.4, 2000 / drop["rate"]))
    on_skin = u() < 0.5
    offset = lambda: float(rng.choice([-0.5, 0, 0.5])) * height if on_skin else 0.0  # noqa: E731
    drop["sensors"] = []
    for i in range(int(rng.choice([2, 2, 3, 4, 6, 8, 12]))):
        place = u(0.2, 0.4) * length if i >= 4 and u() < 0.3 else u(0.03, 0.16) * length
        drop["sensors"].append([place if i % 2 == 0 else length - place, offset(), 0, i % 2])
    if u() < 1 / 7:
        drop["sensors"].append([u(0.03, 0.2) * length, offset(), 1, 0])
    return drop


def simulate(drop):
    """Truth and the sensors' specific forces as the recorder samples them, m/s²; why not, where the drop is left out."""
    places, frequencies, shapes, centre, inertia = free_beam(drop)
    kept = frequencies < min(0.5 * drop["rate"], 9000)
    kept[0] = True
    frequencies, shapes = frequencies[kept], shapes[:, kept]
    length, height, v0 = drop["L"], drop["h"], math.sqrt(2 * G_M_S2 * drop["H"])
    limiter = np.zeros((2, 3))
    for end, (pulse_s, k, plateau) in enumerate(zip(drop["pulses_s"], drop["k"], drop["plateaus"])):
        angle = drop["phi"] if end == 0 else 0.0
        arm = (centre if end == 0 else length - centre) * math.cos(angle) - height / 2 * math.sin(angle)
        felt = 1 / (1 / drop["m"] + arm**2 / inertia)
        loading = felt * (math.pi / 2 * (1 + k) / pulse_s) ** 2
        elastic = (v0 if end == 0 else 1.3 * v0) * math.sqrt(loading * felt)
        limiter[end] = loading, loading / k**2, plateau * elastic if plateau else 1e30
    over = max(1, math.ceil(1 / (drop["rate"] * min(2e-6, 0.03 / frequencies.max()))))
    step = 1 / (drop["rate"] * over)
    before = min(drop["before"], 0.98 * v0 / G_M_S2)
    sensors = np.array([sensor[:3] for sensor in drop["sensors"]], dtype=float)
    corners = [np.array(of) for of in zip(*(at(places, shapes, place) for place in (0, length)))]
    seen = [np.array(of) for of in zip(*(at(places, shapes, place) for place in sensors[:, 0]))]
    body = (drop["m"], inertia, centre, length, height)
    begin = (drop["phi"], v0, drop["rotation"], drop["sideways"], before)
    omega = 2 * math.pi * frequencies
    zeta = np.full(omega.size, drop["zeta"])

    def run(until_s, of, seen):
        out, log = np.zeros((len(of), int(until_s / step) if len(of) else 1)), np.zeros((4, 5))
        fly(step, int(until_s / step), body, omega, zeta, *corners, *seen, of, limiter, drop["mu"], begin, out, log)
        return out, log

    none = np.zeros((0, omega.size))
    struck_s = run(before + 1.2, sensors[:0], (none, none))[1][2, 0]
    if struck_s == 0:
        return None, "no slap-down"
    until_s = struck_s + 1.3 * drop["pulses_s"][1] + drop["after"]
    if until_s / step * len(sensors) > 3e7:
        return None, "too long"
    out, log = run(until_s, sensors, seen)
    (first, left, struck), (gap_s, is_down, *_) = log[:3], log[3]
    flight_s = struck[0] - left[0]

    def corner(event, place):
        _, vx, vz, spin, theta = event
        along, across = place - centre, -height / 2
        return np.array([
            vx - spin * (along * math.sin(theta) + across * math.cos(theta)),
            vz + spin * (along * math.cos(theta) - across * math.sin(theta)),
        ])

    k = -corner(left, 0)[1] / corner(first, 0)[1]
    for why, is_so in {
        "down": is_down or flight_s < 0, "again": gap_s > 5e-4, "short": flight_s < 8e-3, "k": not 0.02 < k < 0.95,
        "turned": struck[4] < math.radians(-60),
    }.items():
        if is_so:
            return None, why
    truth = {
        "k": k, "speed": float(np.hypot(*corner(struck, length))), "omega": -left[3], "v0": -corner(first, 0)[1],
        "first_contact_s": first[0], "separation_s": left[0], "slap_down_s": struck[0], "cog_m": centre, "inertia": inertia,
        "crush_m": list(log[3, 3:]),
    }
    chain = butter(drop["poles"], drop["cutoff"] * drop["rate"], fs=1 / step, output="sos")
    fault = drop.get("fault")
    if fault and fault["before_filter"]:
        out[fault["channel"]] = spoiled(out[fault["channel"]], fault, step, truth)
    forces = sosfilt(chain, out, axis=1)[:, ::over]
    if fault and not fault["before_filter"]:
        forces[fault["channel"]] = spoiled(forces[fault["channel"]], fault, 1 / drop["rate"], truth)
    return (truth, forces), ""


def draw_fault(rng):
    """Which channel, which kind and how much; the size is logarithmic, as small ones are harder to see."""
    kind = str(rng.choice(["limited", "slewing", "overloaded", "compressed", "broken", "torn"]))
    low, high = {
        "limited": (0.5, 0.95), "slewing": (0.2, 0.8), "overloaded": (0.6, 0.95), "compressed": (0.01, 0.2),
        "broken": (1e-3, 20e-3), "torn": (0, 1),
    }[kind]
    return {
        "kind": kind, "channel": int(rng.integers(0, 2)), "before_filter": bool(rng.uniform() < 0.5),
        "size": math.exp(rng.uniform(math.log(low), math.log(high))) if low else rng.uniform(low, high),
        "when": rng.uniform(), "level": float(rng.choice([0, 1])),
        "recovery_s": math.exp(rng.uniform(math.log(2e-3), math.log(50e-3))), "droop": rng.uniform(0, 0.1),
    }


def spoiled(force, fault, step, truth):
    """What the chain makes of one channel's force."""
    size, peak, kind = fault["size"], np.abs(force).max(), fault["kind"]
    if kind == "limited":
        return np.clip(force, -size * peak, size * peak)
    if kind == "compressed":
        return force / (1 + size * np.abs(force) / peak)
    if kind == "overloaded":
        knee = size * peak
        over = np.maximum(np.abs(force) - knee, 0)
        soft = np.sign(force) * (np.minimum(np.abs(force), knee) + (peak - knee) * 0.3 * np.tanh(over / (0.3 * peak)))
        decay = math.exp(-step / fault["recovery_s"])
        return soft - lfilter([1 - decay], [1, -decay], np.sign(force) * over) * 10 * fault["droop"]
    if kind == "slewing":
        most = size * np.abs(np.diff(force)).max()
        return slewed(force, most)
    first, last = truth["first_contact_s"] - 5e-3, truth["slap_down_s"] + 5e-3
    begin = int((first + fault["when"] * (last - first)) / step)
    end = force.size if kind == "torn" else begin + int(size / step)
    force = force.copy()
    force[max(0, begin):end] = fault["level"] * 1.05 * peak
    return force


@njit(cache=True)
def slewed(force, most):
    """The force as an amplifier follows it that moves by at most so much a step."""
    out = force.copy()
    for i in range(1, out.size):
        out[i] = out[i - 1] + min(most, max(-most, force[i] - out[i - 1]))
    return out


def write(folder, name, drop, truth, forces, rng):
    """Recording, cask file and truth; what is stated is off by its tolerance."""
    lead = []
    if drop["rest"]:
        fallen = math.sqrt(2 * drop["H"] / G_M_S2) - truth["first_contact_s"]
        rest, falls = int(0.5 * drop["rate"]), max(0, int(fallen * drop["rate"]))
        levels = [G_M_S2 * (math.sin if axial else math.cos)(drop["phi"]) for _, _, axial, _ in drop["sensors"]]
        lead = [np.r_[np.full(rest, level), np.zeros(falls)] for level in levels]
        for event in ("first_contact_s", "separation_s", "slap_down_s"):
            truth[event] += (rest + falls) / drop["rate"]
    channels = []
    with h5py.File(folder / f"{name}.h5", "w") as file:
        for i, (force, sensor) in enumerate(zip(forces, drop["sensors"])):
            in_g = (np.r_[lead[i], force] if lead else force) / UNIT_G * (1 + rng.normal(0, 0.005))
            noise = lfilter(*butter(2, min(0.9, 2 * drop["cutoff"])), rng.normal(0, drop["noise_g"], in_g.size))
            in_g += noise + rng.normal(0, 0.5) * drop["offset_g"]
            full = np.abs(in_g).max() * rng.uniform(1.2, 4) + 5
            digit = 2 * full / 2 ** drop["bits"]
            stored = file.create_dataset(f"A{i + 1}", data=np.clip(np.round(in_g / digit) * digit, -full, full).astype("f4"))
            stored.attrs["sample_rate_hz"], stored.attrs["unit"] = drop["rate"], "g"
            place, offset, axial, end = sensor
            channels.append(
                f'[[channel]]\nname = "A{i + 1}"\nend = "{("first", "second")[end]}"\nsource = "/A{i + 1}"\nunit = "g"\n'
                f'axis = "{("transverse", "axial")[axial]}"\nposition_m = {place + rng.normal(0, 0.005):.5f}\n'
                f"offset_m = {offset:.5f}\nfull_scale = {full:.4f}\n"
            )
    length, height, v0 = (drop["L"], drop["h"], truth["v0"]) * (1 + rng.normal(0, [0.005, 0.005, 0.0015]))
    text = (
        f'[cask]\nname = "{name}"\nmass_kg = {drop["m"]:.4f}\nlength_m = {length:.5f}\nheight_m = {height:.5f}\n'
        f'cog_m = {truth["cog_m"] + rng.normal(0, 0.005):.5f}\n'
        f'inertia_kg_m2 = {truth["inertia"] * (1 + rng.normal(0, 0.01)):.6f}\n'
        f'[drop]\nheight_m = {v0**2 / 2 / G_M_S2:.5f}\nangle_deg = {math.degrees(drop["phi"]) + rng.normal(0, 0.2):.4f}\n'
    )
    if drop["stated"]:
        text += f'[contact]\nfriction = {drop["mu"] * (1 + rng.normal(0, 0.1)):.3f}\n'
    (folder / f"{name}.toml").write_text(text + "".join(channels))
    (folder / f"{name}.truth.json").write_text(json.dumps({"truth": truth, "drop": drop}, indent=1))


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("--scenes", type=int, default=100, help="drops that are drawn")
    arguments.add_argument("--seed", type=int, default=1, help="of the first; each next one has the next")
    arguments.add_argument("--faults", action="store_true", help="one channel's chain has a fault")
    given = arguments.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    tables, left_out = [], {}
    for seed in range(given.seed, given.seed + given.scenes):
        rng = np.random.default_rng(seed)
        drop = draw(rng)
        if given.faults:
            drop["fault"] = draw_fault(rng)
        found, why = simulate(drop)
        if why:
            left_out[why] = left_out.get(why, 0) + 1
            continue
        truth, forces = found
        write(given.folder, str(seed), drop, truth, forces, rng)
        tables.append(f'["{seed}.h5"]\nslap_down_speed_m_s = {truth["speed"]:.6f}\nk = {truth["k"]:.6f}\n')
    (given.folder / "reference.toml").write_text("\n".join(tables))
    print(f"{len(tables)} drops; left out: {left_out}")


if __name__ == "__main__":
    main()
