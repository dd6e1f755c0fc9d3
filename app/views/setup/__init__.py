"""The pages of the guided setup."""
