"""Signal in, core call or job, session changed: the only code that knows both views and work."""
