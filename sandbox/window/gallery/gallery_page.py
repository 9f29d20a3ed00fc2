"""The page of the gallery: a card for each scene, with its thumbnail, title and source."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pygame
from softcradle.sandbox.draw.palette import BACKGROUND, FAINT, FOREGROUND, LANE_BACKGROUND, MUTED, OKABE_ITO
from softcradle.sandbox.draw.text import shortened, wrapped, write
from softcradle.sandbox.window.gallery import thumbnails
from softcradle.sandbox.window.hanging.hanging_page import HANGING_NAME, HANGING_TEXT, HANGING_TITLE
from softcradle.sandbox.window.hanging.hanging_picture import hanging_thumbnail
from softcradle.sandbox.window.look_ahead import motions_ahead
from softcradle.sandbox.window.window_page import Host
from softcradle.scenes import Scene, load, names

MARGIN = 34.0  # design pixels on the left and right
HEADER = 96.0  # design pixels
GUTTER = 20.0  # design pixels between two cards
COLUMN = 285.0  # design pixels, the least width of a card
CAPTION = 66.0  # design pixels below a picture
SCROLL = 60.0  # design pixels for a notch of the wheel
BORDER = (196, 202, 209)
HOVERED_BORDER = OKABE_ITO[0]
HOVERED_OPACITY = 24  # of 255, of the tint of the card under the pointer
PRESSED_OPACITY = 48  # of 255, of the same card while the button is down


class GalleryPage:
    """All scenes of the catalogue; `choose(name)` is called with the one that is clicked."""

    typing = False

    def __init__(self, host: Host, choose: Callable[[str], None]) -> None:
        self.host, self.choose = host, choose
        self.scenes: list[Scene] = [load(name) for name in names()]
        self.names = (*names(), HANGING_NAME)
        self.captions = [(scene.title, scene.text, scene.source) for scene in self.scenes]
        self.captions.append((HANGING_TITLE, HANGING_TEXT, "SoftChain, PinJoint strings, gravity"))
        self.pictures: dict[int, pygame.Surface] = {}
        self.scaled: dict[tuple[int, tuple[int, int]], pygame.Surface] = {}
        self.selected, self.scroll, self.rows = 0, 0.0, 1
        self.pressed: int | None = None
        for k, scene in enumerate(self.scenes):
            picture = thumbnails.load(scene)
            if picture is None:
                host.warmup.submit(("thumbnail", k), partial(motions_ahead, scene))
            else:
                self.pictures[k] = picture
        self.pictures[len(self.scenes)] = hanging_thumbnail(thumbnails.SIZE)
        self.actions: dict[str, Callable[[], None]] = {
            "select_left": partial(self.step, -1),
            "select_right": partial(self.step, 1),
            "zoom_in": lambda: self.step(-self.columns),
            "zoom_out": lambda: self.step(self.columns),
            "leave": host.quit,
        }

    def build(self) -> None:
        """Find the places of the cards for the host's size and unit."""
        unit, width = self.host.unit, self.host.size[0]
        inner = width - 2 * MARGIN * unit
        self.columns = max(1, int((inner + GUTTER * unit) // ((COLUMN + GUTTER) * unit)))
        self.wide = (inner - (self.columns - 1) * GUTTER * unit) / self.columns
        self.picture_size = round(self.wide), round(self.wide * thumbnails.SIZE[1] / thumbnails.SIZE[0])
        self.pitch = self.picture_size[1] + (CAPTION + GUTTER) * unit
        self.rows = -(-len(self.names) // self.columns)
        self.scaled.clear()
        self.scroll_to(self.scroll)

    def place(self, k: int) -> pygame.Rect:
        """Rectangle of card `k` on screen."""
        row, column = divmod(k, self.columns)
        unit = self.host.unit
        x = MARGIN * unit + column * (self.wide + GUTTER * unit)
        y = HEADER * unit + row * self.pitch - self.scroll
        return pygame.Rect(round(x), round(y), self.picture_size[0], round(self.picture_size[1] + CAPTION * unit))

    def step(self, by: int) -> None:
        """Move the selection by `by` cards."""
        self.selected = min(max(self.selected + by, 0), len(self.names) - 1)
        card = self.place(self.selected)
        top, bottom = HEADER * self.host.unit, self.host.size[1] - 10
        if card.top < top:
            self.scroll_to(self.scroll - (top - card.top))
        elif card.bottom > bottom:
            self.scroll_to(self.scroll + card.bottom - bottom)

    def scroll_to(self, scroll: float) -> None:
        """Scroll to `scroll` pixels, as far as there are cards."""
        unit = self.host.unit
        full = HEADER * unit + self.rows * self.pitch + 4 * unit
        self.scroll = min(max(scroll, 0.0), max(0.0, full - self.host.size[1]))

    def card_at(self, point: tuple[int, int]) -> int | None:
        """The visible card at `point`, or None."""
        if point[1] < HEADER * self.host.unit:
            return None
        return next((k for k in range(len(self.names)) if self.place(k).collidepoint(point)), None)

    def handle(self, event: pygame.Event) -> bool:
        """Clicks, wheel and Enter."""
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == 1:
            self.pressed = self.card_at(event.pos)
            return self.pressed is not None
        if event.type == pygame.MOUSEBUTTONUP and event.button == 1 and self.pressed is not None:
            pressed, self.pressed = self.pressed, None
            if self.card_at(event.pos) == pressed:
                self.choose(self.names[pressed])
            return True
        if event.type == pygame.MOUSEWHEEL:
            self.scroll_to(self.scroll - event.precise_y * SCROLL * self.host.unit)
            return True
        if event.type == pygame.KEYDOWN and event.key in (pygame.K_RETURN, pygame.K_KP_ENTER):
            self.choose(self.names[self.selected])
            return True
        return False

    def update(self, seconds: float) -> None:
        """Draw at most one thumbnail whose motion is known."""
        result = self.host.warmup.next_result()
        if result is None:
            return
        (kind, k), motions = result
        if kind == "thumbnail" and isinstance(motions, list):
            self.pictures[k] = thumbnails.paint(self.scenes[k], motions)
            thumbnails.save(self.scenes[k], self.pictures[k])

    def paint(self, surface: pygame.Surface) -> None:
        """Draw the cards and the header above them."""
        unit = self.host.unit
        surface.fill(BACKGROUND)
        for k in range(len(self.names)):
            place = self.place(k)
            if place.bottom > HEADER * unit and place.top < self.host.size[1]:
                self._card(surface, k, place)
        surface.fill(BACKGROUND, (0, 0, self.host.size[0], round((HEADER - 4) * unit)))
        x, y = MARGIN * unit, 20 * unit
        write(surface, "softcradle", (x, y), 28 * unit, FOREGROUND, bold=True)
        line = "Beads that only push on each other, softly. Choose a scene, or drop a scene file here."
        write(surface, line, (x, y + 38 * unit), 15 * unit, MUTED)
        right = (self.host.size[0] - MARGIN * unit, y + 38 * unit)
        write(surface, "F1: help", right, 15 * unit, MUTED, align=(1, 0))

    def _card(self, surface: pygame.Surface, k: int, place: pygame.Rect) -> None:
        unit = self.host.unit
        image = self._image(k)
        picture = pygame.Rect(place.topleft, self.picture_size)
        if image is None:
            surface.fill(LANE_BACKGROUND, picture)
            write(surface, "drawing …", picture.center, 13 * unit, MUTED, align=(0.5, 0.5))
        else:
            surface.blit(image, picture)
        self._caption(surface, k, (place.left + 10 * unit, picture.bottom + 7 * unit))
        surface.fill(FAINT, (place.left, picture.bottom, place.width, 1))
        self._border(surface, k, place)
        if k == self.selected:
            frame = place.inflate(round(4 * unit), round(4 * unit))
            pygame.draw.rect(surface, FOREGROUND, frame, max(2, round(2 * unit)))

    def _caption(self, surface: pygame.Surface, k: int, place: tuple[float, float]) -> None:
        """Title, the first line of the text, and source."""
        unit, (title, text, source), (x, y) = self.host.unit, self.captions[k], place
        room = self.wide - 20 * unit
        write(surface, shortened(title, 15 * unit, room, bold=True), (x, y), 15 * unit, FOREGROUND, bold=True)
        for line in wrapped(text, 12 * unit, room)[:1] if text else []:
            write(surface, shortened(line + " …", 12 * unit, room), (x, y + 21 * unit), 12 * unit, MUTED)
        write(surface, shortened(source, 11.5 * unit, room), (x, y + 38 * unit), 11.5 * unit, MUTED)

    def _border(self, surface: pygame.Surface, k: int, place: pygame.Rect) -> None:
        """The border, and a tint under the pointer; widgets for it took 100 MB, and a third of a second to make."""
        hovered = self.card_at(pygame.mouse.get_pos()) == k
        if hovered:
            tint = pygame.Surface(place.size, pygame.SRCALPHA, 32)
            tint.fill((*HOVERED_BORDER, PRESSED_OPACITY if self.pressed == k else HOVERED_OPACITY))
            surface.blit(tint, place)
        pygame.draw.rect(surface, HOVERED_BORDER if hovered else BORDER, place, 1)

    def _image(self, k: int) -> pygame.Surface | None:
        """The picture of card `k` at its present size, or None."""
        if k not in self.pictures:
            return None
        key = (k, self.picture_size)
        if key not in self.scaled:
            self.scaled[key] = pygame.transform.smoothscale(self.pictures[k].convert(), self.picture_size)
        return self.scaled[key]

    def paint_over(self, surface: pygame.Surface) -> None:
        """Nothing lies above the cards."""

    def after_frame(self, surface: pygame.Surface, seconds: float) -> None:
        """The gallery is not filmed."""

    def close(self) -> None:
        """Drop the pictures."""
        self.pictures.clear()
        self.scaled.clear()
