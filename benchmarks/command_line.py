"""The commands of docs/command-line.md, with their options, as the program has them: `--write` writes them there."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import typer
from typer.cli import get_docs_for_click

from fissura.cli import app

PAGE = Path(__file__).parents[1] / "docs" / "command-line.md"
_PLACE = re.compile(r"(<!-- commands: begin -->\n).*(<!-- commands: end -->)", re.DOTALL)


def commands() -> str:
    """All commands with arguments and options, in Markdown."""
    group = typer.main.get_command(app)
    text = get_docs_for_click(obj=group, ctx=typer.Context(group, info_name="fissura"), name="fissura")
    text = text[text.index("## ") :].replace("```console\n$ ", "```text\n")
    text = text.replace("\n```\n\n**", "\n```\n\n**").replace("* `--help`: Show this message and exit.\n", "")
    return re.sub(r"\*\*Options\*\*:\n\n(?=\n|##|$)", "", text).rstrip() + "\n"


def written(page: str) -> str:
    """The page with the commands of today."""
    return _PLACE.sub(lambda found: found[1] + "\n" + commands() + "\n" + found[2], page)


if __name__ == "__main__":
    if "--write" in sys.argv:
        PAGE.write_text(written(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    else:
        print(commands())
