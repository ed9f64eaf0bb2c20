"""Open the page that analyses recordings in a real browser, and hold it to the command.

    python3 tests/browser/dropcheck_page.py dropcheck.html COMMAND [--short | --browser firefox|webkit]

COMMAND is the dropcheck of the same source; --short compares one recording a format. Needs Chromium with its driver,
and selenium and axe-core-python from PyPI. Prints one line a check; the first that fails ends it with status 1.
In another browser one drop is analysed by hand, and the numbers are compared: Firefox with geckodriver (`cargo install
geckodriver`), or WebKit, Safari's engine, with WebKitWebDriver and MiniBrowser (webkit2gtk-driver, by `xvfb-run`).
"""

import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

from axe_core_python.selenium import Axe
from page import held, opened
from selenium import webdriver
from selenium.webdriver import ActionChains, Keys
from selenium.webdriver.common.by import By

EXAMPLES = Path(__file__).parents[2] / "fixtures/examples"
SHORT = ["anf18-json", "anf10-plain", "vhlw-rest"]
# When, where, by which words and by what the recording was read; a page has other ones.
OF_THE_CALL = {"program", "command", "analysed", "cask", "version", "recording", "read with", "reader"}
# What has no interval of its own, and what is zero but for the last digits.
RELATIVE, ABSOLUTE = 1e-6, 1e-12

ASKED = """
const [method, bytes, name, cask, done] = arguments;
const plain = Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0));
const refused = (refusal) => done({refusal: refusal.message});
window.dropcheck[method](plain, name, cask).then((json) => done({json}), refused);
"""

DROPPED = """
const plain = Uint8Array.from(atob(arguments[0]), (c) => c.charCodeAt(0));
const dataTransfer = new DataTransfer();
dataTransfer.items.add(new File([plain], arguments[1]));
document.getElementById("drop").dispatchEvent(new DragEvent("drop", { bubbles: true, dataTransfer }));
"""


def asked(driver, method, recording, cask=None):
    """What the page answers to a program: its JSON, or the words of its refusal."""
    data = base64.b64encode(recording.read_bytes()).decode()
    return driver.execute_async_script(ASKED, method, data, recording.name, cask and cask.read_text())


def said(command, method, recording, *words):
    """What the command answers: its JSON, or the words of its refusal."""
    call = [command, method, recording.name, *words, "--json", "-"]
    done = subprocess.run(call, cwd=recording.parent, capture_output=True, text=True, check=False)
    return {"json": json.loads(done.stdout)} if done.stdout else {"refusal": done.stderr}


def differences(one, other, path="", u95=0.0):
    """Where two answers differ by more than a thousandth of the half-width."""
    if path.rsplit(".", 1)[-1] in OF_THE_CALL:
        return []
    if isinstance(one, dict) and isinstance(other, dict):
        half = one.get("u95") if isinstance(one.get("u95"), float) else 0.0
        keys = {**one, **other}
        return [d for k in keys for d in differences(one.get(k), other.get(k), f"{path}.{k}", half)]
    if isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        return [d for i, (a, b) in enumerate(zip(one, other)) for d in differences(a, b, f"{path}[{i}]", u95)]
    try:
        gap, size = abs(float(one) - float(other)), max(abs(float(one)), abs(float(other)))
        is_near = gap <= max(1e-3 * u95, RELATIVE * size, ABSOLUTE)
    except (TypeError, ValueError):
        is_near = one == other
    return [] if is_near else [f"{path}: {one} {other} (u95 {u95})"[:300]]


def as_iso_mme(folder):
    """The drop of `anf10-plain.csv` in ISO-MME as a zip, with its cask file."""
    rows = [line.split(",") for line in (EXAMPLES / "anf10-plain.csv").read_text().splitlines()[1:]]
    cask, index = (EXAMPLES / "anf10-plain.toml").read_text(), "Number of channels :2\n"
    with ZipFile(folder / "T1.zip", "w", ZIP_DEFLATED) as files:
        files.writestr("T1.mme", "Data format edition number :1.6\n")
        for number, code in enumerate(["T0CASK00L100ACZ0", "T0CASK00R100ACZ0"], 1):
            head = {"Channel code": code, "Unit": "g", "Sampling interval": 0.00008, "Time of first sample": 0,
                    "Number of samples": len(rows)}
            lines = [f"{name} :{value}" for name, value in head.items()] + [row[number] for row in rows]
            files.writestr(f"Channel/T1.{number:03}", "\n".join(lines) + "\n")
            index += f"Name of channel {number:03} :{code}\n"
            cask = cask.replace(f'source = "A{number}"', f'source = "{code}"')
        files.writestr("Channel/T1.chn", index)
    (folder / "T1.toml").write_text(cask)
    return folder / "T1.zip", folder / "T1.toml"


def equal(driver, command, is_short):
    """Every example, and one as ISO-MME, to the command's numbers."""
    casks = [c for c in sorted(EXAMPLES.glob("*.toml")) if not is_short or c.stem in SHORT]
    examples = [(r, cask) for cask in casks for r in EXAMPLES.glob(f"{cask.stem}.*") if r != cask]
    with tempfile.TemporaryDirectory() as name:
        for recording, cask in [*examples, as_iso_mme(Path(name))]:
            pairs = {"inspect": (asked(driver, "inspect", recording), said(command, "inspect", recording)),
                     "analyze": (asked(driver, "analyze", recording, cask),
                                 said(command, "analyze", recording, "--cask", cask.name))}
            for what, (page, here) in pairs.items():
                found = differences(here, page)
                held(f"{what} of {recording.name} as the command", "json" in page and not found, found[:9])


def value(driver, path):
    # In one step: the form may be drawn anew at any time.
    return driver.execute_script("return document.getElementById(arguments[0])?.value", f"field-{path}")


def told(driver, place):
    return driver.find_element(By.ID, place).text


def chosen(driver, recording):
    file = driver.find_element(By.ID, "file")
    driver.execute_script("arguments[0].value = ''", file)
    file.send_keys(str(recording))


def soon(what, is_so):
    """Holds a check as soon as it holds, after a minute at the latest: the machine may be at other work."""
    end = time.time() + 60
    while not is_so() and time.time() < end:
        time.sleep(0.1)
    held(what, bool(is_so()))


def typed(driver, text):
    """Types where the cursor stands."""
    ActionChains(driver).send_keys(text).perform()


def to(driver, place):
    """Goes to an element by the key Tab alone; whether it came there."""
    for _ in range(200):
        if driver.execute_script("return document.activeElement.id") == place:
            return
        typed(driver, Keys.TAB)
    held(f"the key Tab leads to {place}", False)


def by_hand(form):
    """The form of `init` as a hand would fill it in."""
    for old, new in [('# name = "CASK" ', 'name = "ANF-18" '), ("mass_kg = nan", "mass_kg = 4466"),
                     ("length_m = nan", "length_m = 5.512"), ("height_m = nan", "height_m = 0.792"),
                     ("height_m = nan", "height_m = 9"),
                     ("angle_deg = nan", "angle_deg = 15"), ('end = "FILL IN"', 'end = "first"'),
                     ('axis = "FILL IN"', 'axis = "transverse"'), ("position_m = nan", "position_m = 0.15"),
                     ('end = "FILL IN"', 'end = "second"'), ('axis = "FILL IN"', 'axis = "transverse"'),
                     ("position_m = nan", "position_m = 5.362")]:
        before, behind = form.split(old, 1)
        form = before + new + behind
    return form


def filled_in(driver, command, folder):
    """A recording to its cask file by keys alone, with decimal commas; equal to `init` and a hand."""
    chosen(driver, EXAMPLES / "anf18-json.mcap")
    soon("the channels are listed", lambda: "/daq/a2.samples" in told(driver, "listing"))
    soon("the form asks for what only a person knows", lambda: told(driver, "form-word").startswith("11 fields"))
    answers = {"cask.name": "ANF-18", "cask.mass_kg": "4466", "cask.length_m": "5,512",
               "cask.height_m": "0,792", "drop.height_m": "9",
               "drop.angle_deg": "15", "channel.0.end": "f", "channel.0.axis": "t", "channel.0.position_m": "0,15",
               "channel.1.end": "s", "channel.1.axis": "t", "channel.1.position_m": "5,362"}
    for path, text in answers.items():
        to(driver, f"field-{path}")
        typed(driver, text)
    typed(driver, Keys.TAB)
    soon("nothing is missing", lambda: told(driver, "form-word") == "Nothing is missing.")
    sentence = "Predicted slap-down speed at 15°: "
    soon("a prediction in a sentence", lambda: told(driver, "prediction").startswith(sentence))
    to(driver, "save-cask")
    typed(driver, Keys.ENTER)
    soon("the cask file is saved", (folder / "cask.toml").exists)
    saved = (folder / "cask.toml").read_text()
    words = [command, "predict", "--cask", folder / "cask.toml", "--json", "-"]
    said = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    least, most = json.loads(said)["advice"]["own_range_m_s"]
    held("the prediction is the command's", f" {least:.2f} to {most:.2f} m/s" in told(driver, "prediction"))
    init = [command, "init", "anf18-json.mcap"]
    hand = by_hand(subprocess.run(init, cwd=EXAMPLES, capture_output=True, text=True, check=True).stdout)
    held("the file is the one of init and a hand", saved == hand,
         [pair for pair in zip(saved.splitlines(), hand.splitlines()) if pair[0] != pair[1]][:3])


def analysed(driver, folder):
    """The report, to see and to save."""
    to(driver, "analyse")
    typed(driver, Keys.ENTER)
    soon("the report is there", driver.find_element(By.ID, "save-report").is_displayed)
    held("no refusal", not told(driver, "analysis-refusal"))
    driver.switch_to.frame("report-frame")
    soon("with its curves", lambda: len(driver.find_elements(By.CSS_SELECTOR, ".uplot")) >= 8)
    words = driver.find_element(By.TAG_NAME, "body").text
    held("and its verdict", "DATA SOUND" in words and "20.63 ± 0.44 m/s" in words, words[:60])
    driver.switch_to.default_content()
    saved = folder / "anf18-json-report.html"
    driver.find_element(By.ID, "save-report").click()
    soon("it is saved", saved.exists)
    held("as it is", "<title>ANF-18: slap-down drop test" in saved.read_text())


def moved(driver):
    """A sensor is moved along the cask by the pointer, and by keys."""
    handle = driver.find_element(By.CSS_SELECTOR, ".handle[data-channel='0']")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", handle)
    ActionChains(driver).click_and_hold(handle).move_by_offset(60, -16).release().perform()

    def is_at(place):
        text = f"position_m = {place:g}"
        return text in driver.find_element(By.ID, "text").get_attribute("value")

    place = float(value(driver, "channel.0.position_m").replace(",", "."))
    held("a drag moves a sensor", 0.4 < place < 1.2, place)
    soon("in the text too", lambda: is_at(place))
    typed(driver, Keys.ARROW_LEFT)
    soon("an arrow by a step", lambda: is_at(place - 0.01))


def refused(driver):
    """What is wrong stands under its field."""
    field = driver.find_element(By.ID, "field-cask.length_m")
    wrong = {"5512": "5512 mm are 5.512", "5,5 m": "without a unit", "1.234,5": "more than one decimal"}
    for text, word in wrong.items():
        field.clear()
        field.send_keys(text, Keys.TAB)
        soon(f"{text} is refused under its field", lambda word=word: word in told(driver, "field-cask.length_m-error"))
    field.clear()
    field.send_keys("5,512", Keys.TAB)
    soon("and taken when it is right", lambda: not told(driver, "field-cask.length_m-error"))


def text_of(driver):
    return driver.find_element(By.ID, "text").get_attribute("value")


def laid_on(driver):
    """A sensor without a place is laid on an end, and so is of it; its axis is asked for."""
    whole = text_of(driver)
    driver.find_element(By.CSS_SELECTOR, "#form > p > button").click()
    soon("a new sensor waits beside the cask", lambda: driver.find_elements(By.CSS_SELECTOR, "[data-channel='2']"))
    sensor = driver.find_element(By.CSS_SELECTOR, "[data-channel='2'] circle")
    end = driver.find_element(By.CSS_SELECTOR, "[data-channel='1'] circle")
    driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", sensor)
    ActionChains(driver).click_and_hold(sensor).move_to_element(end).release().perform()
    soon("it is of the second end", lambda: value(driver, "channel.2.end") == "second")
    soon("its axis is still asked for", lambda: told(driver, "form-word").startswith("3 fields"))
    driver.find_element(By.ID, "field-channel.2.axis").send_keys("r")
    soon("a rate sensor has no place", lambda: not value(driver, "channel.2.position_m"))
    soon("and is asked for none", lambda: told(driver, "form-word").startswith("2 fields"))
    driver.find_element(By.ID, "remove-2").click()
    soon("it goes without a trace", lambda: text_of(driver).strip() == whole.strip())


def changed_besides(driver, folder):
    """A channel more and less, the text by hand, the report on paper, a recording that is too large."""
    whole = text_of(driver)
    driver.find_element(By.CSS_SELECTOR, "#form > p > button").click()
    soon("the report is of another form", lambda: "changed after this report" in told(driver, "stale"))
    soon("a channel more asks for itself", lambda: told(driver, "form-word").startswith("5 fields"))
    driver.find_element(By.ID, "remove-2").click()
    soon("and goes without a trace", lambda: text_of(driver).strip() == whole.strip())
    driver.find_element(By.ID, "remove-1").click()
    soon("a channel less", lambda: text_of(driver) == whole[:whole.rindex("[[channel]]")])
    driver.execute_script("document.getElementById('as-text').open = true")
    box = driver.find_element(By.ID, "text")
    box.send_keys(Keys.CONTROL, Keys.END)
    box.send_keys("[[channel")
    soon("broken text is refused above the form", lambda: "cask.toml, line" in told(driver, "form-refusal"))
    put = "arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('input'))"
    driver.execute_script(put, box, whole)
    soon("mended text is in the form", lambda: value(driver, "channel.1.source") == "/daq/a2.samples")
    held("and nothing is refused", not told(driver, "form-refusal"), told(driver, "form-refusal"))
    frame = "document.getElementById('report-frame').contentWindow"
    driver.execute_script(f"{frame}.print = () => {{ window.isPrinted = 1; }}")
    driver.find_element(By.ID, "print").click()
    held("the report is printed", driver.execute_script("return window.isPrinted") == 1)
    large = folder / "large.csv"
    with large.open("wb") as file:
        file.truncate(1_200_000_000)
    chosen(driver, large)
    soon("a recording too large is refused unread", lambda: "1.2 GB are more" in told(driver, "recording-refusal"))
    data = base64.b64encode((EXAMPLES / "anf18-json.mcap").read_bytes()).decode()
    driver.execute_script(DROPPED, data, "anf18-json.mcap")
    soon("the next one, dropped on the page, is read", lambda: "/daq/a2.samples" in told(driver, "listing"))
    held("and the cask file is kept", text_of(driver) == whole)


def refused_later(driver):
    """What the recording speaks against stands under the field of its channel."""
    field = driver.find_element(By.ID, "field-channel.1.source")
    field.clear()
    field.send_keys("/daq/a7.samples", Keys.TAB)
    driver.find_element(By.ID, "analyse").click()
    soon("a source that is not there is refused under its field",
         lambda: "/daq/a7.samples" in told(driver, "field-channel.1.source-error"))
    held("the cursor stands there",
         driver.execute_script("return document.activeElement.id") == "field-channel.1.source")


def seen(driver):
    """Accessible, in the light and in the dark, and no wider than its screen."""
    driver.execute_script("document.querySelectorAll('details').forEach((details) => { details.open = true; })")
    for scheme in ("light", "dark"):
        feature = {"name": "prefers-color-scheme", "value": scheme}
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [feature]})
        axe = Axe().run(driver, options="{iframes: false}")
        found = [(v["id"], [n["html"][:120] for n in v["nodes"]][:2]) for v in axe["violations"]]
        held(f"axe finds nothing in the {scheme}", not found, found)
    for size in (375, 768, 1440):
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                               {"width": size, "height": 800, "deviceScaleFactor": 1, "mobile": size < 400})
        time.sleep(0.5)
        wide = driver.execute_script("return document.documentElement.scrollWidth")
        held(f"nothing wider than {size} px", wide <= size, wide)
    driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def in_german(driver, page):
    """A browser that speaks German shows numbers with a comma, and takes a point too."""
    agent = driver.execute_script("return navigator.userAgent")
    driver.execute_cdp_cmd("Emulation.setUserAgentOverride", {"userAgent": agent, "acceptLanguage": "de-DE"})
    driver.get(page.resolve().as_uri())
    driver.find_element(By.ID, "cask").send_keys(str(EXAMPLES / "anf18-json.toml"))
    soon("a German browser shows a comma", lambda: value(driver, "cask.length_m") == "5,512")
    field = driver.find_element(By.ID, "field-cask.length_m")
    field.clear()
    field.send_keys("5.6", Keys.TAB)
    soon("and takes a point", lambda: "length_m = 5.6\n" in text_of(driver))
    held("which it shows as a comma", value(driver, "cask.length_m") == "5,6", value(driver, "cask.length_m"))
    for path in ("cask.mass_kg", "drop.height_m", "cask.name"):
        driver.find_element(By.ID, f"field-{path}").clear()
    soon("mass and height may go", lambda: told(driver, "form-word").startswith("2 fields"))
    soon("the drawing needs none", lambda: driver.find_elements(By.CSS_SELECTOR, "#drawing polygon"))


def closed(driver):
    """A page that can ask for nothing."""
    held("no request is allowed", driver.execute_async_script(
        "fetch('https://example.org').then(() => arguments[0](false), () => arguments[0](true))"))
    policy = driver.find_element(By.CSS_SELECTOR, "meta[http-equiv]").get_attribute("content")
    held("by its policy", "default-src 'none'" in policy and "connect-src 'none'" in policy, policy)
    log = [line["message"] for line in driver.get_log("browser")]
    held("the policy refused it", any("Content Security Policy" in line for line in log))


def of_name(name):
    """Another browser than Chromium, by the driver that is installed."""
    if name == "firefox":
        options = webdriver.FirefoxOptions()
        options.add_argument("-headless")
        return webdriver.Firefox(options, webdriver.FirefoxService(shutil.which("geckodriver")))
    options = webdriver.WebKitGTKOptions()
    options.binary_location = str(next(Path("/usr/lib").glob("*/webkit2gtk-*/MiniBrowser")))
    options.add_argument("--automation")
    # It takes the language C for a word that no number is written by.
    service = webdriver.WebKitGTKService(shutil.which("WebKitWebDriver"), env={**os.environ, "LANG": "en_US.UTF-8"})
    return webdriver.WebKitGTK(options, service)


def elsewhere(page, command, name):
    """One drop by hand in another browser, and the numbers of one recording a format."""
    driver = of_name(name)
    print(name, driver.capabilities.get("browserVersion"))
    driver.set_script_timeout(120)
    driver.get(page.resolve().as_uri())
    soon("the page begins", lambda: told(driver, "form-word").startswith("5 fields"))
    driver.find_element(By.ID, "cask").send_keys(str(EXAMPLES / "anf18-json.toml"))
    soon("the cask file is in the form", lambda: value(driver, "drop.angle_deg") == "15")
    chosen(driver, EXAMPLES / "anf18-json.mcap")
    soon("the channels are listed", lambda: "/daq/a2.samples" in told(driver, "listing"))
    driver.find_element(By.ID, "analyse").click()
    soon("the report is there", driver.find_element(By.ID, "save-report").is_displayed)
    driver.switch_to.frame("report-frame")
    soon("with its curves", lambda: len(driver.find_elements(By.CSS_SELECTOR, ".uplot")) >= 8)
    words = driver.find_element(By.TAG_NAME, "body").text
    held("and its verdict", "DATA SOUND" in words and "20.59 ± 0.37 m/s" in words, words[:60])
    driver.switch_to.default_content()
    equal(driver, command, is_short=True)
    driver.quit()


def main(page, command, is_short):
    driver = opened(page)
    driver.set_script_timeout(120)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        driver.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": name})
        filled_in(driver, command, folder)
        analysed(driver, folder)
        moved(driver)
        laid_on(driver)
        refused(driver)
        seen(driver)
        changed_besides(driver, folder)
    refused_later(driver)
    equal(driver, command, is_short)
    held("no error on the console", not driver.get_log("browser"))
    asked_for = driver.execute_script("return performance.getEntriesByType('resource').map((entry) => entry.name)")
    held("no request", not [name for name in asked_for if not name.startswith("blob:")], asked_for)
    closed(driver)
    in_german(driver, page)
    driver.quit()


if __name__ == "__main__":
    if sys.argv[3:4] == ["--browser"]:
        elsewhere(Path(sys.argv[1]), Path(sys.argv[2]).resolve(), sys.argv[4])
    else:
        main(Path(sys.argv[1]), Path(sys.argv[2]).resolve(), "--short" in sys.argv[3:])
