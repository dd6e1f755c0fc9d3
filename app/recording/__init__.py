"""What a track is written to: array files, tables, videos. A file appears when it is complete."""
