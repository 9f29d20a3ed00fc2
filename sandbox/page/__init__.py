"""Web pages for sharing. One HTML file contains the recorded motion of a scene, its plots and its numbers. The file
loads nothing else.

write_page(trajectories, scene, "page.html")  # one Trajectory for each lane of the scene
"""

from softcradle.sandbox.page.shared_page import PageReport, render_page, scene_text, write_page

__all__ = ["PageReport", "render_page", "scene_text", "write_page"]
