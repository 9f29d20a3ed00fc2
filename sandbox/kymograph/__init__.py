"""Kymographs, as the paper made its own: a line of pixels of each camera frame, stacked from left to right.

camera  ->  a frame of one lane with a black marker on every bead, and the line of it that holds the markers
picture ->  the lines of all frames side by side, scale bars, and a fine line where the trajectory says the markers are
"""
