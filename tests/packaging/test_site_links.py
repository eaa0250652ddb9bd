"""Links to other servers: checked against a server on this machine, by the code that `site/build.py --links` runs."""

from __future__ import annotations

import importlib.util
import sys
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from types import ModuleType

import pytest

SITE = Path(__file__).resolve().parents[2] / "site"
CONFIGURATION = "extensions = []\nlinkcheck_timeout = 5\nlinkcheck_retries = 1\n"


class Pages(BaseHTTPRequestHandler):
    """/here is there, /moved leads to it, /gone was there, anything else is not."""

    def do_GET(self) -> None:
        code = {"/here": 200, "/moved": 302, "/gone": 410, "/closed": 403}.get(self.path, 404)
        self.send_response(code)
        if code == 302:
            self.send_header("Location", "/here")
        self.send_header("Content-Length", "0")
        self.end_headers()

    def do_HEAD(self) -> None:
        self.do_GET()

    def log_message(self, format: str, *arguments: object) -> None:
        """Say nothing."""


@pytest.fixture
def server() -> Iterator[str]:
    """Address of a server on this machine."""
    serving = ThreadingHTTPServer(("127.0.0.1", 0), Pages)
    thread = threading.Thread(target=serving.serve_forever, daemon=True)
    thread.start()
    yield f"http://127.0.0.1:{serving.server_port}"
    serving.shutdown()
    thread.join()
    serving.server_close()


@pytest.fixture
def build(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """`site/build.py` with a configuration without extensions."""
    pytest.importorskip("sphinx", reason="the extra docs is not installed")
    monkeypatch.syspath_prepend(SITE)
    specification = importlib.util.spec_from_file_location("site_build", SITE / "build.py")
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "conf.py").write_text(CONFIGURATION, encoding="utf-8")
    monkeypatch.setattr(module, "SITE", tmp_path / "site")
    monkeypatch.setattr(module, "BUILD", tmp_path / "build")
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.setenv("TYREFEM_SITE_RESULTS", "")
    for name in ("http_proxy", "https_proxy", "HTTP_PROXY", "HTTPS_PROXY", "all_proxy", "ALL_PROXY"):
        monkeypatch.delenv(name, raising=False)
    return module


def checked(build: ModuleType, links: list[str], monkeypatch: pytest.MonkeyPatch) -> int:
    """Exit code of the check of a page with these links."""
    rows = "\n".join(f"- `link {number} <{link}>`_" for number, link in enumerate(links))

    def assemble(source: Path) -> None:
        (source / "index.rst").write_text(f"Links\n=====\n\n{rows}\n", encoding="utf-8")

    monkeypatch.setattr(build, "assemble", assemble)
    return int(build.main(["--links", "--clean"]))


@pytest.mark.filterwarnings("default")
def test_pages_that_are_not_there_are_broken_and_servers_that_do_not_answer_are_not(
    build: ModuleType, server: str, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    there = [f"{server}/here", f"{server}/moved", "http://127.0.0.1:9/no-server", f"{server}/closed"]
    assert checked(build, there, monkeypatch) == 0
    out, err = capfd.readouterr()
    assert "Links to other servers: 2 answer, 0 broken, 2 not reached." in out
    assert "not reached: index.rst:6: http://127.0.0.1:9/no-server" in err
    assert checked(build, [f"{server}/here", f"{server}/never", f"{server}/gone"], monkeypatch) == 1
    out, err = capfd.readouterr()
    assert "1 answer, 2 broken, 0 not reached." in out
    assert f"broken link: index.rst:5: {server}/never" in err
    assert f"broken link: index.rst:6: {server}/gone" in err
