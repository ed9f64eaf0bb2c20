"""Open the page of a campaign in a real browser: sort its table, filter it, compare two of its drops.

    python3 tests/browser/campaign.py campaign.html

Needs Chromium with its driver, and selenium from PyPI. Prints one line a check; the first that fails ends it with status 1.
"""

import sys
import time
from pathlib import Path

from page import fits_small_screens, held, opened
from selenium.webdriver.common.by import By


def main(page):
    driver = opened(page)
    table = driver.find_element(By.CSS_SELECTOR, "table.sortable")
    heads = [head.text for head in table.find_elements(By.CSS_SELECTOR, "thead th")]
    column = next(i for i, head in enumerate(heads) if head.startswith("speed"))

    def cells():
        rows = table.find_elements(By.CSS_SELECTOR, "tbody tr")
        return [row.find_elements(By.CSS_SELECTOR, "th, td")[column].text for row in rows if row.is_displayed()]

    def numbers():
        return [float(text.split(" ")[0]) for text in cells() if text != "–"]

    button = table.find_elements(By.CSS_SELECTOR, "thead button")[column]
    button.click()
    up = numbers()
    held("a head sorts its column up", up == sorted(up) and ("–" not in cells() or cells()[-1] == "–"), up[:3])
    button.click()
    held("and down", numbers() == sorted(up, reverse=True))
    box = driver.find_element(By.CSS_SELECTOR, ".filter input")
    box.send_keys("sound")
    held("words filter rows", 0 < len(cells()) <= len(up), len(cells()))
    picks = [p for p in table.find_elements(By.CSS_SELECTOR, ".pick input") if p.is_displayed()]
    picks[0].click()
    picks[-1].click()
    time.sleep(0.2)
    compared = driver.find_element(By.CSS_SELECTOR, ".compared caption")
    held("two ticked drops are compared", "E_n" in compared.text, compared.text[:40])
    top = driver.execute_script("return document.querySelector('.compared').getBoundingClientRect().top")
    held("in view", 0 <= top < driver.execute_script("return innerHeight") / 2, top)
    curves = driver.find_elements(By.CSS_SELECTOR, ".compared svg path")
    held("their curves over one another", len(curves) == 4 and all(c.get_attribute("d") for c in curves), len(curves))
    rows = driver.find_elements(By.CSS_SELECTOR, ".compared tbody tr")
    held("quantity by quantity", rows[0].text.startswith("slap-down speed"), rows[0].text)
    fits_small_screens(driver)
    driver.quit()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
