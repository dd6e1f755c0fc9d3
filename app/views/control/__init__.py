"""The control panel: how the avatar follows the user."""
