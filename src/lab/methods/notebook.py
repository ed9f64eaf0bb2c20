"""CSV recordings to slap-down speed and k, as a competent engineer gets them in a notebook of numpy and scipy.

Lines of the file that is named say a recording and its cask file, between them a tab. Each gives a line: seconds
from files to answer, speed in m/s, k; "nan" where there is none. Imports are not timed. It is for a transverse
channel at each end, near the axis, and for a first end that sticks or slides without friction. It shares no code
with dropcheck, states no interval and checks nothing.
"""

import sys
import time
import tomllib

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.optimize import least_squares
from scipy.signal import find_peaks


def waves(t, modes):
    """A constant, and damped sines of these frequencies, Hz, and shares of critical damping, in turn."""
    f, damping = modes[::2], modes[1::2]
    decay, turn = np.exp(-2 * np.pi * np.outer(t, f * damping)), 2 * np.pi * np.outer(t, f)
    return np.column_stack([np.ones_like(t), decay * np.cos(turn), decay * np.sin(turn)])


def fitted(t, v, noise):
    """The modes that the columns of v share, and how much of each wave a column has; the first row is the levels.

    Until noise is left, and up to three times, a mode is added at the highest peak of the residual's spectrum.
    """

    def sizes(modes):
        return np.linalg.lstsq(waves(t, modes), v, rcond=None)[0]

    def left(modes):
        return v - waves(t, modes) @ sizes(modes)

    f = np.fft.rfftfreq(8 * len(t), t[1] - t[0])
    modes, start = np.array([]), []
    while len(start) < 6 and np.any(left(modes).std(axis=0) > 2 * noise):
        height = np.abs(np.fft.rfft(left(modes) * np.hanning(len(t))[:, None], 8 * len(t), axis=0)).sum(axis=1)
        peaks = find_peaks(height)[0]
        if not len(peaks):
            break
        start += [f[peaks[height[peaks].argmax()]], 0.02]
        bounds = np.transpose([limits for f in start[::2] for limits in [(f / 3, 2 * f), (0, 0.2)]])
        modes = least_squares(lambda modes: left(modes).ravel(), start, bounds=bounds, x_scale=start).x
    return modes, sizes(modes)


def motion(path, channels, places):
    """Velocity steps without ringing, m/s; the cask's turning in the contact, rad/s; the sample interval, s; how
    long contact and flight are, s."""
    t, *force = np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)
    dt = (t[-1] - t[0]) / (len(t) - 1)
    force = np.transpose(force) * [9.80665 if channel["unit"] == "g" else 1.0 for channel in channels]
    # The offset is what the free fall shows; the raw samples are integrated. Of sensors in mirrored places the
    # turning is free of the first bending mode.
    fell = int(np.abs(force).max(axis=1).argmax() // 2)
    velocity = cumulative_trapezoid(force - force[:fell].mean(axis=0), dx=dt, axis=0, initial=0)
    turning = np.polyfit(places, velocity.T, 1)[0]
    n, m = max(1, round(2e-4 / dt)), round(0.02 / dt)
    sparse = max(1, n // 2)

    def blow(turning):
        return np.abs(np.pad(turning[2 * n :] - turning[: -2 * n], n))

    def noise(v, long):
        return v[first % long : first].reshape(-1, long, v.shape[1]).std(axis=1).mean(axis=0)

    # The second impact is about the greatest step of means over 20 ms; the first begins where the cask first turns.
    area = cumulative_trapezoid(turning, dx=dt, initial=0)
    slap = m + (area[2 * m :] - 2 * area[m:-m] + area[: -2 * m]).argmax()
    struck, quiet = blow(turning), 1.2 * blow(turning[:fell]).max()
    first = np.flatnonzero(struck > max(quiet, 0.03 * struck.max()))[0]
    part = int(0.6 * (slap - first))
    first = np.flatnonzero(struck > max(quiet, 0.03 * struck[first : first + part].max()))[0]

    # What rings late in the flight is taken off all of it; then both impacts have clear feet.
    late = slice(first + part, slap - part // 4, sparse)
    t = t - t[late.start]
    modes, sizes = fitted(t[late], turning[late, None], noise(turning[:, None], part))
    struck = blow(turning[first : slap + m] - (waves(t[first : slap + m], modes) @ sizes)[:, 0])
    before, after = struck[:part], struck[part:]
    gone = first + np.flatnonzero(before > 0.03 * before.max())[-1]
    second = first + part + np.flatnonzero(after > 0.03 * after.max())[0]

    flight = slice(gone + 2 * n, second - 2 * n, sparse)
    velocity -= velocity[first]
    _, sizes = fitted(t[flight] - t[gone], velocity[flight], noise(velocity, second - gone))
    return sizes[0], turning[first:gone] - turning[first], dt, (gone - first) * dt, (second - gone) * dt


def analysed(path, cask_path):
    """Slap-down speed, m/s, and k: a rigid cask in the plane, whose first end has rebounded as the steps say."""
    with open(cask_path, "rb") as file:
        stated = tomllib.load(file)
    cask, drop = stated["cask"], stated["drop"]
    cog, half = cask.get("cog_m", cask["length_m"] / 2), cask["height_m"] / 2
    g, phi0 = drop.get("gravity_m_s2", 9.81), np.radians(drop["angle_deg"])
    v0 = drop.get("impact_velocity_m_s", np.sqrt(2 * g * drop["height_m"]))
    places = [channel["position_m"] - cog for channel in stated["channel"]]
    steps, turning, dt, contact_s, flight_s = motion(path, stated["channel"], places)

    def arms(along, phi):
        return along * np.cos(phi) - half * np.sin(phi), along * np.sin(phi) + half * np.cos(phi)

    slope, step = np.polyfit(places, steps, 1)
    phi = phi0 + cumulative_trapezoid(turning, dx=dt, initial=0)
    mean = np.trapezoid(phi, turning) / turning[-1]
    a, b = arms(cog, phi[-1])
    x = -b * slope if stated["contact"]["friction"] == "rough" else 0.0
    z = (step + x * np.sin(mean)) / np.cos(mean) - g * contact_s - v0
    a2, b2 = arms(cog - cask["length_m"], phi[-1] + slope * flight_s)
    return np.hypot(x + b2 * slope, z - g * flight_s - a2 * slope), (z - a * slope) / v0


for line in open(sys.argv[1]):
    begun = time.perf_counter()
    try:
        answer = analysed(*line.rstrip("\n").split("\t"))
    except (IndexError, KeyError, ValueError, np.linalg.LinAlgError):
        answer = (np.nan, np.nan)
    print(time.perf_counter() - begun, *answer)
