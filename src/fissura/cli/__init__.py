"""The command line ``fissura``: what a user types becomes calls of the rooms below, and what they say becomes text.

`application` puts the commands together; `running`, `pictures`, `elastic`, `ensemble` and `study` hold them, by group;
`options` has what several of them take, `console` what they share: messages, exit status, tables.

No room imports this one, and a command imports what it calls when it is called, so that ``fissura --help`` is quick.
"""

from fissura.cli.application import app, main, start_light

__all__ = ["app", "main", "start_light"]
