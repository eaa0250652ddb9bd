"""A page in a real headless browser: a script runs in it, and sends its result back to a server of this process."""

from __future__ import annotations

import html
import json
import shutil
import subprocess
import tempfile
import threading
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from queue import Empty, Queue
from typing import Any

#: s that a script may take, on a machine with much else to do.
PATIENCE = 240
OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--hide-scrollbars",
    "--disable-dev-shm-usage",
    "--no-first-run",
)
_SCRIPT = """
<script>
(async () => {
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  const processorTime = async () => (await fetch("/processor-time", { method: "POST", body: "{}" })).json();
  const frame = () => new Promise((done) => requestAnimationFrame(done));
  let result;
  try { result = await (async () => { %s })(); } catch (error) { result = { failed: String(error.stack) }; }
  await fetch("/result", { method: "POST", body: JSON.stringify(result) });
})();
</script>
"""


def result_in_browser(page: str, script: str, size: tuple[int, int] = (1400, 1000)) -> Any:
    """What a script, the body of an async function, returns in the page; it may ``await wait(ms)``, ``frame()``
    and ``processorTime()``, ms of the browser.
    """
    content = page.replace("</body>", _SCRIPT.replace("%s", script) + "</body>").encode()
    results: Queue[Any] = Queue()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self._answer(content if self.path == "/" else b"")

        def do_POST(self) -> None:
            sent = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            if self.path == "/processor-time":
                self._answer(json.dumps(processor_time(browser.pid)).encode())
                return
            results.put(sent)
            self._answer(b"")

        def _answer(self, body: bytes) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html; charset=utf-8")
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: Any) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    profile = tempfile.mkdtemp()
    command = ["chromium", *OPTIONS, f"--window-size={size[0]},{size[1]}", f"--user-data-dir={profile}"]
    command += [f"http://127.0.0.1:{server.server_port}/"]
    browser = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        result = results.get(timeout=PATIENCE)
    except Empty:
        raise AssertionError(f"no result from the browser within {PATIENCE} s (exit code {browser.poll()})") from None
    finally:
        browser.terminate()
        browser.wait(timeout=30)
        server.shutdown()
        server.server_close()
        shutil.rmtree(profile, ignore_errors=True)
    assert not (isinstance(result, dict) and "failed" in result), result["failed"]
    return result


def processor_time(pid: int) -> float:
    """Processor time of a process and all its children, ms."""
    import psutil

    total = 0.0
    for process in (psutil.Process(pid), *psutil.Process(pid).children(recursive=True)):
        with suppress(psutil.Error):
            times = process.cpu_times()
            total += 1e3 * (times.user + times.system)
    return total


def within_frame(page: str, width: int, height: int) -> str:
    """A page that shows another in a frame of a phone's size."""
    return (
        "<!doctype html><body style='margin:0'><iframe id='phone' style='border:0' "
        f"width='{width}' height='{height}' srcdoc=\"{html.escape(page, quote=True)}\"></iframe></body>"
    )
