"""Recorded performances: written while they happen, kept by name, played, solved anew, exported."""
