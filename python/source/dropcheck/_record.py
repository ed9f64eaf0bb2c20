"""JSON of the command as objects: a field is an attribute."""

from __future__ import annotations

import html
import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import os

    import numpy as np
    import pandas
    import xarray
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from . import _dropcheck


class Record:
    """A part of an answer. Its fields are attributes, named and meant as in the JSON; null is `None`."""

    __slots__ = ("_fields",)
    _fields: Mapping[str, Any]

    def __init__(self, fields: Mapping[str, Any]) -> None:
        object.__setattr__(self, "_fields", fields)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in self._fields:
            there = "" if name.startswith("_") else "; there is: " + ", ".join(self._fields)
            raise AttributeError(f"{type(self).__name__} has no {name!r}{there}")
        return _shown(name, self._fields[name])

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{name!r} cannot be set: an answer stays as it was given")

    def __reduce__(self) -> Any:
        return type(self), (self._fields,)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Record) and self._fields == other._fields

    __hash__ = None  # type: ignore[assignment]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._fields]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(self._fields)})"

    def to_dict(self) -> dict[str, Any]:
        """The fields as the JSON has them: a copy of your own."""
        copied: dict[str, Any] = json.loads(json.dumps(self._fields))
        return copied


class Quantity(Record):
    """A measured quantity: `value` ± `u95`, the half-width of its 95 % interval, in `unit`.

    `float(q)` is the value, `f"{q:.1f}"` writes both numbers so, with the unit.
    """

    __slots__ = ()
    value: float
    u95: float
    unit: str

    def __repr__(self) -> str:
        # Two digits of the interval.
        return format(self, f".{max(0, 1 - math.floor(math.log10(self.u95))) if self.u95 > 0 else 6}f")

    def __format__(self, spec: str) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.value:{spec}} ± {self.u95:{spec}}{unit}" if spec else repr(self)

    def __float__(self) -> float:
        return float(self.value)


class FirstImpact(Record):
    """What the first end did; `None` is what the recording does not tell, and a finding says why."""

    __slots__ = ()
    time: Quantity | None
    impact_velocity: Quantity | None
    duration: Quantity | None
    rebound_velocity: Quantity | None
    angular_velocity: Quantity | None


class SlapDown(Record):
    """What the second end did; `None` is what the recording does not tell, and a finding says why."""

    __slots__ = ()
    time: Quantity | None
    flight_time: Quantity | None
    speed: Quantity | None
    vertical_velocity: Quantity | None
    horizontal_velocity: Quantity | None
    angle: Quantity | None
    local_speed: Quantity | None


class Finding(Record):
    """What speaks for or against the data, as on the page of checks: `severity` is "note", "warning" or "error"."""

    __slots__ = ()
    code: str
    severity: str
    takes: list[str]
    channel: str | None
    message: str
    from_s: float | None
    to_s: float | None

    def __repr__(self) -> str:
        return f"{self.severity} {self.code}: {self.message}"


class Comparison(Record):
    """Measured beside predicted slap-down speed, m/s."""

    __slots__ = ()
    predicted: float
    measured: float
    difference_percent: float
    agrees: bool


class Shock(Record):
    """What one channel, or one mounting block of three, reads in one impact; `None` where it does not show the
    pulse whole. Only a block has `components`."""

    __slots__ = ()
    channel: str
    components: list[str]
    event: str
    peak: float | None
    peak_unfiltered: float | None
    time_s: float | None
    duration_s: float | None
    velocity_change_m_s: float | None
    displacement_m: float | None
    unit: str


class FilteredPeak(Record):
    """What one low-pass makes of the first end's first impact."""

    __slots__ = ()
    name: str
    cutoff_hz: float | None
    peak_g: float | None
    deceleration_g: float | None
    duration_s: float | None


_CLASSES: dict[str, type[Record]] = {
    "first_impact": FirstImpact,
    "slap_down": SlapDown,
    "quality": Finding,
    "comparison": Comparison,
    "shocks": Shock,
    "filters": FilteredPeak,
}


def _shown(name: str, value: Any) -> Any:
    if isinstance(value, list):
        return [_shown(name, item) for item in value]
    if not isinstance(value, dict):
        return value
    if value.keys() == {"value", "u95", "unit"}:
        return Quantity(value)
    return _CLASSES.get(name, Record)(value)


class Answer(Record):
    """The whole of what a command says."""

    __slots__ = ("_json",)
    _json: bytes

    def __init__(self, text: bytes) -> None:
        super().__init__(json.loads(text))
        object.__setattr__(self, "_json", text)

    def __reduce__(self) -> Any:
        return type(self), (self._json,)

    def to_json(self) -> str:
        """The JSON, to the byte as the command writes it."""
        return self._json.decode()


class _Held:
    """What a result hands on to another process."""

    def __init__(self, text: bytes, curves: Any, motion: Any) -> None:
        self._parts = text, curves, motion

    def json(self) -> bytes:
        return self._parts[0]

    def curves(self) -> Any:
        return [(name, dict(of)) for name, of in self._parts[1]]

    def motion(self) -> Any:
        return self._parts[2]

    def write(self, folder: str) -> None:
        raise TypeError("this result came from another process: write the report there")


class Result(Answer):
    """What `analyze` found: the fields of result.json as attributes, and the curves.

    `verdict` is "pass", "review" or "fail"; a failed verdict is a result, not an error.
    """

    __slots__ = ("_analysis",)
    _analysis: _dropcheck.Analysis | _Held
    verdict: str
    first_impact: FirstImpact
    slap_down: SlapDown
    k: Quantity | None
    amplification: Quantity | None
    comparison: Comparison | None
    predictions: list[Record]
    impacts: list[Record]
    shocks: list[Shock]
    filters: list[FilteredPeak]
    missing: list[Record]
    simulation: list[Record]

    def __init__(self, analysis: _dropcheck.Analysis | _Held) -> None:
        super().__init__(analysis.json())
        object.__setattr__(self, "_analysis", analysis)

    def __reduce__(self) -> Any:
        return type(self), (_Held(self._json, self._analysis.curves(), self._analysis.motion()),)

    def _repr_html_(self) -> str:
        numbers = {"slap-down speed": self.slap_down.speed, "restitution k": self.k}
        rows = [(name, str(of or "not determined")) for name, of in numbers.items()]
        if self.comparison:
            measured = f"measured {self.comparison.difference_percent:+.1f} %"
            rows.append(("predicted speed", f"{self.comparison.predicted:.2f} m/s, {measured}"))
        rows += [(f"{found.severity} {found.code}", found.message) for found in self.findings if found.severity != "note"]
        cells = [(html.escape(name), html.escape(of)) for name, of in rows]
        table = "".join(f"<tr><th>{name}</th><td>{of}</td></tr>" for name, of in cells)
        return f"<table><caption>{html.escape(self.verdict)}, ± 95 %</caption>{table}</table>"

    def __repr__(self) -> str:
        return f"Result({self.verdict}: slap-down {self.slap_down.speed}, k {self.k}, {len(self.findings)} findings)"

    @property
    def findings(self) -> list[Finding]:
        """Every finding, errors first: `quality` of result.json."""
        found: list[Finding] = self.quality
        return found

    @property
    def curves(self) -> dict[str, NDArray[np.float64]]:
        """The curves by name, each an array of your own.

        Of a channel `A1` it holds `A1`, the unfiltered specific force without its offset, m/s²;
        `A1.filtered_m_s2`; `A1.velocity_m_s`, integrated from it; and `A1.time_s`, from the recording's first sample.
        """
        held = self._analysis.curves()
        arrays = {name: of["raw_m_s2"] for name, of in held}
        return arrays | {f"{name}.{key}": of[key] for name, of in held for key in of if key != "raw_m_s2"}

    @property
    def motion(self) -> dict[str, NDArray[np.float64]]:
        """The motion of the rigid body by the names of curves.csv, such as `angle_deg` over `time_s`; else empty."""
        return dict(self._analysis.motion())

    def curves_frame(self) -> pandas.DataFrame:
        """The curves as one pandas table, indexed by channel and time; needs pandas."""
        import pandas

        tables = {name: pandas.DataFrame(of).set_index("time_s") for name, of in self._analysis.curves()}
        return pandas.concat(tables, names=["channel"])

    def to_xarray(self) -> xarray.Dataset:
        """The curves as variables `A1.raw_m_s2` … over each channel's own times; needs xarray."""
        import xarray

        held = self._analysis.curves()
        times = {f"{name}.time_s": of.pop("time_s") for name, of in held}
        variables = {f"{name}.{key}": (f"{name}.time_s", of[key]) for name, of in held for key in of}
        return xarray.Dataset(variables, coords=times, attrs={"verdict": self.verdict})

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draws the velocity of every channel over time with both impacts; needs matplotlib. Without `axes` it makes its own."""
        if axes is None:
            from matplotlib import pyplot

            axes = pyplot.subplots(layout="constrained")[1]
        for name, of in self._analysis.curves():
            axes.plot(1e3 * of["time_s"], of["velocity_m_s"], label=name)
        for at_s, event in [(self.first_impact.time, "first contact"), (self.slap_down.time, "slap-down")]:
            if at_s is not None:
                axes.axvline(1e3 * at_s.value, color="0.5", linestyle="--", label=event)
        axes.set(xlabel="time after the first sample in ms", ylabel="change of velocity in m/s")
        axes.set_title(f"{self.verdict}: slap-down {self.slap_down.speed or 'not determined'}")
        axes.legend()
        return axes

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Writes the report into `folder`, as `--out` does: report.html, result.json, curves, pictures.

        A folder that holds the report of another recording is refused. A result that came from another process has no
        pictures, and cannot be written.
        """
        import os

        self._analysis.write(os.fsdecode(folder))
