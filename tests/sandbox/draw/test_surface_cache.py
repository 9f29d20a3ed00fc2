"""The cache of surfaces is bounded by their memory."""

import pygame
from softcradle.sandbox.draw.surface_cache import cached_surfaces, clear_cached_surfaces


def test_drawings_are_kept_up_to_their_memory_and_the_oldest_is_dropped_first():
    drawn = []

    @cached_surfaces(megabytes=1.0)
    def square(side):
        drawn.append(side)
        return pygame.Surface((side, side), 0, 32)

    sides = [256, 255, 254]  # a quarter of a megabyte each
    for side in sides * 2:
        assert square(side).get_size() == (side, side)
    assert drawn == sides
    square(400)  # 0.61 MB: the first two are dropped
    square(254)
    assert drawn == [*sides, 400]
    square(255)
    assert drawn == [*sides, 400, 255]
    square(2000)  # larger than the cache: it is kept until the next one
    assert square(2000) is square(2000)
    assert drawn == [*sides, 400, 255, 2000]
    clear_cached_surfaces()
    for side in sides * 2:  # room for three again: dropped drawings are not counted
        square(side)
    assert drawn == [*sides, 400, 255, 2000, *sides]
