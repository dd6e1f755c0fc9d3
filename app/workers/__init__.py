"""Threads: a job that ends, a loop that goes on, and the mailbox that they post to."""
