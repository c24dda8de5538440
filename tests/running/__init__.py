"""Tests of runs from their case to their folder."""
