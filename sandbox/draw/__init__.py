"""Drawing: a scene, the motions of its lanes and a row of them in, pixels out; it knows of no window, film or clock.

motions = [motion_of(trajectory) for trajectory in trajectories]  # one for each lane
Picture(scene, motions, surface.get_size()).paint(surface, row)
"""
