"""Compiled loops: arrays in, arrays out. Allocate nothing, raise nothing."""
