"""Shapes of specimens, one file each."""
