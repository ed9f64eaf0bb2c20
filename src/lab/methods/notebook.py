"""CSV recordings to slap-down speed and k as in a notebook: filter forward and back, integrate, read off.

Lines of the file that is named say a recording and the impact velocity, m/s, between them a tab. Each gives a line: seconds from
file to answer, speed, k; "nan" where there is none. Imports are not timed.
"""

import sys
import time

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.signal import butter, sosfiltfilt


def read_off(path, v0):
    time_s, *forces = np.loadtxt(path, delimiter=",", skiprows=1, unpack=True)
    step_s = (time_s[-1] - time_s[0]) / (len(time_s) - 1)
    sections = butter(2, 2.0775 * 180.0, fs=1.0 / step_s, output="sos")
    smooth = [sosfiltfilt(sections, f - f[time_s < time_s[0] + 0.02].mean()) for f in forces]
    first, second = (cumulative_trapezoid(f, dx=step_s, initial=0.0) - v0 for f in smooth)
    top = int(smooth[0].argmax())
    left = top + np.flatnonzero(smooth[0][top:] < 0.05 * smooth[0][top])[0]
    slap = left + int(smooth[1][left:].argmax())
    foot = left + np.flatnonzero(smooth[1][left:slap] < 0.05 * smooth[1][slap])[-1]
    return -second[foot], first[left:foot].mean() / v0


for line in open(sys.argv[1]):
    path, v0 = line.rstrip("\n").split("\t")
    begun = time.perf_counter()
    try:
        answer = read_off(path, float(v0))
    except (IndexError, ValueError):
        answer = (np.nan, np.nan)
    print(time.perf_counter() - begun, *answer)
