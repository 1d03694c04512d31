"""Learns networks that label depth pictures (README.md beside this folder)."""
