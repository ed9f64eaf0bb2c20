"""Open a report in a real browser and hold it to what a page has to do.

    python3 tests/browser/page.py report.html

Needs Chromium with its driver, pdftotext, and selenium and axe-core-python from PyPI. Prints one line a check; the
first that fails ends it with status 1.
"""

import base64
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

from axe_core_python.selenium import Axe
from selenium import webdriver
from selenium.webdriver import ActionChains, Keys
from selenium.webdriver.common.by import By


def browser():
    options = webdriver.ChromeOptions()
    for word in ["--headless=new", "--no-sandbox", "--window-size=1280,900"]:
        options.add_argument(word)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    # The driver that is installed: none is fetched.
    service = webdriver.ChromeService(executable_path=shutil.which("chromedriver"))
    return webdriver.Chrome(options=options, service=service)


def held(what, is_so, found=""):
    print(f"{'ok' if is_so else 'FAILED'}: {what} {found}")
    if not is_so:
        sys.exit(1)


def scale(driver, chart):
    return driver.execute_script("const {min, max} = arguments[0].chart.scales.x; return [min, max]", chart)


def sheets_of(driver):
    """The page on A4: the lines of each sheet that has some."""
    pdf = driver.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True, "printBackground": True})["data"]
    command = ["pdftotext", "-layout", "-", "-"]
    text = subprocess.run(command, input=base64.b64decode(pdf), capture_output=True, check=True).stdout.decode()
    sheets = [[line.strip() for line in sheet.splitlines() if line.strip()] for sheet in text.split("\f")]
    return [sheet for sheet in sheets if sheet]


def printed(driver):
    """The page on A4: so many sheets, none that ends with a heading or a caption whose rows stand on the next."""
    heads = driver.execute_script("return [...document.querySelectorAll('h2, caption')].map((e) => e.textContent)")
    sheets = sheets_of(driver)
    feet = [sheet.pop() for sheet in sheets]
    held("every sheet has its number", all(re.search(rf"\s{i} ?/ ?{len(feet)}$", f) for i, f in enumerate(feet, 1)), feet[0])
    held("so many sheets of A4", 4 <= len(sheets) <= 14, len(sheets))
    heads = [" ".join(head.split()) for head in heads]
    ends = [" ".join(sheet[-1].split()) for sheet in sheets]
    held("no heading at the foot of a sheet", not [e for e in ends if any(e and h.endswith(e) for h in heads)], ends)


def fits_small_screens(driver):
    """Nothing of the page is wider than a phone or a tablet."""
    for size in (375, 768):
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                               {"width": size, "height": 800, "deviceScaleFactor": 1, "mobile": True})
        time.sleep(0.3)
        wide = driver.execute_script("return document.documentElement.scrollWidth")
        held(f"nothing wider than {size} px", wide <= size, wide)


def opened(page):
    """The page in a browser, where nothing went wrong and nothing was asked for."""
    driver = browser()
    driver.get(page.resolve().as_uri())
    time.sleep(0.5)
    held("no error on the console", not driver.get_log("browser"))
    held("no request", driver.execute_script("return performance.getEntriesByType('resource').length") == 0)
    return driver


def main(page):
    driver = opened(page)
    charts = driver.find_elements(By.CSS_SELECTOR, ".uplot")
    held("charts", len(charts) >= 8, len(charts))

    chart = charts[0]
    over = chart.find_element(By.CSS_SELECTOR, ".u-over")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", chart)
    whole = scale(driver, chart)
    width = over.size["width"]
    ActionChains(driver).move_to_element_with_offset(over, -width // 4, 0).click_and_hold().move_by_offset(
        width // 2, 0).release().perform()
    time.sleep(0.2)
    low, high = scale(driver, chart)
    held("a drag zooms to half", abs((high - low) / (whole[1] - whole[0]) - 0.5) < 0.05, f"{low:.1f} {high:.1f}")
    legend = chart.find_element(By.CSS_SELECTOR, ".u-legend").text
    held("the cursor reads values", re.search(r"A1 filtered\s*[-−]?\d", legend), legend.replace("\n", " "))
    figure = chart.find_element(By.XPATH, "ancestor::figure")
    figure.find_element(By.XPATH, ".//button[.='Copy as CSV']").click()
    times = [1e3 * float(row.split(",")[0]) for row in (page.parent / "curves.csv").read_text().splitlines()[1:]]
    rows, said = sum(low <= time <= high for time in times), figure.find_element(By.CSS_SELECTOR, "[role=status]").text
    held("every sample that is seen is copied, and that is said", said == f"Copied {rows} rows", said)
    chart.send_keys("0")
    held("0 shows the whole", scale(driver, chart) == whole)
    chart.send_keys("+")
    near = scale(driver, chart)
    held("plus zooms", near[1] - near[0] < 0.7 * (whole[1] - whole[0]))
    chart.send_keys(Keys.ARROW_RIGHT)
    held("an arrow pans", scale(driver, chart)[0] > near[0])

    def words():
        return chart.find_element(By.CSS_SELECTOR, ".u-legend").text

    before = words()
    chart.send_keys(Keys.SHIFT + Keys.ARROW_RIGHT + Keys.ARROW_RIGHT)
    held("a key moves the cursor", words() != before, words().replace("\n", " "))

    axe = Axe().run(driver, options={"runOnly": ["color-contrast"]})
    held("contrast of WCAG AA", not axe["violations"], [n["html"] for v in axe["violations"] for n in v["nodes"]][:3])

    for size in (375, 768, 900):
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                               {"width": size, "height": 800, "deviceScaleFactor": 1, "mobile": True})
        time.sleep(0.3)
        wide = driver.execute_script("return document.documentElement.scrollWidth")
        held(f"nothing wider than {size} px", wide <= size, wide)
    driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "dark"}]})
    axe = Axe().run(driver, options={"runOnly": ["color-contrast"]})
    held("contrast in the dark", not axe["violations"], [n["html"] for v in axe["violations"] for n in v["nodes"]][:3])
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
    printed(driver)
    driver.quit()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
