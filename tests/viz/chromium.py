"""A headless Chromium, controlled over pipes by its DevTools protocol: open a page, run JavaScript, take pictures."""

import base64
import io
import json
import os
import subprocess
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np

FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--no-first-run",
    "--use-angle=swiftshader",  # draws without a graphics card
    "--enable-unsafe-swiftshader",
    "--disable-dev-shm-usage",
    "--disable-quic",
    "--disable-sync",
    "--disable-extensions",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-default-apps",
    "--host-resolver-rules=MAP * ~NOTFOUND",  # no page can reach a network
    "--window-size=1000,700",
    "--remote-debugging-pipe",
)


class Chromium:
    """One page in its own browser; leaving the context ends the browser.

    Attributes:
        problems: Errors and failed requests of the page so far.
    """

    def __init__(self, path: str, profile: Path) -> None:
        command_read, self._commands = os.pipe()
        self._replies, reply_write = os.pipe()
        redirect = f'exec "$0" "$@" 3<&{command_read} 4>&{reply_write}'  # the two numbers that Chromium expects
        self._process = subprocess.Popen(
            ["/bin/bash", "-c", redirect, path, *FLAGS, f"--user-data-dir={profile}", "about:blank"],
            pass_fds=(command_read, reply_write),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(command_read)
        os.close(reply_write)
        self.problems: list[str] = []
        self._unread = b""
        self._number = 0
        self._session: str | None = None
        self._session = self._attach()

    def _attach(self) -> str:
        targets = self._call("Target.getTargets")["targetInfos"]
        page = next(target["targetId"] for target in targets if target["type"] == "page")
        return str(self._call("Target.attachToTarget", targetId=page, flatten=True)["sessionId"])

    def __enter__(self) -> "Chromium":
        return self

    def __exit__(self, *_: object) -> None:
        self._process.terminate()
        self._process.wait()
        os.close(self._commands)
        os.close(self._replies)

    def open(self, url: str) -> None:
        """Go to a page, and record its problems from now on."""
        for domain in ("Page", "Runtime", "Log"):
            self._call(f"{domain}.enable")
        self._call("Page.navigate", url=url)

    def run(self, script: str) -> Any:
        """Value of a JavaScript expression, awaited if it is a promise."""
        answer = self._call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(str(answer["exceptionDetails"]))
        return answer["result"].get("value")

    def wait_until(self, condition: str) -> None:
        """Wait until a JavaScript expression is true."""
        self.run(
            "new Promise((resolve, reject) => {"
            f"  const look = () => {{ if ({condition}) resolve(); else setTimeout(look, 20); }};"
            f"  setTimeout(() => reject({json.dumps('never: ' + condition)}), 60000); look(); }})"
        )

    def resize(self, width: int, height: int) -> None:
        """Show pages in a window of this size [pixels]."""
        self._call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def prefer(self, scheme: str) -> None:
        """Show pages in the preferred color scheme, light or dark."""
        self._call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])

    def click(self, x: float, y: float) -> None:
        """Click with the left mouse button [pixels]."""
        for kind in ("mousePressed", "mouseReleased"):
            self._call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def picture(self) -> np.ndarray:
        """Picture of the window, shape (height, width, 3), 0 to 1."""
        data = base64.b64decode(self._call("Page.captureScreenshot", format="png")["data"])
        return np.asarray(matplotlib.image.imread(io.BytesIO(data), format="png"))[..., :3]

    def _call(self, method: str, **parameters: Any) -> dict[str, Any]:
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._commands, json.dumps(message).encode() + b"\0")
        while (answer := self._read()).get("id") != self._number:
            self._note(answer)
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']['message']}")
        return dict(answer["result"])

    def _read(self) -> dict[str, Any]:
        while b"\0" not in self._unread:
            chunk = os.read(self._replies, 1 << 16)
            if not chunk:
                raise RuntimeError("Chromium has ended")
            self._unread += chunk
        text, _, self._unread = self._unread.partition(b"\0")
        return dict(json.loads(text))

    def _note(self, event: dict[str, Any]) -> None:
        if event["method"] == "Runtime.exceptionThrown":
            self.problems.append(str(event["params"]["exceptionDetails"]))
        elif event["method"] == "Log.entryAdded" and event["params"]["entry"]["level"] == "error":
            self.problems.append(str(event["params"]["entry"]))
        elif event["method"] == "Runtime.consoleAPICalled" and event["params"]["type"] == "error":
            self.problems.append(str(event["params"]["args"]))
