"""Live progress of runs, and how long they still take."""
