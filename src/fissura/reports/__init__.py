"""Pages in HTML that need no other file and no network: a run, or the interactive parts of an ensemble's page.

`run_page` makes the page of a run. `page` and `templates` are what pages share; `libraries` are the JavaScript
libraries that a page brings along, `packed` is how data get into it, `static` is what is our own of its JavaScript.
Needs the extra ``report``.
"""
