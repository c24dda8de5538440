"""Many tasks side by side on this machine."""
