"""``python -m fissura``, and the program ``fissura``: what is here is loaded before anything that takes time."""

import sys


def main() -> None:
    """Run the command line; Ctrl-C ends it without a traceback even while it loads."""
    try:
        from fissura.cli import main as run

        run()
    except KeyboardInterrupt:
        print("interrupted; nothing was saved", file=sys.stderr)  # noqa: T201
        raise SystemExit(130) from None


if __name__ == "__main__":
    main()
