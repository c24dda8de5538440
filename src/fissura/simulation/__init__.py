"""One specimen broken step by step: the state of a run, the loop over steps, what a case asks of it."""
