"""What people use: the `softcradle` command, the frames, the films and the window. The only package that draws."""
