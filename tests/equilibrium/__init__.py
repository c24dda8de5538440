"""Tests of equilibrium."""
