"""Open the first look at a recording in a real browser: its charts, its words, its drawings on paper.

    python3 tests/browser/recording.py recording.html

Needs Chromium with its driver, and selenium and axe-core-python from PyPI. Prints one line a check; the first that
fails ends it with status 1.
"""

import json
import sys
from pathlib import Path

from axe_core_python.selenium import Axe
from page import fits_small_screens, held, opened, scale
from selenium.webdriver.common.by import By


def main(page):
    driver = opened(page)
    sources = json.loads((page.parent / "recording.json").read_text())["channels"]
    charts = driver.find_elements(By.CSS_SELECTOR, ".uplot")
    held("a chart a source", len(charts) == len(sources), len(charts))
    chart = charts[0]
    whole = scale(driver, chart)
    chart.send_keys("+")
    near = scale(driver, chart)
    held("plus zooms", near[1] - near[0] < 0.7 * (whole[1] - whole[0]))
    chart.send_keys("0")
    figure = chart.find_element(By.XPATH, "ancestor::figure")
    held("it says that every sample is there", "every sample" in figure.text)
    figure.find_element(By.XPATH, ".//button[.='Copy as CSV']").click()
    said = figure.find_element(By.CSS_SELECTOR, "[role=status]").text
    held("every sample is copied", said == f"Copied {sources[0]['samples']} rows", said)
    link = driver.find_element(By.CSS_SELECTOR, "th a[href^='#source-']")
    place = link.get_attribute("href").split("#")[1]
    held("a row leads to its curve", driver.find_elements(By.ID, place), place)
    for scheme in ("light", "dark"):
        feature = {"name": "prefers-color-scheme", "value": scheme}
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [feature]})
        axe = Axe().run(driver, options={"runOnly": ["color-contrast"]})
        held(f"contrast in the {scheme}", not axe["violations"], [v["id"] for v in axe["violations"]])
    fits_small_screens(driver)
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    shown = [e.is_displayed() for e in driver.find_elements(By.CSS_SELECTOR, "figure > svg")]
    held("paper has the drawings", all(shown) and not chart.is_displayed(), len(shown))
    driver.quit()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
