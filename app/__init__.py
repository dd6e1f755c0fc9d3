"""Everything with a device, a window, a wire or a command line."""
