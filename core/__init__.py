"""Numbers: fitting, regression and tracking. No Qt, no OpenGL, no camera, no clock."""
