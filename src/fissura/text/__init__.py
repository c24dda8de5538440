"""Quantities and rows as text, for messages, tables and pictures; imports no other room and brings no large library."""
