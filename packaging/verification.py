"""From the folder of packaging/verification to its report in one page of HTML, on standard output."""

import hashlib
import html
import json
import platform
import re
import subprocess
import sys
from pathlib import Path

from markdown import markdown

STYLE = """@page { size: A4; margin: 18mm 15mm } body { font: 10pt/1.4 Helvetica, Arial, sans-serif }
h1 { page-break-before: always } h1:first-of-type { page-break-before: auto } img, svg { max-width: 100%; height: auto }
table { border-collapse: collapse; font-size: 7.5pt } td, th { border-bottom: 1px solid #bbb; padding: 2px 5px;
text-align: left; vertical-align: top; overflow-wrap: anywhere }
td:first-child { white-space: nowrap } pre { font-size: 7.5pt; white-space: pre-wrap }"""


def told(*words):
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout.strip()


def written(text):
    """Markdown as HTML, its pictures left to the chapter that holds them."""
    text = re.sub(r"!\[[^]]*\]\([^)]*\)", "", re.sub(r"<!--.*?-->", "", text, flags=re.S))
    return markdown(text, extensions=["tables"])


def scored(limits):
    """Whether the intervals of each drop of the second simulation hold its truth, in a paragraph."""
    drops = {}
    for limit in limits:
        name, _, quantity = limit["name"].partition(": ")
        if name.endswith((".h5", ".mcap")):
            value, least, most = (limit[key] for key in ("value", "least", "most"))
            is_held = None if value is None else (least is None or least <= value) and (most is None or value <= most)
            drops.setdefault(name, {})[quantity] = is_held
    without = [name for name, held in drops.items() if None in held.values()]
    beyond = [f"{name} ({quantity})" for name, held in drops.items() for quantity, is_held in held.items() if is_held is False]
    return (f"<p>Of {len(drops)} drops {len(without)} get no number ({', '.join(without) or 'none'}). The intervals of the others hold "
            f"speed, k and angular velocity; beyond: {', '.join(beyond) or 'none'}.</p>")


def main(work, program, seed):
    work, program = Path(work), Path(program)
    versions = {
        "program": told(program, "--version"),
        "commit": told("git", "rev-parse", "HEAD") + (" with changes" if told("git", "status", "--porcelain", "-uno") else ""),
        "SHA-256 of the program": hashlib.sha256(program.read_bytes()).hexdigest(),
        "SHA-256 of Cargo.lock": hashlib.sha256(Path("Cargo.lock").read_bytes()).hexdigest(),
        "compiler": told("rustc", "--version"),
        "machine": f"{platform.system()} {platform.machine()}",
        "seed of what is random": seed,
    }
    rows = "".join(f"<tr><th>{name}</th><td>{html.escape(value)}</td></tr>" for name, value in versions.items())
    readers = (work / "readers.txt").read_text()
    acceptance = (work / "acceptance" / "validation.md").read_text()
    told_of_it = re.sub("^Written: .*", "", (work / "acceptance.txt").read_text(), flags=re.M).strip()
    verdict = told_of_it.rpartition("\n\n")[2]
    second = json.loads((work / "second" / "validation.json").read_text())["limits"]
    pictures = "".join((work / "acceptance" / f"{name}.svg").read_text() for name in ("speed", "failures"))
    chapters = {
        "Acceptance": f"<p>What the program is held against on this machine, finite elements "
        f"(fixtures/reference/fe) among it.</p>{written(acceptance)}{pictures}"
        f"<pre>{html.escape(told_of_it)}</pre>",
        "Campaign": written((work / "campaign" / "campaign.md").read_text()),
        "Second simulation": f"<p>Drops of tests/campaign, another author's equations and integration.</p>{scored(second)}"
        "<p>As measured before, with damages:</p>" + written(Path("docs/measured/second-simulation.md").read_text()),
        "Readers": f"<p>The tests of the readers, with files that other programs wrote (fixtures/README.md), damaged and "
        f"cut ones.</p><pre>{html.escape(readers)}</pre>{written(Path('docs/measured/fuzzing.md').read_text())}",
        "Published results": written(Path("docs/paper.md").read_text()),
        "Not in this report": "<p>Tests on a real target: by the site, with <code>dropcheck validate --reference</code>.</p>",
    }
    body = "".join(f"<h1>{name}</h1>{text}" for name, text in chapters.items())
    print(f'<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>dropcheck: verification and validation</title>'
          f"<style>{STYLE}</style><p><b>dropcheck: verification and validation</b></p><table>{rows}</table>"
          f"<pre>{html.escape(verdict)}</pre>{body}</html>")


main(*sys.argv[1:])
