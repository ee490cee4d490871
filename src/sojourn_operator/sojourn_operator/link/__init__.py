"""What stands between operators on Earth and the machine."""
