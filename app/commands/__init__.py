"""The commands of the command line, one module each: options, and what to do."""
