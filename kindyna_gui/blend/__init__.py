"""The blend wizard."""
