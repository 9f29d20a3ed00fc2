"""Films and kymographs (space-time pictures) of scenes."""
