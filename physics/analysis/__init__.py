"""Analysis of a motion: measures of a collision, closed forms, the mode-coupling model, matching of contact laws."""
