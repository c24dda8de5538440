"""Pictures and windows: specimens, curves, bodies and cracks."""
