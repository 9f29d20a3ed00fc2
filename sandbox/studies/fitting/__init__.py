"""Free values of a scene: least squares against measured data or stated numbers, and design for a goal."""
