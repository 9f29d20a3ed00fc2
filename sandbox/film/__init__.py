"""Films and kymographs: frames into files."""
