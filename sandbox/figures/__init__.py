"""The paper's figures, and those of the data it does not show: one small module each, a table of numbers and a drawing."""
