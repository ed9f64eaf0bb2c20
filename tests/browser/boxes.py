"""Hold the words of reports to their places: none over another one in a picture, none cut, none wider than its box.

    python3 tests/browser/boxes.py report.html…

Needs Chromium alone. Every page is laid out at 375, 768 and 1440 px with its drawings, which are those of the print.
Prints one line a page and width; words at fault end it with status 1.
"""

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

WIDTHS = (375, 768, 1440)

# In the page: the drawings in place of the charts, then the boxes of all words.
PROBE = """
addEventListener("load", () => setTimeout(() => {
  const found = [];
  for (const figure of document.querySelectorAll("figure")) figure.classList.remove("is-live");
  for (const svg of document.querySelectorAll("figure > svg")) {
    const frame = svg.getBoundingClientRect(), unit = frame.width / svg.viewBox.baseVal.width;
    const words = [...svg.querySelectorAll("text")].filter((t) => t.textContent.trim());
    const boxes = words.map((t) => ({ t: t.textContent, r: t.getBoundingClientRect() }));
    const where = svg.closest("figure").id;
    boxes.forEach(({ t, r }, i) => {
      const over = Math.max(frame.left - r.left, r.right - frame.right, frame.top - r.top, r.bottom - frame.bottom);
      if (over > 4 * unit) found.push(`${where}: "${t}" is cut`);
      for (const other of boxes.slice(i + 1)) {
        const x = Math.min(r.right, other.r.right) - Math.max(r.left, other.r.left);
        const y = Math.min(r.bottom, other.r.bottom) - Math.max(r.top, other.r.top);
        if (x > 4 * unit && y > 6 * unit) found.push(`${where}: "${t}" over "${other.t}"`);
      }
    });
  }
  for (const box of document.querySelectorAll("p, td, th, dt, dd, li, figcaption, caption, .banner, h1, h2"))
    if (box.clientWidth && box.scrollWidth > box.clientWidth + 1)
      found.push(`${box.tagName}: "${box.textContent.trim().slice(0, 60)}" is wider than its box`);
  if (document.documentElement.scrollWidth > innerWidth + 1) found.push("the page is wider than its window");
  parent.postMessage(JSON.stringify(found), "*");
}, 300));
"""

FRAME = """<iframe src="%s" style="width:%dpx;height:9000px;border:0"></iframe><pre></pre>
<script>addEventListener("message", (e) => { document.querySelector("pre").textContent = e.data; });</script>"""


def at_fault(page, width, folder):
    """What is wrong with the words of a page of this width."""
    text = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", page.read_text())
    (folder / "page.html").write_text(text.replace("</head>", f"<script>{PROBE}</script></head>", 1))
    (folder / "frame.html").write_text(FRAME % ("page.html", width))
    command = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder}/profile",
               "--virtual-time-budget=8000", f"--window-size={width + 20},9100", "--dump-dom",
               (folder / "frame.html").as_uri()]
    shown = subprocess.run(command, capture_output=True, check=True, timeout=120).stdout.decode()
    answer = re.search(r"<pre>(.*)</pre>", shown, re.S).group(1)
    if not answer:
        sys.exit(f"{page}: the page did not answer")
    entities = {"&lt;": "<", "&gt;": ">", "&amp;": "&"}
    return json.loads(re.sub("&(lt|gt|amp);", lambda m: entities[m.group()], answer))


def main(pages):
    wrong = 0
    with tempfile.TemporaryDirectory(prefix="dropcheck-boxes-") as folder:
        for page in pages:
            for width in WIDTHS:
                found = at_fault(page, width, Path(folder))
                print(f"{page}, {width} px: {'ok' if not found else f'{len(found)} at fault'}")
                for words in found[:20]:
                    print(f"  {words}")
                wrong += len(found)
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main([Path(word).resolve() for word in sys.argv[1:]])
