"""The landmark editor's widgets."""
