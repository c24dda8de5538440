"""Running, checking and reporting from Python."""
