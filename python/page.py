"""The docstrings of the module to its page: python page.py > README.md, with the module installed."""

from __future__ import annotations

import inspect
import re
import textwrap

import dropcheck

# Characters of a line.
WIDTH = 110

HEAD = """# dropcheck for Python

One wheel installs the module `dropcheck` and the command of the same name. The module needs numpy; pandas and xarray
are needed only for the tables named after them, other libraries only for [`from_file`](#from_file). A wheel is a file
of a release (`pip install dropcheck-*.whl`) or comes from the sources: `pip install ./python` in the repository, with
a Rust toolchain. Linux with glibc 2.28 or newer.

*This page is written by `python/page.py` from the docstrings; an executed example is
[examples/campaign.ipynb](../examples/campaign.ipynb).*
"""

CLOSING = """## How it runs

The work runs without the interpreter's lock, on its own threads: calls from several threads run side by side, and a
forked process starts new threads. A separate process that can reach only that file reads HDF5; here it is
`sys.executable`, which loads only the extension. `command` in `result.json` gives the same result at the command line.
For samples in memory there is none, and `input` says `"samples in memory"` with their SHA-256.
"""


def words(of: object) -> str:
    return inspect.cleandoc(of.__doc__ or "")


def signature(of: object, name: str) -> str:
    return f"{name}{inspect.signature(of)}".replace("'", "").replace("self, ", "").replace("(self)", "()")  # type: ignore[arg-type]


def declared(text: str) -> str:
    """A signature, one argument a line where it is long."""
    if len(text) > 100:
        head, rest = text.split("(", 1)
        arguments, behind = rest.rsplit(")", 1)
        text = f"{head}(\n    " + ",\n    ".join(re.split(r", (?![^\[]*\])", arguments)) + f",\n){behind}"
    return f"```python\n{text}\n```"


def entry(name: str, of: object) -> list[str]:
    """A function, or a class with its fields, properties and functions."""
    if not inspect.isclass(of):
        return [f"### {name}", declared(signature(of, name)), words(of)]
    own = {key: value for key, value in vars(of).items() if not key.startswith("_")}
    is_made = of is dropcheck.Samples
    parts = [f"### {name}", *([declared(signature(of, name).split(" -> ")[0])] if is_made else []), words(of)]
    fields = [f"- `.{key}: {kind}`" for key, kind in vars(of).get("__annotations__", {}).items() if not key.startswith("_")]
    lines = fields
    for key, value in own.items():
        if isinstance(value, property):
            lines.append(f"- `.{key}`: {words(value)}")
        elif inspect.isfunction(value):
            lines.append(f"- `.{signature(value, key)}`: {words(value)}")
    listed = [textwrap.fill(" ".join(line.split()), WIDTH, subsequent_indent="  ") for line in lines]
    return [*parts, *(["\n".join(listed)] if lines else [])]


def page() -> str:
    parts = [HEAD.strip(), words(dropcheck), "## Functions"]
    for name in ["analyze", "from_file", "predict", "inspect", "synth", "main", "read_hdf5_with"]:
        parts += entry(name, getattr(dropcheck, name))
    parts.append("## Classes")
    for name in ["Samples", "Result", "Answer", "Record", "Quantity", "FirstImpact", "SlapDown", "Finding", "Comparison", "Shock", "FilteredPeak", "Error"]:
        parts += entry(name, getattr(dropcheck, name))
    return "\n\n".join([*parts, CLOSING.strip()]) + "\n"


if __name__ == "__main__":
    print(page(), end="")
