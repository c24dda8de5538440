"""A browser without a window and without a network, for pages."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
"""Programs that will do; `.ci/run` sees to it that there is one."""

BROWSER = next(filter(None, map(shutil.which, NAMES)), None)

needs_browser = pytest.mark.skipif(
    BROWSER is None or find_spec("playwright") is None, reason="there is no browser, or no playwright"
)

#: Software draws WebGL where there is no graphics card.
DRAWN_BY_SOFTWARE = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")
WITHOUT_WEBGL = ("--no-sandbox", "--disable-3d-apis")


@contextmanager
def launcher() -> Iterator[Any]:
    """A function that starts a browser with options, which runs until the end of its block."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:

        def browser(*options: str) -> Any:
            return playwright.chromium.launch(executable_path=BROWSER, args=list(options or DRAWN_BY_SOFTWARE))

        yield browser


@contextmanager
def opened(started: Any, path: Path, *, width: int = 1280, height: int = 900, scheme: str = "light") -> Iterator[Any]:
    """A page in a browser, offline and ready; at the end of the block it must have met no error and asked for nothing.

    Its attribute ``problems`` has what is wrong so far.
    """
    context = started.new_context(viewport={"width": width, "height": height}, color_scheme=scheme, offline=True)
    page, problems = context.new_page(), []
    page.problems = problems
    page.on("console", lambda message: problems.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: problems.append(f"{error}"))
    page.on("dialog", lambda dialog: (problems.append(dialog.message), dialog.dismiss()))
    asked = ("file:", "data:", "blob:")
    page.on("request", lambda request: None if request.url.startswith(asked) else problems.append(request.url))
    try:
        page.goto(path.as_uri())
        page.wait_for_selector("html[data-ready]", timeout=120_000)
        yield page
        assert problems == []
    finally:
        context.close()
