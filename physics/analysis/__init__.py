"""What a motion means: measures of a collision, closed forms, the mode-coupling model, matched contacts."""
