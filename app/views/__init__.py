"""Pages and widgets: they show records and emit wishes; no numerics."""
