"""Open the page to sign of a checked set-up in a real browser: its words, its width, one sheet of paper.

    python3 tests/browser/check.py check.html

Needs Chromium with its driver, pdftotext, and selenium and axe-core-python from PyPI. Prints one line a check; the
first that fails ends it with status 1.
"""

import sys
from pathlib import Path

from axe_core_python.selenium import Axe
from page import fits_small_screens, held, opened, sheets_of
from selenium.webdriver.common.by import By


def main(page):
    driver = opened(page)
    rows = driver.find_elements(By.CSS_SELECTOR, "table:first-of-type tbody tr")
    held("a line a channel", len(rows) >= 8, len(rows))
    for scheme in ("light", "dark"):
        feature = {"name": "prefers-color-scheme", "value": scheme}
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [feature]})
        axe = Axe().run(driver)
        held(f"accessible in the {scheme}", not axe["violations"], [v["id"] for v in axe["violations"]])
    fits_small_screens(driver)
    sheets = sheets_of(driver)
    held("one sheet of A4", len(sheets) == 1, len(sheets))
    driver.quit()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
