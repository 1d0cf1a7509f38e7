"""Chromium without a screen, for the pages that the program writes."""
import json
import pathlib
import shutil
import sys
import time

import consumers

ARGUMENTS = ("--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
             "--enable-unsafe-swiftshader", "--hide-scrollbars", "--force-device-scale-factor=1")
PATIENCE = 60.0  # seconds that a busy machine may take for a picture


def need_browser() -> None:
    """Goes on in a Python that can steer Chromium; ends with 77 where something is missing."""
    for program in ("chromium", "chromedriver"):
        if not shutil.which(program):
            print(f"skipped: there is no {program} (Debian: chromium chromium-driver)")
            sys.exit(77)
    consumers.use_debian_python("selenium")


class Browser:
    """A window of Chromium, to be used in `with`."""

    def __init__(self, *more: str):
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service
        options = webdriver.ChromeOptions()
        options.binary_location = shutil.which("chromium")
        for argument in (*ARGUMENTS, *more):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
        self.size(1000, 620)

    def __enter__(self) -> "Browser":
        return self

    def __exit__(self, *_) -> None:
        self.driver.quit()

    def size(self, width: int, height: int, phone: bool = False) -> None:
        """The size of what the page sees; of a phone with two pixels per pixel, and with fingers."""
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 2 if phone else 1, "mobile": phone})
        self.driver.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": phone})

    def open(self, page: pathlib.Path) -> None:
        self.driver.get(page.resolve().as_uri())

    def run(self, script: str, *arguments):
        return self.driver.execute_script(script, *arguments)

    def wait(self, script: str, what: str):
        """The value of a script once it is one."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            if value := self.run(script):
                return value
            time.sleep(0.05)
        raise AssertionError(f"{what} did not come; the browser says: {self.complaints()}")

    def complaints(self) -> list[str]:
        """What the console has as warnings and errors since the last time."""
        return [entry["message"] for entry in self.driver.get_log("browser")
                if entry["level"] in ("WARNING", "SEVERE")]

    def version(self) -> str:
        return "Chromium " + self.driver.capabilities["browserVersion"]


class View(Browser):
    """A page of --view."""

    def open(self, page: pathlib.Path) -> None:
        super().open(page)
        self.wait("return performance.getEntriesByName('drawn').length > 0", "the first picture")
        self.settle()

    def text(self, name: str) -> str:
        return self.run("return document.getElementById(arguments[0]).innerText", name)

    def settle(self) -> None:
        """Waits until two frames of the browser have passed."""
        self.driver.execute_async_script(
            "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 60)))")

    def set(self, name: str, value) -> None:
        """A control, as if it was used."""
        self.run("""const input = document.getElementById(arguments[0]);
            if (input.type === "checkbox") { if (input.checked !== arguments[1]) input.click(); return; }
            input.value = arguments[1];
            for (const kind of ["input", "change"]) input.dispatchEvent(new Event(kind, {bubbles: true}));""", name, value)
        self.settle()

    def hover(self, x: int, y: int) -> dict[str, str]:
        """What is read at a pixel of the window; empty: no surface is there."""
        from selenium.webdriver.common.actions.action_builder import ActionBuilder
        mouse = ActionBuilder(self.driver, duration=0)
        mouse.pointer_action.move_to_location(x, y)
        mouse.perform()
        self.settle()
        return self.readout()

    def readout(self) -> dict[str, str]:
        return dict(self.run("""return [...document.querySelectorAll("#readout dd")].map(
            (value) => [value.previousElementSibling.textContent, value.textContent])"""))

    def press(self, *keys: str) -> None:
        from selenium.webdriver.common.action_chains import ActionChains
        ActionChains(self.driver).send_keys(*keys).perform()
        self.settle()

    def click(self, x: int, y: int) -> None:
        from selenium.webdriver.common.actions.action_builder import ActionBuilder
        mouse = ActionBuilder(self.driver, duration=0)
        mouse.pointer_action.move_to_location(x, y).click()
        mouse.perform()
        self.settle()

    def drag(self, start: tuple[int, int], end: tuple[int, int]) -> None:
        from selenium.webdriver.common.actions.action_builder import ActionBuilder
        mouse = ActionBuilder(self.driver, duration=50)
        mouse.pointer_action.move_to_location(*start).pointer_down().move_to_location(*end).pointer_up()
        mouse.perform()
        self.settle()

    def scene(self) -> dict:
        return json.loads(self.run("return document.getElementById('scene').textContent"))

    def picture(self) -> bytes:
        """Of the window, as PNG: the same where no pixel changed."""
        return self.driver.get_screenshot_as_png()

    def pixels(self, folder: pathlib.Path) -> list:
        """Rows of (r, g, b)."""
        self.driver.save_screenshot(str(folder / "window.png"))
        return read_picture(folder / "window.png")


def read_picture(file: pathlib.Path) -> list:
    sys.path.insert(0, str(consumers.ROOT / "tests/support"))
    import images
    return images.read_png(file)
