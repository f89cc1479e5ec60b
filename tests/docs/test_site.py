"""The documentation site builds, leaves no page out, and asks nobody for anything."""

import functools
import http.server
import os
import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urldefrag, urljoin, urlparse

import pytest
from playwright.sync_api import Browser
from tests.docs.pages import TOP


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built as `make docs` does."""
    folder = tmp_path_factory.mktemp("site")
    mkdocs = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet"]
    built = subprocess.run(
        [*mkdocs, "--site-dir", str(folder)],
        cwd=TOP,
        env=os.environ | {"NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
        timeout=300.0,
    )
    assert (built.returncode, built.stdout + built.stderr) == (0, "")
    return folder


def linked(site: Path, page: str) -> set[str]:
    """Return what a page links to or loads, as paths in the site."""
    text = (site / page).read_text()
    found = re.findall(r'(?:href|src)="([^"]+)"', text)
    ways = {urldefrag(urljoin(f"/{page}", each))[0].lstrip("/") for each in found}
    return {way for way in ways if way and not urlparse(way).scheme}


def test_every_page_is_found_from_the_first_one_and_no_link_is_dead(site: Path) -> None:
    reached, waiting = set[str](), ["index.html"]
    while waiting:
        page = waiting.pop()
        reached.add(page)
        ways = linked(site, page)
        dead = {way for way in ways if not (site / way).exists()}
        assert not dead, page
        waiting += {way for way in ways if way.endswith(".html")} - reached
    pages = {str(page.relative_to(site)) for page in site.glob("**/*.html")}
    assert pages - reached == {"404.html"}


@pytest.fixture
def address(site: Path) -> Iterator[str]:
    """Where the site is served."""
    handler = functools.partial(
        http.server.SimpleHTTPRequestHandler, directory=str(site)
    )
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


def test_a_browser_loads_the_pages_without_asking_elsewhere(
    address: str, chromium: Browser
) -> None:
    asked, errors = set[str](), list[str]()
    page = chromium.new_page()
    page.on("request", lambda request: asked.add(request.url))
    page.on(
        "console",
        lambda said: errors.append(said.text) if said.type == "error" else None,
    )
    for name in ("index.html", "ros.html", "results.html", "api/learner.html"):
        page.goto(address + name, wait_until="load")
    page.wait_for_load_state("networkidle")  # the index of the search has come
    page.locator("input.md-search__input").press_sequentially("penalty")
    page.wait_for_selector(".md-search-result__link", timeout=60_000)
    page.close()
    assert not errors
    assert {url for url in asked if not url.startswith((address, "data:"))} == set()
