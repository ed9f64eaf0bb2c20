"""From independent programs (compliant simulation, scipy) to the reference values that the tests compare with.

`python3 tests/reference/generate.py`, with the packages of `fixtures/reference/requirements.txt`, rewrites the JSON files here.
"""

import json
import sys
from math import inf, pi, sqrt
from pathlib import Path

import numpy as np
from scipy import signal
from scipy.integrate import quad

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent.parent / "fixtures/reference"))
sys.dont_write_bytecode = True

from simulate import Scene, crush_for, simulate  # noqa: E402

V0 = sqrt(2 * 9.81 * 9)
BODIES = {
    "rod": dict(mass_kg=4466.0, length_m=5.512, height_m=0.0),
    "ANF-18": dict(mass_kg=4466.0, length_m=5.512, height_m=0.792),
    "CASTOR VHLW": dict(mass_kg=20950.0, length_m=4.486, height_m=1.156),
    "lopsided": dict(mass_kg=4466.0, length_m=5.512, height_m=0.792, cog_m=2.4, inertia_kg_m2=10800.0),
}
PULSE_S = 4e-6  # short enough: speeds lie within 6e-5 of the limit, the distance shrinks with the pulse


def write(name, content):
    (HERE / name).write_text(json.dumps(content, indent=1) + "\n")


def prediction_case(name, body, friction, angle_deg, restitution):
    args = dict(body, v0=V0)
    crush = crush_for(args, PULSE_S, restitution, angle_deg)
    scene = Scene(**args, angle_deg=angle_deg, first=crush, second=crush, friction=friction, after_s=1e-5, longest_flight_s=1.5)
    truth = simulate(scene).truth
    label = {inf: "rough", 0.0: "smooth"}.get(friction, friction)
    case = {"body": name, "contact": label, "angle_deg": angle_deg, "k": truth["k"], "omega_rad_s": truth["omega_rebound"]}
    case["slap_down"] = None
    if "speed" in truth:
        keys = {"speed_m_s": "speed", "vertical_m_s": "vz", "horizontal_m_s": "vx", "after_first_impact_s": "slap_t"}
        case["slap_down"] = {new: truth[old] for new, old in keys.items()}
        case["slap_down"] |= {"angle_deg": truth["angle_hit_deg"], "energy_ratio": truth["energy_ratio"]}
        case["slap_down"]["first_end_impacts"] = truth["relands"] + 1
    return case


def elastic_rod(length_m):
    """Slap-down speed of a rod, 15 degrees, 9 m, rough, elastic: two short pulses, extrapolated to none."""
    speeds = []
    for pulse in (2e-6, 1e-6):
        args = dict(mass_kg=1000.0, length_m=length_m, height_m=0.0, v0=V0)
        crush = crush_for(args, pulse, 1.0, 15.0)
        speeds.append(simulate(Scene(**args, angle_deg=15.0, first=crush, second=crush, after_s=1e-5)).truth["speed"])
    return 2 * speeds[1] - speeds[0]


def predictions():
    """Slap-downs of four bodies (null where the body turns upright before R strikes), with k as the simulation reached it, and what the paper and its errata state."""
    cases = [
        prediction_case(name, body, friction, angle, restitution)
        for name, body in BODIES.items()
        for friction in (inf, 0.3, 0.0)
        for angle in (5.0, 10.0, 15.0, 25.0, 35.0, 45.0)
        for restitution in (0.05, 0.3, 0.6, 0.9)
    ]
    bodies = {}
    for name, body in BODIES.items():
        scene = Scene(**body, angle_deg=0.0, v0=V0, first=None, second=None)
        bodies[name] = dict(body, cog_m=scene.cog_m, inertia_kg_m2=scene.inertia_kg_m2)
    table_3 = [
        {"cask": cask, "length_m": length, "k": 1.0, "printed_m_s": 25, "speed_m_s": elastic_rod(length)}
        for cask, length in (("ESBB", 4.538), ("ANF-10", 4.725), ("ANF-18", 5.512))
    ]
    figure_8 = [  # rod of 4.75 m, 13.3 m/s, 15 degrees
        {"contact": "rough", "k": 1.0, "energy_ratio": 1.031},
        {"contact": "smooth", "k": 1.0, "energy_ratio": 1.033},
        {"contact": "rough", "k": 0.0, "energy_ratio": 0.768},
        {"contact": "smooth", "k": 0.0, "energy_ratio": 0.805},
    ]
    about = {"impact_velocity_m_s": V0, "gravity_m_s2": 9.81, "bodies": bodies}
    write("predictions.json", about | {"cases": cases, "table_3": table_3, "figure_8": figure_8})


def test_signal(rate_hz):
    """0.2 s: a Gaussian pulse of 4 ms on a slow sine and a fast one."""
    t = np.arange(round(0.2 * rate_hz)) / rate_hz
    return 1000 * np.exp(-(((t - 0.1) / 0.002) ** 2)) + 50 * np.sin(2 * pi * 20 * t) + 30 * np.sin(2 * pi * 900 * t)


def filters():
    """Two-pole Butterworth at 2.0775 CFC, forward and back: gain, and the filtered test signal far from its ends."""
    out = []
    for rate in (10_000.0, 100_000.0):
        x = test_signal(rate)
        for cfc in (60, 180, 600, 1000):
            sos = signal.butter(2, 2.0775 * cfc, fs=rate, output="sos")
            f = np.array([0.1, 0.25, 0.5, 1.0, 1.25, 1.65, 2.0775, 2.5, 4.0]) * cfc
            f = f[f < rate / 2]
            gain = np.abs(signal.freqz_sos(sos, worN=f, fs=rate)[1]) ** 2
            y = signal.sosfiltfilt(sos, x)
            at = [round(s * rate) for s in (0.08, 0.095, 0.098, 0.099, 0.1, 0.1005, 0.101, 0.103, 0.11, 0.12)]
            out.append(
                {"cfc": cfc, "rate_hz": rate, "frequency_hz": f.tolist(), "gain": gain.tolist(), "index": at, "filtered": y[at].tolist()}
            )
    about = "x(t) = 1000 exp(-((t - 0.1)/0.002)^2) + 50 sin(2 pi 20 t) + 30 sin(2 pi 900 t), t = i / rate_hz < 0.2"
    write("filters.json", {"signal": about, "cases": out})


def spectra():
    """|integral of f exp(-i w t)| of a half sine of 5 ms and a decaying 60 Hz sine, by quadrature of the defining integral."""
    shapes = {
        "1000 sin(pi t / 0.005), 0 <= t <= 0.005": (lambda t: 1000 * np.sin(pi * t / 0.005), 0.005),
        "500 exp(-40 t) sin(2 pi 60 t), 0 <= t <= 0.5": (lambda t: 500 * np.exp(-40 * t) * np.sin(2 * pi * 60 * t), 0.5),
    }
    out = []
    for text, (shape, end) in shapes.items():
        for f in (0.0, 20.0, 60.0, 100.0, 300.0):
            w = 2 * pi * f
            parts = [quad(lambda t: shape(t) * g(w * t), 0, end, limit=2000, epsabs=1e-10)[0] for g in (np.cos, np.sin)]
            out.append({"signal": text, "frequency_hz": f, "magnitude": float(np.hypot(*parts))})
    write("spectra.json", {"cases": out})


if __name__ == "__main__":
    predictions()
    filters()
    spectra()
