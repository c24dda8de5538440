"""The machine that a run is on: processors and threads, memory, signals."""
