"""Where frames come from: webcam, video file, image folder. The only place that opens a camera."""
