"""Films and kymographs of scenes."""
