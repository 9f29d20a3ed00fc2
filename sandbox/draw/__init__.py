"""Drawing of scenes. The package draws a picture from a scene, the motions of its lanes and the number of a sample. The
package does not depend on the window, on films or on a clock.

motions = [motion_of(trajectory) for trajectory in trajectories]  # one for each lane
Picture(scene, motions, surface.get_size()).paint(surface, row)
"""
